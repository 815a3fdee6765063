#pragma once
/// \file One ray through the tree: the eight boxes of a node at once, nearest child first.

#include "accel/csg/csg_trace.h"
#include "accel/exact.h"
#include "accel/traverse/leaf.h"

namespace oktett {

struct SingleEntry {
  NodeRef ref;
  float near;
};

template <Query Q, int W, class A>
OKTETT_NOINLINE void traverse_single(const Accel& accel, RayState<W, A>& r, int i, NodeRef start);

/// Ray `i` against everything: the list of unbounded shapes, then the tree.
template <Query Q, int W, class A>
void trace_single(const Accel& accel, RayState<W, A>& r, int i);

/// Ray `i` through one instance.
template <Query Q, class Instance, int W, class A>
OKTETT_NOINLINE void instance_single(const Instance& instance, const Accel& inner, RayState<W, A>& r, int i) {
  const auto outer = broadcast_ray<1>(r, i);
  Vec3<Simd<float, 1, A>> o, d;
  transform_rays(instance, outer, o, d);
  RayState<1, A> child;
  if (child.set(o, d, outer.tmin, outer.tmax, inner.bounds) == 0) return;
  trace_single<Q>(inner, child, 0);
  if (child.item[0] != kNoId)
    accept_hit(r, i, child.tmax[0], child.u[0], child.v[0], child.item[0],
               outer_path(instance, child.path[0]));
}

/// Ray `i` against a leaf of the table.
template <Query Q, int W, class A>
OKTETT_NOINLINE void table_leaf_single(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r, int i) {
  if (leaf.kind == Kind::triangle) {
    leaf_textbook_single(leaf.test, accel.blocks[leaf.begin], leaf.count, r, i);
  } else if (holds_instances(leaf.kind)) {
    each_instance(accel, leaf, [&](const auto& instance, const Accel& child) {
      instance_single<Q>(instance, child, r, i);
      return Q != Query::any || r.item[i] == kNoId;
    });
  } else if (leaf.kind == Kind::csg) {
    leaf_csg(accel, leaf, r, 1u << i);
  } else if (is_exact(leaf.kind)) {
    leaf_exact(accel, leaf, r, 1u << i);
  } else {
    visit_pool(leaf.kind, accel.pools, [&](auto shape, const auto& pool) {
      leaf_shape_single<decltype(shape)>(pool, leaf.begin, leaf.count, r, i);
    });
  }
}

/// The boxes of `node` against ray `i`: bit k set if child k is met, its distance in near[k].
template <int W, class A>
OKTETT_INLINE unsigned node_single(const BvhNode& node, const RayState<W, A>& r, int i, float* near) {
  using F = Simd<float, BvhNode::kWidth, A>;
  F near_planes[3], far_planes[3];
  for (int k = 0; k < 3; ++k) {
    const unsigned negative = r.negative[k] >> i & 1;
    near_planes[k] = F::load(node.plane[2 * k + static_cast<int>(negative)]);
    far_planes[k] = F::load(node.plane[2 * k + static_cast<int>(negative ^ 1)]);
  }
  F n, f;
  slab_interval({F(r.o[0][i]), F(r.o[1][i]), F(r.o[2][i])}, {F(r.inv[0][i]), F(r.inv[1][i]), F(r.inv[2][i])},
                near_planes, far_planes, F(r.tmin[i]), F(r.tmax[i]), F(r.slack[i]), n, f);
  n.store(near);
  return bits(n <= f);
}

/// Puts the children in `hit` on the stack, the nearest last.
OKTETT_INLINE int push_sorted(const NodeRef* child, unsigned hit, const float* near, SingleEntry* stack,
                              int size) {
  const int base = size;
  for (; hit != 0; hit &= hit - 1) {
    const int k = __builtin_ctz(hit);
    int at = size++;
    while (at > base && stack[at - 1].near < near[k]) stack[at] = stack[at - 1], --at;
    stack[at] = {child[k], near[k]};
  }
  return size;
}

template <Query Q, int W, class A>
OKTETT_NOINLINE void traverse_single(const Accel& accel, RayState<W, A>& r, int i, NodeRef start) {
  SingleEntry stack[kStackSize];
  int size = 0;
  NodeRef ref = start;
  if (ref.is_none()) return;
  alignas(64) float near[BvhNode::kWidth];
  for (;;) {
    if (!ref.is_leaf()) {
      const BvhNode& node = accel.nodes[ref.node_index()];
      const unsigned hit = node_single(node, r, i, near);
      if (hit != 0) {
        if ((hit & (hit - 1)) == 0) {
          ref = node.child[__builtin_ctz(hit)];
          continue;
        }
        size = push_sorted(node.child, hit, near, stack, size);
        ref = stack[--size].ref;
        continue;
      }
    } else {
      if (ref.is_triangles())
        leaf_triangles_single(accel.blocks[ref.block()], ref.triangle_count(), r, i);
      else
        table_leaf_single<Q>(accel, accel.leaves[ref.table_index()], r, i);
      if (Q == Query::any && r.item[i] != kNoId) return;
    }
    const float limit = r.tmax[i] * kSlabRelativeSlack + r.slack[i];
    do {
      if (size == 0) return;
      --size;
    } while (stack[size].near > limit);
    ref = stack[size].ref;
  }
}

template <Query Q, int W, class A>
void trace_single(const Accel& accel, RayState<W, A>& r, int i) {
  for (const LeafEntry& leaf : accel.unbounded) table_leaf_single<Q>(accel, leaf, r, i);
  if (Q == Query::any && r.item[i] != kNoId) return;
  traverse_single<Q>(accel, r, i, accel.root);
}

}  // namespace oktett
