#pragma once
/// \file A packet of W rays through the tree.
///
/// At a node, one slab test with intervals of origins and reciprocal directions rejects children for the
/// whole packet, all eight boxes at once. Each child that remains is tested against the W rays. When few rays
/// of a packet are left, each goes on alone.

#include <algorithm>

#include "accel/traverse/single.h"
#include "accel/traverse/ways.h"

namespace oktett {

/// Packets of fewer rays do not pay. The rays of a packet share an octant, so that near planes are the same
/// for all, and the axis of their greatest direction component, so that triangles are sheared alike.
template <int W>
inline constexpr int kMinPacketRays = W >= 16  ? 4
                                      : W >= 8 ? 3
                                               : 2;

/// Intervals over the rays of a packet, from which near distances come out too small and far ones too great,
/// if anything. Rounding is monotone, so this holds for the rounded distances of each ray too.
struct PacketInterval {
  float near_o[3], far_o[3], near_inv[3], far_inv[3];
  float tmin, slack;
  float d_max;
  int near_plane[3], far_plane[3];
  bool one_origin;  ///< all rays start at one point
};

/// The intervals over the rays in `lanes`.
template <int W, class A>
OKTETT_INLINE PacketInterval packet_interval(const RayState<W, A>& r, unsigned lanes) {
  PacketInterval p;
  const int first = __builtin_ctz(lanes);
  p.tmin = r.tmin[first], p.slack = r.slack[first], p.d_max = r.d_max[first];
  float lo_o[3], hi_o[3], lo_i[3], hi_i[3];
  for (int k = 0; k < 3; ++k) lo_o[k] = hi_o[k] = r.o[k][first], lo_i[k] = hi_i[k] = r.inv[k][first];
  for (unsigned rest = lanes & (lanes - 1); rest != 0; rest &= rest - 1) {
    const int i = __builtin_ctz(rest);
    p.tmin = r.tmin[i] < p.tmin ? r.tmin[i] : p.tmin;
    p.slack = r.slack[i] > p.slack ? r.slack[i] : p.slack;
    p.d_max = r.d_max[i] > p.d_max ? r.d_max[i] : p.d_max;
    for (int k = 0; k < 3; ++k) {
      const float o = r.o[k][i], v = r.inv[k][i];
      lo_o[k] = o < lo_o[k] ? o : lo_o[k], hi_o[k] = o > hi_o[k] ? o : hi_o[k];
      lo_i[k] = v < lo_i[k] ? v : lo_i[k], hi_i[k] = v > hi_i[k] ? v : hi_i[k];
    }
  }
  for (int k = 0; k < 3; ++k) {
    const bool negative = r.negative[k] >> first & 1;
    p.near_plane[k] = 2 * k + negative, p.far_plane[k] = 2 * k + !negative;
    p.near_o[k] = negative ? lo_o[k] : hi_o[k], p.far_o[k] = negative ? hi_o[k] : lo_o[k];
    // The near side takes the reciprocal of least magnitude, the far side that of greatest.
    p.near_inv[k] = negative ? hi_i[k] : lo_i[k], p.far_inv[k] = negative ? lo_i[k] : hi_i[k];
  }
  p.one_origin = lo_o[0] == hi_o[0] && lo_o[1] == hi_o[1] && lo_o[2] == hi_o[2];
  return p;
}

/// Children of `node` that a ray of the packet may meet; near[k] is a lower bound on the near distances.
template <class A>
OKTETT_INLINE unsigned node_interval(const BvhNode& node, const PacketInterval& p, float tmax, float* near) {
  using F = Simd<float, BvhNode::kWidth, A>;
  F n(p.tmin), f(tmax);
  for (int k = 0; k < 3; ++k) {
    n = max((F::load(node.plane[p.near_plane[k]]) - F(p.near_o[k])) * F(p.near_inv[k]), n);
    f = min((F::load(node.plane[p.far_plane[k]]) - F(p.far_o[k])) * F(p.far_inv[k]), f);
  }
  n.store(near);
  return bits(n <= fast_fma(f, F(kSlabRelativeSlack), F(p.slack)));
}

/// Rays that meet child `c` of `node`.
template <int W, class A>
OKTETT_INLINE unsigned child_packet(const BvhNode& node, int c, const RayState<W, A>& r,
                                    const PacketInterval& p) {
  using F = Simd<float, W, A>;
  F near_planes[3], far_planes[3];
  for (int k = 0; k < 3; ++k)
    near_planes[k] = F(node.plane[p.near_plane[k]][c]), far_planes[k] = F(node.plane[p.far_plane[k]][c]);
  F n, f;
  slab_interval({F::load(r.o[0]), F::load(r.o[1]), F::load(r.o[2])},
                {F::load(r.inv[0]), F::load(r.inv[1]), F::load(r.inv[2])}, near_planes, far_planes,
                F::load(r.tmin), F::load(r.tmax), F::load(r.slack), n, f);
  return bits(n <= f);
}

/// A stack entry: a node or leaf, a lower bound on its near distances, and the rays that meet its box.
struct PacketEntry {
  NodeRef ref;
  float near;
  unsigned lanes;
};

/// The rays in `lanes` through one instance. The transform may put them into different octants, so they are
/// grouped anew.
template <Query Q, class Instance, int W, class A>
OKTETT_NOINLINE void instance_packet(const Instance& instance, const Accel& inner, RayState<W, A>& r,
                                     unsigned lanes) {
  const auto outer = load_rays(r);
  Vec3<Simd<float, W, A>> o, d;
  transform_rays(instance, outer, o, d);
  RayState<W, A> child;
  lanes &= child.set(o, d, outer.tmin, outer.tmax, inner.bounds);
  trace_packet<Q>(inner, child, lanes);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    if (child.item[i] != kNoId)
      accept_hit(r, i, child.tmax[i], child.u[i], child.v[i], child.item[i],
                 outer_path(instance, child.path[i]));
  }
}

/// The rays in `lanes`, each alone, through the part of the tree below `start`.
template <Query Q, int W, class A>
OKTETT_INLINE void traverse_each(const Accel& accel, RayState<W, A>& r, unsigned lanes, NodeRef start) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    RayState<1, A> one = r.lane(i);
    traverse_single<Q>(accel, one, start);
    r.take(i, one, 0);
  }
}

template <Query Q, int W, class A>
OKTETT_NOINLINE void table_leaf_packet(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r,
                                       unsigned lanes) {
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    if (leaf.kind == Kind::triangle) {
      leaf_textbook_packet(leaf.test, accel.triangles(leaf.begin), leaf.count, r, lanes);
    } else if (holds_instances(leaf.kind)) {
      each_instance(accel, leaf, [&](const auto& instance, const Accel& child) {
        if (Q == Query::any) lanes &= ~found_lanes(r, lanes);
        if (lanes != 0) instance_packet<Q>(instance, child, r, lanes);
        return lanes != 0;
      });
    } else if (leaf.kind == Kind::csg) {
      leaf_csg(accel, leaf, r, lanes);
    } else if (is_exact(leaf.kind)) {
      leaf_exact(accel, leaf, r, lanes);
    } else {
      visit_pool(leaf.kind, accel.pools, [&](auto shape, const auto& pool) {
        leaf_shape_packet<decltype(shape)>(pool, leaf.begin, leaf.count, r, lanes);
      });
    }
  }
}

/// Greatest tmax among `lanes`.
template <int W, class A>
OKTETT_INLINE float farthest(const RayState<W, A>& r, unsigned lanes) {
  using F = Simd<float, W, A>;
  return horizontal_max(select(F::M::from_bits(lanes), F::load(r.tmax), F(0.0f)));
}

/// The rays in `lanes` through the tree; all are of one octant and have the same axis of greatest direction.
template <Query Q, int W, class A>
OKTETT_NOINLINE void traverse_packet(const Accel& accel, RayState<W, A>& r, unsigned lanes) {
  using F = Simd<float, W, A>;
  const int first = __builtin_ctz(lanes);
  const PacketInterval interval = packet_interval(r, lanes);
  const int z = r.z_axis_of(first);
  PacketEntry stack[kStackSize];
  int size = 0;
  stack[size++] = {accel.root, 0, lanes};
  float tmax = farthest(r, lanes);
  alignas(64) float near[BvhNode::kWidth];
  while (size > 0) {
    const PacketEntry e = stack[--size];
    unsigned active =
        e.lanes & bits(F(e.near) <= fast_fma(F::load(r.tmax), F(kSlabRelativeSlack), F::load(r.slack)));
    if (Q == Query::any) active &= lanes;
    if (active == 0) continue;
    if (__builtin_popcount(active) < kMinPacketRays<W>) {
      traverse_each<Q>(accel, r, active, e.ref);
    } else if (!e.ref.is_leaf()) {
      const BvhNode& node = accel.nodes[e.ref.node_index()];
      const int base = size;
      for (unsigned hit = node_interval<A>(node, interval, tmax, near); hit != 0; hit &= hit - 1) {
        const int c = __builtin_ctz(hit);
        const unsigned met = child_packet(node, c, r, interval) & active;
        if (met == 0) continue;
        int at = size++;
        while (at > base && stack[at - 1].near < near[c]) stack[at] = stack[at - 1], --at;
        stack[at] = {node.child[c], near[c], met};
      }
      continue;
    } else if (e.ref.is_triangles()) {
      const TriangleLeaf leaf = accel.triangles(e.ref.triangle_leaf());
      if (interval.one_origin)
        leaf_triangles_origin(leaf, e.ref.triangle_count(), r, active, z,
                              {interval.near_o[0], interval.near_o[1], interval.near_o[2]}, interval.d_max);
      else
        leaf_triangles_packet(leaf, e.ref.triangle_count(), r, active, z);
    } else {
      table_leaf_packet<Q>(accel, accel.leaves[e.ref.table_index()], r, active);
    }
    if (Q == Query::any) {
      lanes &= ~found_lanes(r, lanes);
      if (lanes == 0) return;
    }
    tmax = farthest(r, lanes);
  }
}

template <Query Q, int W, class A>
void trace_packet(const Accel& accel, RayState<W, A>& r, unsigned lanes) {
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    for (const LeafEntry& leaf : accel.unbounded) table_leaf_packet<Q>(accel, leaf, r, lanes);
    if (Q == Query::any) lanes &= ~found_lanes(r, lanes);
    if (accel.root.is_none()) return;
    while (lanes != 0) {
      const int first = __builtin_ctz(lanes);
      unsigned group = lanes & r.z_axis[r.z_axis_of(first)];
      for (int k = 0; k < 3; ++k) group &= r.negative[k] >> first & 1 ? r.negative[k] : ~r.negative[k];
      lanes &= ~group;
      if (__builtin_popcount(group) >= kMinPacketRays<W>)
        traverse_packet<Q>(accel, r, group);
      else
        traverse_each<Q>(accel, r, group, accel.root);
    }
  }
}

}  // namespace oktett
