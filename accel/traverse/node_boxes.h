#pragma once
/// \file The eight boxes of a node against one ray, and the loop over nodes of queries that want every
/// crossing.

#include "accel/ray_state.h"

namespace oktett {

/// The boxes of `node` against one ray: bit k is set if child k is met; near[k] is where the ray enters its
/// box.
template <class A>
OKTETT_INLINE unsigned node_single(const BvhNode& node, const RayState<1, A>& r, float* near) {
  using F = Simd<float, BvhNode::kWidth, A>;
  F near_planes[3], far_planes[3];
  for (int k = 0; k < 3; ++k) {
    const unsigned negative = r.negative[k] & 1;
    near_planes[k] = F::load(node.plane[2 * k + static_cast<int>(negative)]);
    far_planes[k] = F::load(node.plane[2 * k + static_cast<int>(negative ^ 1)]);
  }
  F n, f;
  slab_interval({F(r.o[0][0]), F(r.o[1][0]), F(r.o[2][0])}, {F(r.inv[0][0]), F(r.inv[1][0]), F(r.inv[2][0])},
                near_planes, far_planes, F(r.tmin[0]), F(r.tmax[0]), F(r.slack[0]), n, f);
  n.store(near);
  return bits(n <= f);
}

/// Visits all leaves of a tree that rays meet, in no particular order. `lanes` are the rays, a bit each.
/// `meet(node, lanes, push)` calls push(child, rays) for each child of a node, with the rays of `lanes` that
/// meet its box; `visit(leaf, lanes)` returns false to end the loop. Returns false if it was ended.
template <class Meet, class Visit>
OKTETT_INLINE bool visit_leaves(const Accel& accel, unsigned lanes, Meet&& meet, Visit&& visit) {
  struct Entry {
    NodeRef ref;
    unsigned lanes;
  };
  if (accel.root.is_none()) return true;
  Entry stack[kStackSize];
  int size = 0;
  stack[size++] = {accel.root, lanes};
  while (size > 0) {
    const Entry e = stack[--size];
    if (e.ref.is_leaf()) {
      if (!visit(e.ref, e.lanes)) return false;
      continue;
    }
    const BvhNode& node = accel.nodes[e.ref.node_index()];
    meet(node, e.lanes, [&](int child, unsigned met) {
      if (met != 0) stack[size++] = {node.child[child], met};
    });
  }
  return true;
}

}  // namespace oktett
