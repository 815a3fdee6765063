#pragma once
/// \file GGX facets that are wider along one direction of the surface (Burley 2012; Heitz 2014), and their
/// directional albedos. Formulas of facets that are as wide everywhere are in render/bsdf/ggx_albedo.h; these
/// here give the same bits for them.

#include <array>
#include <span>

#include "render/bsdf/ggx_albedo.h"

namespace oktett {

/// Widths along x and y.
struct FacetWidths {
  FacetWidths(double both = 0) : x(both), y(both) {}
  FacetWidths(double by_x, double by_y) : x(by_x), y(by_y) {}
  double x, y;
  bool stretched() const { return x != y; }
};

/// A normal relative to the widths.
template <class D>
OKTETT_INLINE Vec3<D> by_widths(const Vec3<D>& m, const D& x, const D& y) {
  return {m.x / x, m.y / y, m.z};
}
/// A direction seen by the stretched surface whose facets have the width 1.
template <class D>
OKTETT_INLINE Vec3<D> times_widths(const Vec3<D>& w, const D& x, const D& y) {
  return {w.x * x, w.y * y, w.z};
}

template <class D>
OKTETT_INLINE D ggx_density(const Vec3<D>& m, const FacetWidths& a) {
  if (!a.stretched()) return ggx_density(m, D(a.x));
  const Vec3<D> relative = by_widths(m, D(a.x), D(a.y));
  const D t = dot_lanes(relative, relative);
  return D(1 / (std::numbers::pi * a.x * a.y)) / (t * t);
}

template <class D>
OKTETT_INLINE D ggx_lambda(const Vec3<D>& w, const FacetWidths& a) {
  if (!a.stretched()) return ggx_lambda(w, D(a.x));
  return ggx_lambda(times_widths(w, D(a.x), D(a.y)), D(1.0));
}

// Widths in lanes, for lanes that sample different lobes.

template <class D>
OKTETT_INLINE D reflecting_bound(const Vec3<D>& w, const D& x, const D& y) {
  return reflecting_bound(w, min(x, y));
}

template <class D>
OKTETT_INLINE D ggx_reflected_scale(const Vec3<D>& w, const FacetWidths& a) {
  const D x(a.x), y(a.y);
  if (!a.stretched()) return ggx_reflected_scale(w, x);
  const D size = length_lanes(times_widths(w, x, y));
  return D(1.0) / (D(2.0) * (reflecting_bound(w, x, y) * w.z + size));
}

template <class D>
OKTETT_INLINE Vec3<D> ggx_normal(const Vec3<D>& w, const D& width_x, const D& width_y, const D& bound,
                                 const D& x, const D& y) {
  // Of the surface whose facets have the width 1, which sees the viewer there.
  const Vec3<D> m = ggx_normal(unit_lanes(times_widths(w, width_x, width_y)), D(1.0), bound, x, y);
  return unit_lanes(times_widths(m, width_x, width_y));
}

// ---- Albedos

/// Points of the unit square with weights that add to 1, and the sine and cosine of the turn x.
struct FacetPoint {
  double y, sine, cosine, weight;
};
/// A lattice of 144 points (as in ggx_albedo.cpp) for integrals over visible normals.
std::span<const FacetPoint> facet_points();

/// Bounds of the errors of albedos by facet_points(): where all light is sent on, or the part of a
/// dielectric.
inline constexpr double kStretchedError = 0.007, kStretchedDielectricError = 0.003;

/// The mean of value(m, cosine of w with m) over the normals m of the facets that are visible from `w`,
/// w.z > 0.
template <class D, class Value>
OKTETT_NOINLINE D mean_over_facets(const Vec3<D>& w, const FacetWidths& a, const Value& value) {
  const D x(a.x), y(a.y), zero(0.0), one(1.0), two(2.0);
  const Vec3<D> seen = unit_lanes(times_widths(w, x, y));
  D sum = zero;
  for (const FacetPoint& p : facet_points()) {
    const D below = D(p.y) * (one + seen.z), size = sqrt(max(zero, below * (two - below)));
    const Vec3<D> half = Vec3<D>{size * D(p.cosine), size * D(p.sine), one - below} + seen;
    const Vec3<D> m = unit_lanes(times_widths(half, x, y));
    sum = sum + D(p.weight) * value(m, min(one, dot_lanes(w, m)));
  }
  return sum;
}

/// What facets let pass of the light that they send from a viewer of this Lambda to `out` above the surface;
/// 0 for directions below it.
template <class D>
OKTETT_INLINE D unshadowed(const D& lambda, const Vec3<D>& out, const FacetWidths& a) {
  const D all = D(1.0) + lambda;
  return select(out.z > D(0.0), all / (all + ggx_lambda(out, a)), D(0.0));
}

/// The albedo of facets that reflect the part reflectance(cosine) of light.
template <class D, class Reflectance>
OKTETT_INLINE D stretched_albedo(const Vec3<D>& w, const FacetWidths& a, const Reflectance& reflectance) {
  const D lambda = ggx_lambda(w, a);
  return mean_over_facets(w, a, [&](const Vec3<D>& m, const D& c) {
    return reflectance(c) * unshadowed(lambda, m * (D(2.0) * c) - w, a);
  });
}

/// The same of facets of glass, with the light that they transmit. `eta`: the index of refraction behind,
/// relative to that before.
template <class D>
OKTETT_INLINE D stretched_glass_albedo(const Vec3<D>& w, const FacetWidths& a, double eta) {
  const D lambda = ggx_lambda(w, a), one(1.0), e(eta);
  return mean_over_facets(w, a, [&](const Vec3<D>& m, const D& c) {
    const D f = min(one, fresnel_lanes(c, e));
    const D behind = sqrt(max(D(0.0), one - (one - c * c) / (e * e)));
    const Vec3<D> down = m * (c / e - behind) - w * (one / e);
    return f * unshadowed(lambda, m * (D(2.0) * c) - w, a) +
           (one - f) * unshadowed(lambda, Vec3<D>{down.x, down.y, -down.z}, a);
  });
}

}  // namespace oktett
