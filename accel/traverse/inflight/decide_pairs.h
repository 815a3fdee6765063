#pragma once
/// \file The exact decision for pairs: each lane has a ray and a triangle of its own. Traversals that keep
/// one candidate hit per ray decide the candidates of many rays here at once.

#include "accel/accel_data.h"
#include "accel/traverse/leaf.h"
#include "core/lanes.h"
#include "core/simd_memory.h"
#include "kernels/triangle/triangle_classify.h"

namespace oktett {

// ---- One or two rays, each against its own block of triangles, side by side in lanes.

/// Rays whose blocks are classified together.
template <class A>
inline constexpr int kBlockRays = std::is_same_v<A, Avx512Isa> ? 2 : 1;

/// The lanes of N blocks.
template <int N, class A>
using BlockLanes = Simd<float, N * TriangleBlock::kSize, A>;

/// vector(j), eight lanes, for j below N, side by side.
template <int N, class Function>
OKTETT_INLINE auto join_blocks(Function&& vector) {
  static_assert(N == 1 || N == 2);
  if constexpr (N == 1)
    return vector(0);
  else
    return concat(vector(0), vector(1));
}

/// number(j) in all lanes of block j.
template <int N, class A, class Function>
OKTETT_INLINE BlockLanes<N, A> spread_blocks(Function&& number) {
  return join_blocks<N>([&](int j) { return Simd<float, TriangleBlock::kSize, A>(number(j)); });
}

/// The triangles of block(j), for j below N, side by side.
template <int N, class A, class BlockOf>
OKTETT_INLINE TriangleLanes<BlockLanes<N, A>> load_blocks(BlockOf&& block) {
  if constexpr (N == 1) {
    return load_triangles<BlockLanes<N, A>>(block(0));
  } else {
    const TriangleBlock &a = block(0), &b = block(1);
    const PackedIndexPair<A> corners(a.corners, b.corners);
    const auto corner = [&](int k) {
      const auto axis = [&](int i) { return corners.look_up(k, a.point[i], b.point[i]); };
      return Vec3<BlockLanes<N, A>>{axis(0), axis(1), axis(2)};
    };
    return {corner(0), corner(1), corner(2)};
  }
}

/// Classifies the triangles of block(j) for ray(j), which has the members o, d, weight_scale and det_scale.
template <int N, class A, class RayOf, class BlockOf>
OKTETT_INLINE TriangleGuess<BlockLanes<N, A>> guess_blocks(RayOf&& ray, BlockOf&& block) {
  using F = BlockLanes<N, A>;
  const auto origin = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).o[k]; }); };
  const auto direction = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).d[k]; }); };
  return guess_triangle(Vec3<F>{origin(0), origin(1), origin(2)},
                        Vec3<F>{direction(0), direction(1), direction(2)},
                        spread_blocks<N, A>([&](int j) { return ray(j).weight_scale; }),
                        spread_blocks<N, A>([&](int j) { return ray(j).det_scale; }),
                        filter_triangle(load_blocks<N, A>(block)));
}

// ---- The exact decision for pairs.

/// Triangles whose numbers agree above this bit lie less than 2^31 floats apart, so 32-bit offsets reach
/// them.
inline constexpr std::uint32_t kNearTriangles = std::uint32_t{1} << 27;

/// Triangles of different structures: `block[i]` is that of triangle i, `ids[i]` its number as below.
template <int N, class A>
OKTETT_INLINE TriangleLanes<Simd<float, N, A>> gather_triangles(const TriangleBlock* const (&block)[N],
                                                                const std::uint32_t* ids) {
  using F = Simd<float, N, A>;
  alignas(64) float row[9][N];
  for (int i = 0; i < N; ++i)
    for (int which = 0; which < 3; ++which) {
      const Vec3f p = block[i]->vertex(which, static_cast<int>(ids[i] % TriangleBlock::kSize));
      for (int axis = 0; axis < 3; ++axis) row[3 * which + axis][i] = p[axis];
    }
  const auto corner = [&](int k) {
    return Vec3<F>{F::load(row[k]), F::load(row[k + 1]), F::load(row[k + 2])};
  };
  return {corner(0), corner(3), corner(6)};
}

/// Triangles of `blocks`, one in each lane, by their numbers `ids` = block * TriangleBlock::kSize + lane. If
/// the numbers agree above bit `kNear`, a power of two up to kNearTriangles, they are gathered with one index
/// vector.
template <int N, class A, std::uint32_t kNear = kNearTriangles>
OKTETT_INLINE TriangleLanes<Simd<float, N, A>> gather_triangles(const TriangleBlock* blocks,
                                                                const std::uint32_t* ids) {
  using F = Simd<float, N, A>;
  constexpr std::uint32_t kSize = TriangleBlock::kSize;
  std::uint32_t differing = 0;
  for (int i = 1; i < N; ++i) differing |= ids[i] ^ ids[0];
  if (differing == 0) return broadcast_triangle<F>(blocks[ids[0] / kSize], static_cast<int>(ids[0] % kSize));
  if (OKTETT_LIKELY(differing < kNear)) {
    using I = Simd<std::int32_t, N, A>;
    constexpr std::uint32_t kFloats = sizeof(TriangleBlock) / sizeof(float);
    const TriangleBlock* near_blocks = blocks + ids[0] / kNear * (kNear / kSize);
    alignas(64) std::int32_t at[N], packed[N];
    for (int i = 0; i < N; ++i) {
      const std::uint32_t id = ids[i] % kNear;
      at[i] = static_cast<std::int32_t>(id / kSize * (2 * kFloats) + id % kSize);
    }
    gather(near_blocks->corners, I::load(at)).store(packed);
    const auto corner = [&](int which) {
      for (int i = 0; i < N; ++i) {
        const std::uint32_t block = ids[i] % kNear / kSize;
        at[i] = static_cast<std::int32_t>(block * kFloats) + (packed[i] >> 4 * which & 15);
      }
      const I index = I::load(at);
      const auto axis = [&](int k) { return gather(near_blocks->point[k], index); };
      return Vec3<F>{axis(0), axis(1), axis(2)};
    };
    return {corner(0), corner(1), corner(2)};
  }
  const TriangleBlock* block[N];
  for (int i = 0; i < N; ++i) block[i] = blocks + ids[i] / kSize;
  return gather_triangles<N, A>(block, ids);
}

/// Ray i of `ray` against triangle i of `tri`, for all i at once, with the same bits as decide_watertight of
/// each pair alone. The rays may differ in the axis of their greatest direction component. Returns a bit for
/// each ray that meets its triangle at tmin < t <= tmax, and in `front`, if it is not null, for each of these
/// that meets it from the front. Unused lanes may have any triangle and any finite ray.
template <int N, class A>
OKTETT_INLINE unsigned decide_pairs(RayLanes<Simd<float, N, A>> ray, TriangleLanes<Simd<float, N, A>> tri,
                                    HitLanes<Simd<float, N, A>>& hit, unsigned* front = nullptr) {
  using F = Simd<float, N, A>;
  using D = Simd<double, N, A>;
  ray.d = flush_direction(ray.d);
  const F ax = abs(ray.d.x), ay = abs(ray.d.y), az = abs(ray.d.z);
  const auto zx = (ax >= ay) & (ax >= az), zy = ~zx & (ay >= az);
  const unsigned along_x = bits(zx), along_y = bits(zy), all = bits(F::M::all_true());
  const auto permute = [&](const Vec3<F>& p) {
    if (along_x == all) return permute_to_z(p, 0);
    if (along_y == all) return permute_to_z(p, 1);
    if ((along_x | along_y) == 0) return p;
    const auto pick = [&](const F& x, const F& y, const F& z) { return select(zx, x, select(zy, y, z)); };
    return Vec3<F>{pick(p.y, p.z, p.x), pick(p.z, p.x, p.y), pick(p.x, p.y, p.z)};
  };
  const Vec3<D> d = to_double(permute(ray.d));
  const D inv_dz = D(1.0) / d.z;
  const ShearLanes<D> shear{to_double(permute(ray.o)), inv_dz, d.x * inv_dz, d.y * inv_dz};
  tri = {permute(tri.a), permute(tri.b), permute(tri.c)};
  typename F::M clockwise;
  const unsigned met = bits(decide_watertight(shear, tri, ray.tmin, ray.tmax, hit, clockwise));
  if (front != nullptr) *front = bits(clockwise) ^ bits(mask_cast<float>(inv_dz < D(0.0)));
  return met;
}

/// The same for triangles `ids[i]` = block * TriangleBlock::kSize + lane of `blocks`.
template <int N, class A>
OKTETT_INLINE unsigned decide_pairs(const RayLanes<Simd<float, N, A>>& ray, const TriangleBlock* blocks,
                                    const std::uint32_t* ids, HitLanes<Simd<float, N, A>>& hit,
                                    unsigned* front = nullptr) {
  return decide_pairs<N, A>(ray, gather_triangles<N, A>(blocks, ids), hit, front);
}

}  // namespace oktett
