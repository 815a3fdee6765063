#pragma once
/// \file ExactShapeCode for one instruction set. Included by accel/isa/exact_*.cpp.

#include "accel/isa/exact_shape.h"
#include "accel/isa/shape_interactions.h"

namespace oktett {

/// The rays in the own space of the cell's element.
template <class D, class F>
OKTETT_INLINE Line<D> own_line(const Affine& to_own, const RayLanes<F>& rays) {
  return {map_point(to_own, to_double(rays.o)), map_vector(to_own, to_double(rays.d))};
}

/// What a ray may hit begins here: a little beyond tmin, so that it does not round to tmin.
template <class D>
OKTETT_INLINE D range_begin(const D& tmin) {
  return tmin * D(1 + 0x1p-24) + D(0x1p-151);
}

template <class D>
OKTETT_INLINE void cut_range(LineRange<D>& range, const D& from) {
  range.enter_face = select(from > range.a, D(0.0), range.enter_face);
  range.a = max(from, range.a);
}

template <class D>
OKTETT_INLINE void cut_end(LineRange<D>& range, const D& to) {
  range.exit_face = select(to < range.b, D(0.0), range.exit_face);
  range.b = min(to, range.b);
}

/// Where to look for crossings with the cell before the ray's own range counts.
template <class S, class D>
OKTETT_INLINE typename D::M cell_range(const Line<D>& line, const ExactCell& cell, LineRange<D>& range) {
  if constexpr (requires { S::kWholeLines; }) {
    const D inf(std::numeric_limits<double>::infinity());
    range = {-inf, inf, D(0.0), D(0.0)};
    return D::M::all_true();
  } else {
    return clip_line(line, cell.lo, cell.hi, range);
  }
}

/// First crossings with cell `index`, of the rays in `lanes`; the lanes that have one.
template <class S, class F>
OKTETT_INLINE unsigned first_crossings(const typename S::Pool& pool, std::uint32_t index,
                                       const RayLanes<F>& rays, unsigned lanes, HitLanes<F>& hits) {
  using D = Simd<double, F::kWidth, typename F::Isa>;
  const ExactCell& cell = pool.cells[index];
  const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
  LineRange<D> range;
  auto active = D::M::from_bits(lanes) & cell_range<S>(line, cell, range);
  cut_range(range, range_begin(to_double(rays.tmin)));
  // Nothing farther than tmax is of use, yet it must not shorten the range: that would change the roots.
  active = active & (range.a <= range.b) & (range.a * D(1 - 0x1p-22) <= to_double(rays.tmax));
  if constexpr (requires { S::kStopsAtLimit; }) cut_end(range, to_double(rays.tmax) * D(1 + 0x1p-22));
  hits.t = hits.u = hits.v = F(0.0f);
  const F far_limit = min(rays.tmax, F(std::numeric_limits<float>::max()));
  unsigned met = 0;
  while (any(active)) {
    Crossings<1, D> c;
    S::template crossings<1>(pool, cell, line, range, active, c);
    active = active & (c.t[0] < D(roots::kNoRoot));
    const F t = to_float(c.t[0]);
    const auto found = mask_cast<float>(active);
    const auto valid = found & (rays.tmin < t) & (t <= far_limit);
    hits.t = select(valid, t, hits.t);
    hits.u = select(valid, to_float(c.part[0]), hits.u);
    hits.v = select(valid, to_float(c.turn[0]), hits.v);
    met |= bits(valid);
    // A root so near to the beginning that it rounds to tmin is not the first that counts.
    active = mask_cast<double>(found & (t <= rays.tmin)) & (range.a < range.b);
    cut_range(range, max(range.a, c.t[0]) * D(1 + 0x1p-24) + D(0x1p-151));
    active = active & (range.a <= range.b);
  }
  return met;
}

template <class S, class A>
unsigned ExactShapeCode<S, A>::first(const Pool& pool, std::uint32_t index, const RayLanes<F>& rays,
                                     unsigned lanes, HitLanes<F>& hits) {
  return first_crossings<S>(pool, index, rays, lanes, hits);
}

template <class S, class A>
void ExactShapeCode<S, A>::all(const Pool& pool, std::uint32_t index, const Ray& ray,
                               HitList& hits) requires std::is_same_v<A, ScalarIsa> {
  using One = Simd<float, 1, A>;
  using D = Simd<double, 1, A>;
  constexpr int K = S::kMaxCrossings;
  const ExactCell& cell = pool.cells[index];
  const RayLanes<One> rays{broadcast<One>(ray.origin), broadcast<One>(ray.direction), One(ray.tmin),
                           One(ray.tmax)};
  const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
  LineRange<D> range;
  auto active = cell_range<S>(line, cell, range);
  cut_range(range, range_begin(to_double(rays.tmin)));
  const std::uint32_t item = pool.frames[cell.element].item;
  for (active = active & (range.a <= range.b); any(active);) {
    Crossings<K, D> c;
    S::template crossings<K>(pool, cell, line, range, active, c);
    for (int k = 0; k < K; ++k) {
      const float t = static_cast<float>(c.t[k].part[0].v);
      if (ray.tmin < t && t <= ray.tmax && t <= std::numeric_limits<float>::max())
        hits.push({t, static_cast<float>(c.part[k].part[0].v), static_cast<float>(c.turn[k].part[0].v), item,
                   kNoId},
                  static_cast<float>(c.turn[k].part[0].v));
    }
    if (!(c.up_to.part[0].v < range.b.part[0].v)) return;
    cut_range(range, c.up_to);
  }
}

template <class S, class A>
void ExactShapeCode<S, A>::rows(const Pool& pool, std::uint32_t index, const RayLanes<F>& rays,
                                unsigned lanes, CrossingLanes<F::kWidth>& out) {
  constexpr int K = S::kMaxCrossings;
  if constexpr (K <= CrossingLanes<F::kWidth>::kMostPerSolid) {
    using D = Simd<double, F::kWidth, A>;
    const ExactCell& cell = pool.cells[index];
    const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
    LineRange<D> range;
    auto active = D::M::from_bits(lanes) & cell_range<S>(line, cell, range);
    cut_range(range, range_begin(to_double(rays.tmin)));
    active = active & (range.a <= range.b);
    if (none(active)) return;
    Crossings<K, D> c;
    S::template crossings<K>(pool, cell, line, range, active, c);
    const auto asked = mask_cast<float>(active);
    for (int k = 0; k < K; ++k) {
      const F t = to_float(c.t[k]);
      const auto valid = asked & (rays.tmin < t) & (t <= F(std::numeric_limits<float>::max()));
      push_row(out, valid, t, to_float(c.turn[k]), to_float(c.part[k]), pool.frames[cell.element].item, true);
    }
  }
}

/// settle and exact_surface of kernels/exact_surface.h.
template <class S, class D>
void slope_surfaces(const typename S::Pool& pool, ShapeHits& hits) {
  using F = Simd<float, D::kWidth, typename D::Isa>;
  const std::size_t element = hits.element[0];
  const ExactFrame& frame = pool.frames[element];
  const Vec3d diagonal = frame.to_world.vector({1, 1, 1});
  const D extent(length(diagonal));
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, i);
    const D part = to_double(F::load(hits.part + i));
    const Vec3<D> start = map_point(frame.to_own, hit.point());
    const D reach = D(0x1p-22) * length_lanes(map_vector(frame.to_own, hit.d)) * hit.t + D(0x1p-40);
    Vec3<D> p = start, g;
    D value;
    auto near = D::M::all_true();
    for (int k = 0; k < 3; ++k) {
      S::slope(pool, element, part, p, value, g);
      const D step = value / dot_lanes(g, g);
      p = {p.x - g.x * step, p.y - g.y * step, p.z - g.z * step};
      near = near & (length_lanes(sub_lanes(p, start)) <= reach);
      p = select_lanes(near, p, start);
    }
    S::slope(pool, element, part, p, value, g);
    Vec3<D> n = map_normal(frame.to_own, g);
    D l = length_lanes(n);
    const auto known = (D(0.0) < l) & (l <= D(1.7976931348623157e308));
    n = select_lanes(known, n, Vec3<D>{-hit.d.x, -hit.d.y, -hit.d.z});
    l = select(known, l, length_lanes(hit.d));
    const Vec3<D> point = map_point(frame.to_world, p);
    const D size = length_lanes(point) + extent;
    store_surface(hit, point, D(0x1p-44) * size, Vec3<D>{n.x / l, n.y / l, n.z / l}, hits, i);
  }
}

template <class S, class A>
bool ExactShapeCode<S, A>::surfaces(const Pool& pool, ShapeHits& hits) {
  using D = SurfaceLanes<A>;
  D value;
  Vec3<D> gradient;
  constexpr bool has_slope = requires { S::slope(pool, 0, D(), Vec3<D>(), value, gradient); };
  if constexpr (has_slope) slope_surfaces<S, D>(pool, hits);
  return has_slope;
}

}  // namespace oktett
