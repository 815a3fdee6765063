#pragma once
/// \file The queues of an interleaved traversal: which rays in flight wait for which kind of step.

#include <algorithm>

#include "accel/traverse/inflight/inflight_ray.h"

namespace oktett {

/// Rays that are traced at the same time.
inline constexpr int kInflightRays = 48;
/// A round over the nodes takes at least this many steps. With fewer rays than that, a ray takes several
/// steps. The end of each round costs a mispredicted branch, so rounds must not be short.
inline constexpr int kRoundSteps = 16;

/// Rays that wait for one kind of step, first come, first served.
struct InflightQueue {
  static constexpr int kPlaces = 256;
  InflightRay **head = ray, **tail = ray;
  InflightRay* ray[kPlaces];

  int size() const { return static_cast<int>(tail - head); }
};

/// The queues of rays at nodes, at blocks of triangles, and of all others.
struct InflightQueues {
  InflightQueue nodes, leaves, others;

  /// The ends of the three queues while a round fills them, kept in registers.
  struct Tails {
    InflightRay **node, **leaf, **other;
  };

  void clear() {
    for (InflightQueue* q : {&nodes, &leaves, &others}) q->head = q->tail = q->ray;
  }

  bool empty() const { return nodes.size() + leaves.size() + others.size() == 0; }

  /// The ends of the queues, with room for a round and for one more, because enqueue() writes past the end.
  OKTETT_INLINE Tails tails() {
    constexpr int kMost = InflightQueue::kPlaces - std::max(kInflightRays, kRoundSteps) - 1;
    for (InflightQueue* q : {&nodes, &leaves, &others})
      if (OKTETT_UNLIKELY(q->tail > q->ray + kMost))
        q->tail = std::copy(q->head, q->tail, q->ray), q->head = q->ray;
    return {nodes.tail, leaves.tail, others.tail};
  }
  OKTETT_INLINE void keep(const Tails& t) {
    nodes.tail = t.node, leaves.tail = t.leaf, others.tail = t.other;
  }

  /// Queues `ray` for the kind of step that `ref` needs. Has no branches: the pointer is written to the ends
  /// of all three queues, and one of the ends moves on.
  static OKTETT_INLINE void enqueue(InflightRay& ray, NodeRef ref, Tails& t) {
    const std::uint32_t bits = ref.bits(), is_leaf = bits >> 31;
    // Arithmetic on the two top bits of NodeRef::bits: compilers turn comparisons into jumps.
    const std::uint32_t is_other = is_leaf & (bits >> 30);
    *t.node = &ray, t.node += 1 - is_leaf;
    *t.leaf = &ray, t.leaf += is_leaf - is_other;
    *t.other = &ray, t.other += is_other;
  }
};

/// Rays that wait for neither a node nor a block, sorted without branches by what they wait for. `kLeaving`
/// tells whether there may be rays on their way out of an instance.
template <bool kLeaving>
struct SortedOthers {
  using List = InflightRay * [kInflightRays + 1];
  List finished, at_spheres, at_leaf, leaving;
  InflightRay **finished_end = finished, **at_spheres_end = at_spheres, **at_leaf_end = at_leaf,
              **leaving_end = leaving;

  OKTETT_INLINE SortedOthers(InflightRay* const* begin, InflightRay* const* end) {
    for (InflightRay* const* at = begin; at != end; ++at) {
      const NodeRef ref = (*at)->current;
      const int none = ref.is_none(), out = kLeaving && ref.is_way_out(), spheres = ref.is_spheres();
      *finished_end = *at_spheres_end = *at_leaf_end = *at;
      if constexpr (kLeaving) *leaving_end = *at, leaving_end += out;
      finished_end += none, at_spheres_end += spheres, at_leaf_end += 1 - none - out - spheres;
    }
  }
};

}  // namespace oktett
