#pragma once
/// \file The exact decision for pairs: each lane has a ray and a triangle of its own. Traversals that keep
/// one candidate hit per ray decide the candidates of many rays here at once.

#include <utility>

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

/// The triangles of leaf(j), a TriangleLeaf, for j below N, side by side.
template <int N, class A, class LeafOf>
OKTETT_INLINE TriangleLanes<BlockLanes<N, A>> load_blocks(LeafOf&& leaf) {
  if constexpr (N == 1) {
    return load_triangles<BlockLanes<N, A>>(leaf(0));
  } else {
    const TriangleLeaf a = leaf(0), b = leaf(1);
    const CornerRows<A> first(a), second(b);
    const PackedIndexPair<A> corners(a.corners(), b.corners());
    const auto corner = [&](int k) {
      const auto axis = [&](int i) { return corners.look_up(k, first[i], second[i]); };
      return Vec3<BlockLanes<N, A>>{axis(0), axis(1), axis(2)};
    };
    return {corner(0), corner(1), corner(2)};
  }
}

/// Classifies the triangles of leaf(j), a TriangleLeaf, for ray(j), which has the members o, d, weight_scale
/// and det_scale.
template <int N, class A, class RayOf, class LeafOf>
OKTETT_INLINE TriangleGuess<BlockLanes<N, A>> guess_blocks(RayOf&& ray, LeafOf&& leaf) {
  using F = BlockLanes<N, A>;
  const auto origin = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).o[k]; }); };
  const auto direction = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).d[k]; }); };
  return guess_triangle(
      Vec3<F>{origin(0), origin(1), origin(2)}, Vec3<F>{direction(0), direction(1), direction(2)},
      spread_blocks<N, A>([&](int j) { return ray(j).weight_scale; }),
      spread_blocks<N, A>([&](int j) { return ray(j).det_scale; }), filter_triangle(load_blocks<N, A>(leaf)));
}

// ---- The exact decision for pairs.

/// Triangles whose numbers agree above this bit lie less than 2^31 floats apart, so 32-bit offsets reach
/// them.
inline constexpr std::uint32_t kNearTriangles = std::uint32_t{1} << 27;

/// Triangles of different structures: `leaf[i]` is that of triangle i, `ids[i]` its number as below.
template <int N, class A>
OKTETT_INLINE TriangleLanes<Simd<float, N, A>> gather_triangles(const TriangleLeaf* leaf,
                                                                const std::uint32_t* ids) {
  using F = Simd<float, N, A>;
  alignas(64) float row[9][N];
  for (int i = 0; i < N; ++i)
    for (int which = 0; which < 3; ++which) {
      const Vec3f p = leaf[i].vertex(which, static_cast<int>(ids[i] % TriangleBlock::kSize));
      for (int axis = 0; axis < 3; ++axis) row[3 * which + axis][i] = p[axis];
    }
  const auto corner = [&](int k) {
    return Vec3<F>{F::load(row[k]), F::load(row[k + 1]), F::load(row[k + 2])};
  };
  return {corner(0), corner(3), corner(6)};
}

/// Triangles of packed blocks from `blocks` on, one in each lane: triangle i in block block[i], its numbers
/// of corners in word[i], as in TriangleBlock::Lists::corners.
template <int N, class A>
OKTETT_INLINE TriangleLanes<Simd<float, N, A>> gather_packed(const TriangleBlock* blocks,
                                                             const std::int32_t (&block)[N],
                                                             const std::int32_t (&word)[N]) {
  using F = Simd<float, N, A>;
  using I = Simd<std::int32_t, N, A>;
  constexpr std::int32_t kWords = sizeof(TriangleBlock) / sizeof(std::int32_t);
  const auto words = [](const auto& first, const std::int32_t(&at)[N], std::int32_t(&out)[N]) {
    bit_cast_int(gather(reinterpret_cast<const float*>(&first), I::load(at))).store(out);
  };
  alignas(64) std::int32_t at[N], base[3][N], low[N], high[N], top[N];
  for (int i = 0; i < N; ++i) at[i] = block[i] * kWords;
  for (int axis = 0; axis < 3; ++axis) words(blocks->second.base[axis], at, base[axis]);
  const auto corner = [&](int which) {
    for (int i = 0; i < N; ++i) at[i] = block[i] * kWords + (word[i] >> 4 * which & 15);
    words(blocks->low[0], at, low), words(blocks->high[0], at, high);
    for (int i = 0; i < N; ++i) at[i] = block[i] * kWords + (word[i] >> 4 * which & 15) / 4;
    words(blocks->top[0], at, top);
    alignas(64) float row[3][N];
    for (int i = 0; i < N; ++i) {
      const auto byte = static_cast<std::uint32_t>(top[i]) >> 8 * (word[i] >> 4 * which & 3) & 0xffu;
      for (int axis = 0; axis < 3; ++axis)
        row[axis][i] =
            packed_float(base[axis][i], packed_distance(static_cast<std::uint32_t>(low[i]),
                                                        static_cast<std::uint32_t>(high[i]), byte, axis));
    }
    return Vec3<F>{F::load(row[0]), F::load(row[1]), F::load(row[2])};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Triangles of `blocks`, one in each lane, by their numbers `ids` = leaf * TriangleBlock::kSize + lane. If
/// the numbers agree above bit `kNear`, a power of two up to kNearTriangles, they are gathered with one index
/// vector.
template <int N, class A, std::uint32_t kNear = kNearTriangles>
OKTETT_INLINE TriangleLanes<Simd<float, N, A>> gather_triangles(const TriangleBlock* blocks,
                                                                const std::uint32_t* ids) {
  using F = Simd<float, N, A>;
  constexpr std::uint32_t kSize = TriangleBlock::kSize, kAll = kSize * TriangleBlock::kLeaves;
  std::uint32_t differing = 0;
  for (int i = 1; i < N; ++i) differing |= ids[i] ^ ids[0];
  if (differing == 0)
    return broadcast_triangle<F>({blocks, ids[0] / kSize}, static_cast<int>(ids[0] % kSize));
  if (OKTETT_LIKELY(differing < kNear)) {
    using I = Simd<std::int32_t, N, A>;
    constexpr auto kShorts = static_cast<std::int32_t>(sizeof(TriangleBlock) / sizeof(std::uint16_t) / 2);
    constexpr auto kFloats = static_cast<std::int32_t>(sizeof(TriangleBlock) / sizeof(float));
    const TriangleBlock* near_blocks = blocks + ids[0] / kNear * (kNear / kAll);
    alignas(64) std::int32_t at[N], word[N], block[N];
    for (int i = 0; i < N; ++i) {
      const std::uint32_t id = ids[i] % kNear;
      block[i] = static_cast<std::int32_t>(id / kAll);
      at[i] = static_cast<std::int32_t>(id / kSize) * kShorts + static_cast<std::int32_t>(id % kSize);
    }
    gather(near_blocks->first.corners, I::load(at)).store(word);
    std::int32_t some = 0, all = ~0;
    for (int i = 0; i < N; ++i) some |= word[i];
    if (OKTETT_LIKELY((some & TriangleBlock::kPacked) == 0)) {
      const auto corner = [&](int which) {
        for (int i = 0; i < N; ++i) at[i] = block[i] * kFloats + (word[i] >> 4 * which & 15);
        const I index = I::load(at);
        const auto axis = [&](int k) { return gather(near_blocks->row(k), index); };
        return Vec3<F>{axis(0), axis(1), axis(2)};
      };
      return {corner(0), corner(1), corner(2)};
    }
    for (int i = 0; i < N; ++i) all &= word[i];
    if ((all & TriangleBlock::kPacked) != 0) return gather_packed<N, A>(near_blocks, block, word);
  }
  return [&]<int... i>(std::integer_sequence<int, i...>) {
    const TriangleLeaf leaf[N] = {{blocks, ids[i] / kSize}...};
    return gather_triangles<N, A>(leaf, ids);
  }
  (std::make_integer_sequence<int, N>());
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

/// The same for triangles `ids[i]` = leaf * TriangleBlock::kSize + lane of `blocks`.
template <int N, class A>
OKTETT_INLINE unsigned decide_pairs(const RayLanes<Simd<float, N, A>>& ray, const TriangleBlock* blocks,
                                    const std::uint32_t* ids, HitLanes<Simd<float, N, A>>& hit,
                                    unsigned* front = nullptr) {
  return decide_pairs<N, A>(ray, gather_triangles<N, A>(blocks, ids), hit, front);
}

}  // namespace oktett
