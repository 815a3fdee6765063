#pragma once
/// \file The surface nearest to a point: a search of the tree, the nearest boxes first. Boxes and triangles
/// are rejected by squared distances in float that are rounded down; what is left is decided in double, in
/// the same order of operations everywhere. What is rejected is farther than the best by more than all
/// rounding errors of that decision, so the order of visits and the instruction set change no result.

#include "accel/closest.h"
#include "accel/instance.h"
#include "core/simd_native.h"
#include "core/simd_order.h"
#include "kernels/closed/closest_triangle.h"

namespace oktett {

/// Squared distances from the point of `at` to eight boxes, rounded down: at most 1 - 2^-20 of the true ones.
/// Infinite ones become a number just below the greatest float, underflow is subtracted.
template <class F>
OKTETT_INLINE F box_distances(const PointPlace& at, const Vec3<F>& lo, const Vec3<F>& hi) {
  const F zero(0.0f);
  const auto gap = [&](const F& low, const F& high, int k) {
    return max(max(low - F(at.hi[k]), F(at.lo[k]) - high), zero);
  };
  const F x = gap(lo.x, hi.x, 0), y = gap(lo.y, hi.y, 1), z = gap(lo.z, hi.z, 2);
  const F square = fast_fma(x, x, fast_fma(y, y, z * z));
  const F least = max(square * F(1 - 0x1p-20f) - F(0x1p-140f), zero);
  return min(least, F(3.4028e38f));
}

/// The search for one point.
template <class A>
class ClosestSearch {
 public:
  ClosestSearch(const Accel& accel, Nearest& best) : accel_(accel), best_(best) {}

  /// First the triangles of block `hint`, which were nearest to another point, if it is one.
  OKTETT_INLINE void start(const PointPlace& at, NodeRef hint) {
    if (hint.is_triangles()) leaf(hint, at, std::numeric_limits<float>::infinity());
  }
  /// The leaf of the tree that holds what is nearest.
  NodeRef found() const { return found_; }

  /// Everything in `accel`. Instances that are nested are searched by a search of their own.
  OKTETT_NOINLINE void run(const PointPlace& at) {
    for (const LeafEntry& leaf : accel_.unbounded) table_leaf(leaf, at);
    if (accel_.root.is_none()) return;
    std::uint32_t refs[kStackSize + BvhNode::kWidth];
    float nears[kStackSize + BvhNode::kWidth];
    int size = 0;
    NodeRef ref = accel_.root;
    float limit = at.limit(best_);
    for (;;) {
      if (ref.is_leaf()) {
        leaf(ref, at, limit);
        limit = at.limit(best_);
      } else {
        const BvhNode& node = accel_.nodes[ref.node_index()];
        F near;
        const unsigned met = boxes(node, at, limit, near);
        size += store_descending<A>(near, met, node.child_bits(), refs + size, nears + size);
      }
      do {
        if (size == 0) return;
        --size;
      } while (nears[size] > limit);
      ref = NodeRef::from_bits(refs[size]);
    }
  }

 private:
  using F = Simd<float, BvhNode::kWidth, A>;
  static_assert(BvhNode::kWidth == TriangleBlock::kSize);

  /// The children of a node within `limit`.
  OKTETT_INLINE static unsigned boxes(const BvhNode& node, const PointPlace& at, float limit, F& near) {
    const auto plane = [&](int i) { return F::load(node.plane[i]); };
    const Vec3<F> lo{plane(0), plane(2), plane(4)}, hi{plane(1), plane(3), plane(5)};
    near = box_distances(at, lo, hi);
    return bits((near <= F(limit)) & (lo.x <= hi.x));
  }

  OKTETT_INLINE void leaf(NodeRef ref, const PointPlace& at, float limit) {
    const double before = best_.d2;
    if (ref.is_triangles())
      triangles(accel_.triangles(ref.triangle_leaf()), ref.triangle_count(), at, limit);
    else
      table_leaf(accel_.leaves[ref.table_index()], at);
    if (best_.d2 < before) found_ = ref;
  }

  OKTETT_NOINLINE void table_leaf(const LeafEntry& leaf, const PointPlace& at) {
    if (leaf.kind == Kind::triangle)
      return triangles(accel_.triangles(leaf.begin), leaf.count, at, at.limit(best_));
    if (!holds_instances(leaf.kind)) return closest_in_leaf(accel_, leaf, at, best_);
    const std::uint32_t first = first_instance(leaf);
    for (std::uint32_t k = first; k < first + leaf.count; ++k)
      with_instance(accel_, k, [&](const auto&, const Accel& child) {
        ClosestSearch(child, best_).run(place_in_instance(at, accel_, k));
      });
  }

  /// The first `count` triangles of a block.
  OKTETT_INLINE void triangles(const TriangleLeaf& leaf, int count, const PointPlace& at, float limit) {
    const TriangleLanes<F> t = load_triangles<F>(leaf);
    const auto least = [](const F& a, const F& b, const F& c) { return min(min(a, b), c); };
    const auto greatest = [](const F& a, const F& b, const F& c) { return max(max(a, b), c); };
    const Vec3<F> lo{least(t.a.x, t.b.x, t.c.x), least(t.a.y, t.b.y, t.c.y), least(t.a.z, t.b.z, t.c.z)};
    const Vec3<F> hi{greatest(t.a.x, t.b.x, t.c.x), greatest(t.a.y, t.b.y, t.c.y),
                     greatest(t.a.z, t.b.z, t.c.z)};
    const F near = box_distances(at, lo, hi);
    const unsigned maybe = bits(near <= F(limit)) & ((2u << (count - 1)) - 1);
    if (maybe != 0) decide(leaf, maybe, at);
  }

  /// The triangles in `maybe` in double.
  OKTETT_NOINLINE void decide(const TriangleLeaf& leaf, unsigned maybe, const PointPlace& at) {
    constexpr int N = kDoubleLanes<A>;
    using D = Simd<double, N, A>;
    const Vec3<D> p = broadcast<D>(at.world);
    for (int base = 0; base < TriangleBlock::kSize; base += N) {
      const unsigned part = maybe >> base & ((1u << N) - 1);
      if (part == 0) continue;
      const TriangleLanes<Simd<float, N, A>> t = load_triangles<Simd<float, N, A>>(leaf, base);
      Vec3<D> a = to_double(t.a), b = to_double(t.b), c = to_double(t.c);
      if (at.moved)
        a = map_point(at.to_world, a), b = map_point(at.to_world, b), c = map_point(at.to_world, c);
      const D d2 = closest_on_triangle(p, a, b, c).d2;
      alignas(64) double square[N];
      d2.store(square);
      for (unsigned near = bits(d2 <= D(best_.d2)) & part; near != 0; near &= near - 1) {
        const int k = __builtin_ctz(near);
        best_.keep(square[k], leaf.item(base + k), at.instance);
      }
    }
  }

  const Accel& accel_;
  Nearest& best_;
  NodeRef found_ = NodeRef::none();
};

}  // namespace oktett
