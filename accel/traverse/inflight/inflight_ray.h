#pragma once
/// \file The rays in flight of an interleaved traversal: what each needs at a node, at a leaf, and its stack.

#include "accel/traverse/inflight/ray_chunk.h"
#include "accel/traverse/leaf.h"
#include "core/simd_order.h"

namespace oktett {

/// What is held of a ray's nearest hit so far, where it is not a triangle that surely is hit and has not been
/// decided: then block * TriangleBlock::kSize + lane.
inline constexpr std::uint32_t kHoldsNothing = 0xffffffffu;
inline constexpr std::uint32_t kHoldsExact = 0xfffffffeu;

/// One ray in flight and its stack: the nodes and leaves that it has yet to visit, the next one last; entry 0
/// ends every stack. The first 64 bytes are what a node needs. An odd number of cache lines, so that slots do
/// not fall into the same sets.
struct alignas(64) InflightRay {
  static constexpr int kCapacity = (kStackSize + BvhNode::kWidth + 15) / 16 * 16;
  float inv[3], near_shift[3], far_shift[3];  ///< see RayChunk
  float tmin, limit;                          ///< limit = tmax + slack
  std::uint32_t near_row[3];                  ///< offset in a node's planes of the near ones, per axis
  NodeRef current;
  std::int32_t size;  ///< of the stack
  float o[3], d[3], slack;
  float weight_scale, det_scale;  ///< see guess_triangle
  float tmax, held_lo;  ///< bounds on the distance of the hit that is held; if none, the end of the ray
  std::uint32_t held;
  std::uint32_t ray;    ///< position in the span
  std::uint32_t exact;  ///< the slot's RayState is filled in
  std::uint32_t padding[2];
  std::uint32_t ref[kCapacity];
  float near[kCapacity];
  char odd[64];
};
static_assert(sizeof(InflightRay) / 64 % 2 == 1);

/// Copies ray `i` of a chunk into a slot, to start at `root`.
template <int W, class A>
OKTETT_INLINE void fill_slot(InflightRay& s, const RayChunk<W, A>& c, int i, NodeRef root) {
  for (int k = 0; k < 3; ++k) {
    s.inv[k] = c.inv[k][i], s.near_shift[k] = c.near_shift[k][i], s.far_shift[k] = c.far_shift[k][i];
    s.near_row[k] = static_cast<std::uint32_t>(BvhNode::kWidth) *
                    (2 * static_cast<std::uint32_t>(k) + (c.negative[k] >> i & 1));
    s.o[k] = c.o[k][i], s.d[k] = c.d[k][i];
  }
  s.tmin = c.tmin[i], s.slack = c.slack[i], s.weight_scale = c.d_max[i] * kWeightError,
  s.det_scale = c.d_max[i] * kVolumeError;
  s.tmax = s.held_lo = c.tmax[i], s.limit = s.tmax + s.slack;
  s.held = kHoldsNothing, s.exact = 0;
  s.ref[0] = NodeRef::none().bits(), s.near[0] = -1;
  s.ref[1] = root.bits(), s.near[1] = 0;
  s.size = 2;
}

/// Moves the end of the ray closer and drops what now lies behind it from the stack.
OKTETT_INLINE void shorten(InflightRay& s, float tmax) {
  s.tmax = tmax, s.limit = tmax + s.slack;
  const float limit = s.limit * kSlabRelativeSlack;
  int size = 0;
  for (int k = 0; k < s.size; ++k) {
    const std::uint32_t ref = s.ref[k];
    const float near = s.near[k];
    s.ref[size] = ref, s.near[size] = near;
    size += near <= limit;
  }
  s.size = size;
}

/// The children of `node` that the ray meets, as bits, and the near distances.
template <class A>
OKTETT_INLINE unsigned slot_node(const InflightRay& s, const BvhNode& node,
                                 Simd<float, BvhNode::kWidth, A>& near) {
  using F = Simd<float, BvhNode::kWidth, A>;
  constexpr std::uint32_t kOther = BvhNode::kWidth;
  const float* rows = &node.plane[0][0];
  F n[3], f[3];
  for (int k = 0; k < 3; ++k) {
    const F inv(s.inv[k]);
    n[k] = fast_fma(F::load(rows + s.near_row[k]), inv, F(s.near_shift[k]));
    f[k] = fast_fma(F::load(rows + (s.near_row[k] ^ kOther)), inv, F(s.far_shift[k]));
  }
  near = max(max(n[0], n[1]), max(n[2], F(s.tmin)));
  const F far = min(min(f[0], f[1]), min(f[2], F(s.limit)));
  return less_equal_lanes<A>(near, far * F(kSlabRelativeSlack));
}

/// Puts the children that the ray meets on its stack, the nearest last, and takes the last entry off.
template <Query Q, class A>
OKTETT_INLINE NodeRef step_node(InflightRay& s, const BvhNode& node) {
  Simd<float, BvhNode::kWidth, A> near;
  const unsigned met = slot_node<A>(s, node, near);
  const int size = s.size;
  const int count = Q == Query::any
                        ? store_compact<A>(met, node.child_bits(), s.ref + size)
                        : store_descending<A>(near, met, node.child_bits(), s.ref + size, s.near + size);
  s.size = size + count - 1;
  const NodeRef next = NodeRef::from_bits(s.ref[size + count - 1]);
  s.current = next;
  return next;
}

}  // namespace oktett
