#pragma once
/// \file One ray through the tree: the eight boxes of a node at once, nearest child first.

#include "accel/exact_table.h"
#include "accel/ray_state.h"
#include "accel/traverse/csg_lanes.h"
#include "accel/traverse/leaf.h"
#include "accel/traverse/node_boxes.h"

namespace oktett {

// ---- Leaves of exact surfaces.

/// The rays in `lanes` of a state against the cells of a leaf.
template <int W, class A>
OKTETT_NOINLINE void leaf_exact(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r,
                                unsigned lanes) {
  constexpr int N = ExactCode<A>::kLanes;
  using F = typename ExactCode<A>::F;
  const ExactPoolBase& pool = accel.exact_pool(leaf.kind);
  const auto first = exact_code<A>(leaf.kind).first;
  for (std::uint32_t cell = leaf.begin; cell < leaf.begin + leaf.count; ++cell) {
    for (int base = 0; base < W; base += N) {
      const unsigned part = lanes >> base & ((1u << N) - 1);
      if (part == 0) continue;
      HitLanes<F> hits;
      const unsigned met = first(pool, cell, load_part<N>(r, base), part, hits);
      if (met == 0) continue;
      const std::uint32_t item = pool.item_of_cell(cell);
      each_hit(met, hits,
               [&](int i, float t, float u, float v) { accept_hit(r, base + i, t, u, v, item, kNoId); });
    }
  }
}

// ---- One ray through the tree.

/// The policy of queries: does nothing at the steps of a ray through the tree. trace_counts() has one that
/// counts them.
struct IgnoreSteps {
  void node(unsigned) const {}  ///< a node, and its children whose boxes the ray meets, a bit each
  void triangles(int) const {}  ///< a block of so many triangles
  void shapes(int) const {}     ///< so many shapes of another kind
  void instance() const {}      ///< an instance is entered
};

/// What a ray meets, see accel/traverse/inflight/solo.h.
template <Query Q, class A>
Hit trace_one(const Accel& accel, const Ray& ray);

/// A node or leaf that a ray has yet to visit, and the distance at which the ray enters its box.
struct StackEntry {
  NodeRef ref;
  float near;
};

template <Query Q, class A, class Steps = IgnoreSteps>
OKTETT_NOINLINE void traverse_single(const Accel& accel, RayState<1, A>& r, NodeRef start, Steps steps = {});

/// One ray against everything: the list of unbounded shapes, then the tree.
template <Query Q, class A, class Steps = IgnoreSteps>
void trace_single(const Accel& accel, RayState<1, A>& r, Steps steps = {});

/// The ray in the space of the instance's child.
template <class Instance, class A>
OKTETT_INLINE Ray ray_inside(const Instance& instance, const RayLanes<Simd<float, 1, A>>& outer) {
  Vec3<Simd<float, 1, A>> o, d;
  transform_rays(instance, outer, o, d);
  const auto point = [](const Vec3<Simd<float, 1, A>>& v) {
    return Vec3f{v.x.part[0].v, v.y.part[0].v, v.z.part[0].v};
  };
  return {point(o), outer.tmin.part[0].v, point(d), outer.tmax.part[0].v};
}

/// Keeps the hit that the ray has inside an instance, if it is the nearest so far.
template <class Instance, class A>
OKTETT_INLINE void accept_inside(const Instance& instance, RayState<1, A>& r, const Hit& h) {
  if (h.valid()) accept_hit(r, 0, h.t, h.u, h.v, h.item, outer_path(instance, h.instance));
}

/// Calls f(state) for the ray's state in the space of `inner`, which `instance` shows, unless the ray can hit
/// nothing there; then keeps the hit of that state, if it is the nearest so far.
template <class Instance, class A, class Function>
OKTETT_INLINE void inside_instance(const Instance& instance, const Accel& inner, RayState<1, A>& r,
                                   Function&& f) {
  RayState<1, A> child;
  if (child.set(ray_inside<Instance, A>(instance, load_rays(r)), inner.bounds) == 0) return;
  f(child);
  accept_inside(instance, r, child.hit(0));
}

/// One ray through one instance.
template <Query Q, class Instance, class A, class Steps>
OKTETT_NOINLINE void instance_single(const Instance& instance, const Accel& inner, RayState<1, A>& r,
                                     Steps steps) {
  steps.instance();
  if constexpr (std::is_same_v<A, ScalarIsa>)
    inside_instance(instance, inner, r, [&](RayState<1, A>& child) { trace_single<Q>(inner, child, steps); });
  else
    accept_inside(instance, r, trace_one<Q, A>(inner, ray_inside<Instance, A>(instance, load_rays(r))));
}

/// One ray against a leaf of the table.
template <Query Q, class A, class Steps = IgnoreSteps>
OKTETT_NOINLINE void table_leaf_single(const Accel& accel, const LeafEntry& leaf, RayState<1, A>& r,
                                       Steps steps = {}) {
  if (leaf.kind == Kind::triangle) {
    steps.triangles(leaf.count);
    return leaf_textbook_single(leaf.test, accel.triangles(leaf.begin), leaf.count, r);
  }
  if (holds_instances(leaf.kind))
    return each_instance(accel, leaf, [&](const auto& instance, const Accel& child) {
      instance_single<Q>(instance, child, r, steps);
      return Q != Query::any || r.item[0] == kNoId;
    });
  steps.shapes(leaf.count);
  if (leaf.kind == Kind::csg) {
    leaf_csg(accel, leaf, r, 1);
  } else if (is_exact(leaf.kind)) {
    leaf_exact(accel, leaf, r, 1);
  } else {
    visit_pool(leaf.kind, accel.pools, [&](auto shape, const auto& pool) {
      leaf_shape_single<decltype(shape)>(pool, leaf.begin, leaf.count, r);
    });
  }
}

/// Puts the children in `hit` on the stack, the nearest last.
OKTETT_INLINE int push_sorted(const NodeRef* child, unsigned hit, const float* near, StackEntry* stack,
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

/// One ray through the part of the tree below `start`.
template <Query Q, class A, class Steps>
OKTETT_NOINLINE void traverse_single(const Accel& accel, RayState<1, A>& r, NodeRef start, Steps steps) {
  StackEntry stack[kStackSize];
  int size = 0;
  NodeRef ref = start;
  if (ref.is_none()) return;
  alignas(64) float near[BvhNode::kWidth];
  for (;;) {
    if (!ref.is_leaf()) {
      const BvhNode& node = accel.nodes[ref.node_index()];
      const unsigned hit = node_single(node, r, near);
      steps.node(hit);
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
      if (ref.is_triangles()) {
        steps.triangles(ref.triangle_count());
        leaf_triangles_single(accel.triangles(ref.triangle_leaf()), ref.triangle_count(), r);
      } else {
        table_leaf_single<Q>(accel, accel.leaves[ref.table_index()], r, steps);
      }
      if (Q == Query::any && r.item[0] != kNoId) return;
    }
    const float limit = r.tmax[0] * kSlabRelativeSlack + r.slack[0];
    do {
      if (size == 0) return;
      --size;
    } while (stack[size].near > limit);
    ref = stack[size].ref;
  }
}

template <Query Q, class A, class Steps>
void trace_single(const Accel& accel, RayState<1, A>& r, Steps steps) {
  for (const LeafEntry& leaf : accel.unbounded) table_leaf_single<Q>(accel, leaf, r, steps);
  if (Q == Query::any && r.item[0] != kNoId) return;
  traverse_single<Q>(accel, r, accel.root, steps);
}

/// What a ray meets, by exact tests alone.
template <Query Q, class A>
OKTETT_NOINLINE Hit trace_exact(const Accel& accel, const Ray& ray) {
  RayState<1, A> r;
  if (r.set(ray, accel.bounds) != 0) trace_single<Q>(accel, r);
  return r.hit(0);
}

}  // namespace oktett
