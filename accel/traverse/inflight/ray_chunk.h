#pragma once
/// \file Rays prepared for the slab test in fused form, plane * (1/d) - o * (1/d). The bounds on its rounding
/// errors are part of the ray.

#include <array>

#include "accel/ray_state.h"
#include "accel/traverse/load_span.h"
#include "core/lanes.h"
#include "core/simd_order.h"
#include "kernels/closed/slab.h"
#include "kernels/triangle/triangle_classify.h"

namespace oktett {

/// Rays that one vector of floats holds: those of a chunk, and of a packet where nothing says how many.
template <class A>
inline constexpr int kChunkRays = std::is_same_v<A, Avx512Isa> ? 16 : 8;

/// Least extent of scene and origin for which products do not underflow; other rays are not tame.
inline constexpr float kChunkMinExtent = 0x1p-36f;
/// A direction component below this part of the greatest is replaced by it.
inline constexpr float kChunkMinComponent = 0x1p-40f;
/// Relative error of o * (1/d), of its sum with the error, and a reserve.
inline constexpr float kChunkShiftError = 0x1p-21f;

/// What the distances to planes take, along one axis of each lane: plane * inverse + near_shift for a near
/// plane, plane * inverse + far_shift for a far one.
template <class F>
struct SlabLines {
  F inverse, near_shift, far_shift;
};

template <class F>
OKTETT_INLINE F chunk_slack(const F& reach) {
  return fast_fma(reach, F(2 * kSlabAbsoluteSlack), F(2 * kSlabUnderflow));
}

/// `reach` is the distance in t to the far end of the scene, `least` the component that replaces smaller
/// ones.
template <class F>
OKTETT_INLINE SlabLines<F> slab_lines(const F& origin, const F& direction, const F& reach, const F& least,
                                      const F& extent) {
  const auto tiny = abs(direction) < least;
  const F inverse = F(1.0f) / select(tiny, flip_sign(least, direction + F(0.0f)), direction);
  const F shift = origin * inverse;
  // Without a fused operation, the product with the plane rounds too.
  const F size = kHasFma<typename F::Isa> && F::kWidth > 1 ? abs(shift) : abs(shift) + abs(inverse) * extent;
  // Replacing a tiny component turns the ray; it strays no farther than twice the way of the new component.
  const F error = fast_fma(size, F(kChunkShiftError), select(tiny, F(4.0f) * reach, F(0.0f)));
  return {inverse, -(shift + error), (error + chunk_slack(reach)) - shift};
}

/// The offset, in a node's planes, of the near ones along an axis.
OKTETT_INLINE std::uint32_t near_offset(std::uint32_t axis, unsigned negative) {
  return static_cast<std::uint32_t>(BvhNode::kWidth) * (2 * axis + negative);
}

/// The slab test in fused form: the children of `node` that a ray meets, as bits, and their near distances.
/// `near_row` are the offsets of the near planes in the node, per axis; see RayChunk for the others.
template <class A, class F = Simd<float, BvhNode::kWidth, A>>
OKTETT_INLINE unsigned fused_slab(const BvhNode& node, const std::uint32_t (&near_row)[3],
                                  const std::array<F, 3>& inverse, const std::array<F, 3>& near_shift,
                                  const std::array<F, 3>& far_shift, const F& tmin, const F& limit, F& near) {
  constexpr std::uint32_t kOther = BvhNode::kWidth;
  const float* rows = &node.plane[0][0];
  F n[3], f[3];
  for (std::size_t k = 0; k < 3; ++k) {
    n[k] = fast_fma(F::load(rows + near_row[k]), inverse[k], near_shift[k]);
    f[k] = fast_fma(F::load(rows + (near_row[k] ^ kOther)), inverse[k], far_shift[k]);
  }
  near = max(max(n[0], n[1]), max(n[2], tmin));
  const F far = min(min(f[0], f[1]), min(f[2], limit));
  return less_equal_lanes<A>(near, far * F(kSlabRelativeSlack));
}

/// W rays in columns. A box is met if
///     max(near plane * inv + near_shift, tmin) <= min(far plane * inv + far_shift, tmax + slack)
///                                                 * kSlabRelativeSlack
/// This rejects no box that contains a hit with t <= tmax (docs/numerics.md). The near planes are the low
/// ones where `negative` is 0, else the high ones.
template <int W, class A>
struct alignas(64) RayChunk {
  using F = Simd<float, W, A>;
  float o[3][W], d[3][W], d_max[W];
  float inv[3][W], near_shift[3][W], far_shift[3][W];
  float tmin[W], tmax[W], slack[W];
  unsigned negative[3];
  unsigned tame;  ///< rays that can hit anything (see Ray) and whose numbers suit the error bounds

  /// Sets the W rays from position `b` of a batch on; lanes past its end are not tame. `extent` is the
  /// greatest |coordinate| of the scene.
  OKTETT_INLINE void set(const RaySpan& rays, std::size_t b, float extent) {
    const std::size_t rest = rays.size - b;
    set(load_span<F>(rays, b), rest >= W ? ~0u : (1u << rest) - 1, F(extent));
  }

  /// Sets W rays; those that are not in `present` are not tame. Each has an extent of its own.
  OKTETT_INLINE void set(const RayLanes<F>& r, unsigned present, const F& extent) {
    const F zero(0.0f), big(std::numeric_limits<float>::max());
    const Vec3<F> dir = flush_direction(r.d);
    const F ax = abs(dir.x), ay = abs(dir.y), az = abs(dir.z);
    const F dm = max(az, max(ay, ax));
    const F om = max(abs(r.o.z), max(abs(r.o.y), abs(r.o.x)));
    // Every component is compared, because a comparison is false on NaN while max() may lose it.
    const auto finite = (ax <= big) & (ay <= big) & (az <= big) & (abs(r.o.x) <= big) & (abs(r.o.y) <= big) &
                        (abs(r.o.z) <= big);
    const auto usable = finite & (zero < dm) & (zero <= r.tmin) & (r.tmin < r.tmax);
    const F span = om + extent;
    const unsigned valid = bits(usable) & present;
    tame = valid & bits((F(kChunkMinExtent) <= span) & (span <= F(kClassifyMaxExtent)) &
                        (F(1 / kClassifyMaxDirection) <= dm) & (dm <= F(kClassifyMaxDirection)));
    const F reach = span / dm, least = dm * F(kChunkMinComponent);
    set_axis(0, r.o.x, dir.x, reach, least, extent);
    set_axis(1, r.o.y, dir.y, reach, least, extent);
    set_axis(2, r.o.z, dir.z, reach, least, extent);
    dm.store(d_max);
    // Adding zero turns -0 into 0, because near distances are sorted by their bits.
    (r.tmin + zero).store(tmin), r.tmax.store(tmax), chunk_slack(reach).store(slack);
  }

  /// The rays that meet a box each, as bits.
  OKTETT_INLINE unsigned meets(const Vec3<F>& lo, const Vec3<F>& hi) const {
    F near = F::load(tmin), far = F::load(tmax) + F::load(slack);
    const auto axis = [&](int k, const F& low, const F& high) {
      const auto turned = F::M::from_bits(negative[k]);
      const F inverse = F::load(inv[k]);
      near = max(fast_fma(select(turned, high, low), inverse, F::load(near_shift[k])), near);
      far = min(fast_fma(select(turned, low, high), inverse, F::load(far_shift[k])), far);
    };
    axis(0, lo.x, hi.x), axis(1, lo.y, hi.y), axis(2, lo.z, hi.z);
    return bits(near <= far * F(kSlabRelativeSlack));
  }

 private:
  OKTETT_INLINE void set_axis(int k, const F& origin, const F& direction, const F& reach, const F& least,
                              const F& extent) {
    const SlabLines<F> line = slab_lines(origin, direction, reach, least, extent);
    origin.store(o[k]), direction.store(d[k]), line.inverse.store(inv[k]);
    line.near_shift.store(near_shift[k]), line.far_shift.store(far_shift[k]);
    negative[k] = bits(line.inverse < F(0.0f));
  }
};

}  // namespace oktett
