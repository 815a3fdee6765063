#pragma once
/// \file Every crossing of one ray, in no particular order.

#include "accel/hit_sink.h"
#include "accel/traverse/single.h"

namespace oktett {

/// -1 if the ray meets triangle `k` of a block from its front, 1 if from behind. The textbook tests do not
/// tell.
template <class A>
OKTETT_INLINE float turn_of(const TriangleLeaf& leaf, int k, const RayState<1, A>& r) {
  const auto corner = [&](int c, int axis) { return static_cast<double>(leaf.vertex(c, k)[axis]); };
  double side = 0;
  for (int x = 0; x < 3; ++x) {
    const int y = (x + 1) % 3, z = (x + 2) % 3;
    const double n = (corner(1, y) - corner(0, y)) * (corner(2, z) - corner(0, z)) -
                     (corner(1, z) - corner(0, z)) * (corner(2, y) - corner(0, y));
    side += n * r.d[x][0];
  }
  return side < 0 ? -1.0f : 1.0f;
}

/// Appends all hits of a ray with the triangles of a block.
template <class A>
void collect_triangles(const Accel& accel, const TriangleLeaf& leaf, int count, TriangleTest test,
                       const RayState<1, A>& r, HitList& hits) {
  constexpr int N = TriangleBlock::kSize;
  using F = Simd<float, N, A>;
  const auto ray = broadcast_ray<N>(r);
  HitLanes<F> h;
  unsigned lanes = (1u << count) - 1, front = 0;
  if (test == TriangleTest::watertight) {
    lanes &= bits(filter_watertight(ray, F(r.d_max[0]), filter_triangle(load_triangles<F>(leaf))));
    if (lanes == 0) return;
    typename F::M clockwise;
    lanes &= bits(decide_watertight(broadcast_shear<N>(r), load_triangles<F>(leaf, 0, r.z_axis_of(0)),
                                    ray.tmin, ray.tmax, h, clockwise));
    front = r.inv_dz[0] > 0 ? bits(clockwise) : ~bits(clockwise);
  } else {
    lanes &= bits(textbook_test(test, ray, load_triangles<F>(leaf), h));
    for (int k = 0; k < count; ++k) front |= (turn_of(leaf, k, r) < 0 ? 1u : 0u) << k;
  }
  if (lanes == 0) return;
  each_hit(lanes, h, [&](int k, float t, float u, float v) {
    const bool entered = (front >> k & 1) != (is_mirrored(accel, leaf.item(k)) ? 1u : 0u);
    hits.push({t, u, v, leaf.item(k), kNoId}, entered ? -1.0f : 1.0f);
  });
}

/// -1 if the ray enters the shape at root `j`, 1 if it leaves it; 0 for shapes without an inside.
template <class S, class A>
OKTETT_INLINE float turn_of(const typename S::Pool& pool, std::uint32_t k, int j, const RayState<1, A>& r) {
  if constexpr (kSolid<S> && S::kRoots == 1) {
    const Vec3d n = S::template broadcast<double>(pool, k).n, d{r.d[0][0], r.d[1][0], r.d[2][0]};
    return dot(n, d) < 0 ? -1.0f : 1.0f;
  }
  return !kSolid<S> ? 0.0f : j == 0 ? -1.0f : 1.0f;
}

/// Appends all hits of a ray with the closed-form shapes of a leaf.
template <class S, class A>
void collect_shape(const typename S::Pool& pool, const LeafEntry& leaf, const RayState<1, A>& r,
                   HitList& hits) {
  using D = Simd<double, 1, A>;
  const auto ray = to_double(load_rays(r));
  for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
    D t[S::kRoots];
    if (none(S::roots(ray, S::template broadcast<D>(pool, k), t))) continue;
    for (int j = 0; j < S::kRoots; ++j) {
      double td;
      t[j].store(&td);
      const float tf = static_cast<float>(td);
      if (r.tmin[0] < tf && tf <= r.tmax[0] && tf <= std::numeric_limits<float>::max())
        hits.push({tf, 0, 0, pool.item[k], kNoId}, turn_of<S>(pool, k, j, r));
    }
  }
}

template <class A>
void collect(const Accel& accel, const RayState<1, A>& r, HitList& hits);

/// Appends all hits of a ray with a leaf of the table.
template <class A>
void collect_leaf(const Accel& accel, const LeafEntry& leaf, const RayState<1, A>& r, HitList& hits) {
  if (leaf.kind == Kind::triangle) {
    collect_triangles(accel, accel.triangles(leaf.begin), leaf.count, leaf.test, r, hits);
  } else if (holds_instances(leaf.kind)) {
    each_instance(accel, leaf, [&](const auto& instance, const Accel& inner) {
      const auto outer = load_rays(r);
      Vec3<Simd<float, 1, A>> o, d;
      transform_rays(instance, outer, o, d);
      RayState<1, A> child;
      if (child.set(o, d, outer.tmin, outer.tmax, inner.bounds) == 0) return true;
      const std::size_t before = hits.size();
      collect(inner, child, hits);
      for (std::size_t j = before; j < hits.size(); ++j)
        hits[j].hit.instance = outer_path(instance, hits[j].hit.instance);
      return true;
    });
  } else if (is_exact(leaf.kind) || leaf.kind == Kind::csg) {
    const Ray ray{{r.o[0][0], r.o[1][0], r.o[2][0]}, r.tmin[0], {r.d[0][0], r.d[1][0], r.d[2][0]}, r.tmax[0]};
    if (leaf.kind == Kind::csg)
      for (std::uint32_t k = 0; k < leaf.count; ++k)
        collect_csg<A>(accel.combinations[leaf.begin + k], ray, hits);
    else
      for (std::uint32_t k = 0; k < leaf.count; ++k)
        exact_code<A>(leaf.kind).all(accel.exact_pool(leaf.kind), leaf.begin + k, ray, hits);
  } else {
    visit_pool(leaf.kind, accel.pools,
               [&](auto shape, const auto& pool) { collect_shape<decltype(shape)>(pool, leaf, r, hits); });
  }
}

/// Removes repeated hits of a triangle, which may stand in several leaves, from those from `first` on. Hits
/// inside instances are left alone: the instance has removed its own.
OKTETT_INLINE void drop_repeated(const Accel& accel, HitList& hits, std::size_t first) {
  std::size_t kept = first;
  for (std::size_t i = first; i < hits.size(); ++i) {
    bool seen = false;
    const Hit hit = hits[i].hit;
    if (hit.instance == kNoId && is_triangle(accel, hit.item))
      for (std::size_t k = first; k < kept; ++k)
        seen |= hits[k].hit.item == hit.item && hits[k].hit.instance == kNoId;
    if (!seen) hits[kept++] = hits[i];
  }
  hits.shrink(kept);
}

/// Appends all hits of one ray, unsorted.
template <class A>
void collect(const Accel& accel, const RayState<1, A>& r, HitList& hits) {
  const std::size_t first = hits.size();
  for (const LeafEntry& leaf : accel.unbounded) collect_leaf(accel, leaf, r, hits);
  alignas(64) float near[BvhNode::kWidth];
  visit_leaves(
      accel, 1,
      [&](const BvhNode& node, unsigned, auto&& push) {
        for (unsigned hit = node_single(node, r, near); hit != 0; hit &= hit - 1) push(__builtin_ctz(hit), 1);
      },
      [&](NodeRef leaf, unsigned) {
        if (leaf.is_triangles())
          collect_triangles(accel, accel.triangles(leaf.triangle_leaf()), leaf.triangle_count(),
                            TriangleTest::watertight, r, hits);
        else
          collect_leaf(accel, accel.leaves[leaf.table_index()], r, hits);
        return true;
      });
  if (accel.pieces) drop_repeated(accel, hits, first);
  if (accel.has_exact) merge_crossings(accel, hits, first);
}

/// The same for a ray that may be invalid.
template <class A>
void trace_all_hits(const Accel& accel, const Ray& ray, HitList& hits) {
  RayState<1, A> state;
  if (state.set(ray, accel.bounds) != 0) collect(accel, state, hits);
}

}  // namespace oktett
