#pragma once
/// \file One of the rays in flight of an interleaved traversal, and its step through a node.

#include <algorithm>

#include "accel/traverse/inflight/candidate.h"
#include "accel/traverse/inflight/ray_chunk.h"
#include "accel/traverse/leaf.h"
#include "accel/traverse/prefetch.h"
#include "core/simd_order.h"

namespace oktett {

/// The tree that a ray is in, where there are instances.
struct alignas(64) InflightTree {
  const Accel* accel;
  TreeBytes bytes;         ///< of `accel`
  std::uint32_t instance;  ///< that the ray is in, or kNoInstance; see with_instance()
  /// The instances of the leaf in which `instance` is that the ray has not entered yet: numbers from `next`
  /// to before `end`.
  std::uint32_t next, end;
  std::uint32_t candidate_instance;  ///< that the candidate hit is in, or kNoInstance

  /// The tree `outer`, in no instance.
  OKTETT_INLINE void set(const Accel& outer) {
    accel = &outer, bytes = TreeBytes(outer), instance = kNoInstance;
  }
};

/// An in-flight ray in the space of the tree that it is in, and how far it has come. A node needs the first
/// 64 bytes only.
struct alignas(64) InflightHead {
  float inv[3], near_shift[3], far_shift[3];  ///< see RayChunk
  float tmin, limit;                          ///< limit = tmax + slack
  std::uint32_t near_row[3];                  ///< offset in a node's planes of the near ones, per axis
  NodeRef current;                            ///< the node or leaf to visit next
  std::int32_t size;                          ///< of the stack
  float o[3], d[3], slack;
  float weight_scale, det_scale;  ///< see guess_triangle
  /// Bounds on the distance of the nearest hit so far: hit_lo <= t <= tmax. Without a hit, both are the end
  /// of the ray.
  float tmax, hit_lo;
  /// The nearest hit so far: a triangle that is surely hit and not decided yet, as block *
  /// TriangleBlock::kSize + lane; or kNoCandidate or kDecidedHit.
  std::uint32_t candidate;
  std::uint32_t index;      ///< of the ray in its batch
  std::uint32_t has_state;  ///< the ray's RayState is filled in
  std::uint32_t place;      ///< of the ray in its beam
  std::uint32_t padding;

  OKTETT_INLINE void set_end(float t) { tmax = t, limit = t + slack; }
};

/// One ray in flight and its stack. The size is an odd number of cache lines, so that the rays do not fall
/// into the same sets of the cache.
struct InflightRay : InflightHead {
  static constexpr int kCapacity = (kStackSize + 2 * BvhNode::kWidth + 15) / 16 * 16;
  InflightTree in;
  /// Stack entries: nodes and leaves yet to visit, the next one last, and their near distances. Entry 0 is
  /// NodeRef::none(), which ends the ray.
  std::uint32_t ref[kCapacity];
  float near_of[kCapacity];

  OKTETT_INLINE void push(NodeRef entry, float near) {
    ref[size] = entry.bits(), near_of[size] = near;
    ++size;
  }
};
static_assert(sizeof(InflightRay) / 64 % 2 == 1);

/// Takes what nodes need of origin and direction from ray `i` of a chunk.
template <int W, class A>
OKTETT_INLINE void set_node_lines(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  for (int k = 0; k < 3; ++k) {
    ray.inv[k] = c.inv[k][i], ray.near_shift[k] = c.near_shift[k][i], ray.far_shift[k] = c.far_shift[k][i];
    ray.near_row[k] = near_offset(static_cast<std::uint32_t>(k), c.negative[k] >> i & 1);
  }
  ray.slack = c.slack[i];
}

/// Takes origin and direction, and what triangles need of them.
template <int W, class A>
OKTETT_INLINE void set_triangle_lines(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  for (int k = 0; k < 3; ++k) ray.o[k] = c.o[k][i], ray.d[k] = c.d[k][i];
  ray.weight_scale = c.d_max[i] * kWeightError, ray.det_scale = c.d_max[i] * kVolumeError;
}

/// Takes what nodes and triangles need of ray `i` of a chunk, but for its range.
template <int W, class A>
OKTETT_INLINE void set_lines(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  set_node_lines(ray, c, i);
  set_triangle_lines(ray, c, i);
}

/// Takes where ray `i` of a chunk begins and ends.
template <int W, class A>
OKTETT_INLINE void set_range(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  ray.tmin = c.tmin[i];
  ray.set_end(c.tmax[i]);
}

/// Starts ray `i` of a chunk at `root`. `triangles`: whether the ray may meet triangles or go into instances.
template <int W, class A>
OKTETT_INLINE void start_ray(InflightRay& ray, const RayChunk<W, A>& c, int i, NodeRef root, bool triangles) {
  set_node_lines(ray, c, i);
  if (triangles) set_triangle_lines(ray, c, i);
  set_range(ray, c, i);
  ray.hit_lo = c.tmax[i], ray.candidate = kNoCandidate, ray.has_state = 0, ray.size = 0;
  ray.push(NodeRef::none(), -1), ray.push(root, 0);
}

/// Ends the ray at `tmax` and removes the stack entries that lie beyond.
template <class A>
OKTETT_INLINE void shorten(InflightRay& ray, float tmax) {
  using F = Simd<float, BvhNode::kWidth, A>;
  ray.set_end(tmax);
  const F limit(ray.limit * kSlabRelativeSlack);
  int size = 0;
  for (int k = 0; k < ray.size; k += BvhNode::kWidth) {
    const unsigned present = (2u << std::min(ray.size - 1 - k, BvhNode::kWidth - 1)) - 1;
    const unsigned kept = less_equal_lanes<A>(F::load(ray.near_of + k), limit) & present;
    store_compact<A>(kept, ray.near_of + k, ray.near_of + size);
    size += store_compact<A>(kept, ray.ref + k, ray.ref + size);
  }
  ray.size = size;
}

/// The slab test in fused form: the children of `node` that the ray meets, as bits, and their near distances.
template <class A>
OKTETT_INLINE unsigned node_inflight(const InflightHead& ray, const BvhNode& node,
                                     Simd<float, BvhNode::kWidth, A>& near) {
  using F = Simd<float, BvhNode::kWidth, A>;
  const auto each = [](const float(&v)[3]) { return std::array{F(v[0]), F(v[1]), F(v[2])}; };
  return fused_slab<A>(node, ray.near_row, each(ray.inv), each(ray.near_shift), each(ray.far_shift),
                       F(ray.tmin), F(ray.limit), near);
}

/// Pushes the children that the ray meets, the nearest last (for Query::any in any order), and pops the next
/// node or leaf.
template <Query Q, class A>
OKTETT_INLINE NodeRef step_node(InflightRay& ray, const BvhNode& node) {
  Simd<float, BvhNode::kWidth, A> near;
  const unsigned met = node_inflight<A>(ray, node, near);
  const int size = ray.size;
  const int count =
      Q == Query::any ? store_compact<A>(met, node.child_bits(), ray.ref + size)
                      : store_descending<A>(near, met, node.child_bits(), ray.ref + size, ray.near_of + size);
  ray.size = size + count - 1;
  const NodeRef next = NodeRef::from_bits(ray.ref[size + count - 1]);
  ray.current = next;
  return next;
}

}  // namespace oktett
