#include "kernels/exact/superquadric.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "kernels/exact/surface_uv.h"

namespace oktett {

namespace {

/// The x >= 0 whose power is y; infinite if there is none.
double root(double y, double p, bool ratio) {
  if (!ratio) return portable::pow(y, 1 / p);
  const double below = 1 - (1 - p) * y;
  if (std::isinf(y)) return p > 1 ? p / (p - 1) : kInfinity;
  return below > 0 ? p * y / below : kInfinity;
}

/// `inverse` is what the line is scaled by: it lies within 4 of the origin (see SuperquadricField::sample).
SuperRounding rounding(double p, bool ratio, double inverse) {
  // (1 + r)^(p - 1) and (1 - r)^(p - 1) differ from 1 by less than 2 p r for r < 1 / (2 p); the slope of a
  // pseudo-power, p / (p + (1 - p) x)^2, by less than 8 p r.
  const double bend = (ratio ? 8 : 2) * p, vague = 1 / bend, off = 4 * inverse * 0x1p-50;
  const Simd<double, 1, ScalarIsa> x(off * (bend + 1));
  Simd<double, 1, ScalarIsa> value, slope, relative;
  if (ratio)
    sample_power<true>(x, SuperExponent(p), value, slope, relative);
  else
    sample_power<false>(x, SuperExponent(p), value, slope, relative);
  return {vague, bend, 2.1 * slope.part[0].v};
}

/// Whether the function is convex along every line. Powers of at least 1 are, and so are their sums and
/// convex powers of those; (|x|^m + |y|^m)^q is the power mq of a norm.
bool is_convex(const SuperquadricShape& s) {
  if (s.form == SuperquadricShape::Form::ellipsoid) return s.p >= 1 && s.q >= 1 && s.r >= 1;
  if (s.form != SuperquadricShape::Form::toroid || s.ratio || s.d != 0 || s.r != 1) return false;
  const bool by_norm = s.m == s.n && s.m * s.q >= 1 + 0x1p-40;
  return s.m >= 1 && s.n >= 1 && s.p >= 1 && (s.q >= 1 || by_norm);
}

/// A little more than computed, for the box that holds everything.
constexpr double kGrow = 1 + 0x1p-36;

}  // namespace

Vec3d Superquadric::reach(const SuperquadricShape& s) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const bool toroid = s.form == SuperquadricShape::Form::toroid;
  for (const double x : {s.radii.x, s.radii.y, s.radii.z, s.p, s.q, s.r, toroid ? s.m : 1, toroid ? s.n : 1,
                         toroid ? s.e : 1, toroid ? s.d + s.e : 1})
    if (!(x > 0 && std::isfinite(x))) return {nan, nan, nan};
  if (s.form == SuperquadricShape::Form::ellipsoid) return s.radii * kGrow;
  if (s.form == SuperquadricShape::Form::hyperboloid) {
    Vec3d v = {kInfinity, kInfinity, kInfinity};
    const double p[3] = {s.p, s.q, s.r};
    for (int k = 0; k < 3; ++k)
      if (s.ratio && p[k] > 1) v[k] = s.radii[k] * (p[k] / (p[k] - 1));
    return v;
  }
  if (s.d < 0) return {nan, nan, nan};
  // |d - w|^r <= e^2 and |z/c|^p <= e^2 bound everything.
  const double ring = s.d + root(s.e * s.e, s.r, s.ratio), sum = root(ring, s.q, s.ratio);
  return Vec3d{s.radii.x * root(sum, s.m, s.ratio), s.radii.y * root(sum, s.n, s.ratio),
               s.radii.z * root(s.e * s.e, s.p, s.ratio)} *
         kGrow;
}

void Superquadric::add(Pool& pool, const SuperquadricShape& s, const ExactPlace& place) {
  const Vec3d far = reach(s);
  Vec3d lo = -far, hi = far;
  if (s.form == SuperquadricShape::Form::hyperboloid)
    for (int k = 0; k < 3; ++k) lo[k] = std::max(lo[k], s.lo[k]), hi[k] = std::min(hi[k], s.hi[k]);
  for (int k = 0; k < 3; ++k)
    if (!(lo[k] < hi[k] && std::isfinite(hi[k] - lo[k]))) return;
  Vec3d extent;
  for (int k = 0; k < 3; ++k) extent[k] = std::max(std::abs(lo[k]), std::abs(hi[k]));
  const double size = max_component(extent);
  SuperquadricElement e{};
  const bool toroid = s.form == SuperquadricShape::Form::toroid;
  const double p[3] = {toroid ? s.m : s.p, toroid ? s.n : s.q, toroid ? s.p : s.r};
  for (int k = 0; k < 3; ++k) {
    e.inverse[k] = size / s.radii[k], e.exponent[k] = SuperExponent(p[k]);
    if (!std::isfinite(e.inverse[k])) return;
  }
  e.q = SuperExponent(s.q), e.r = SuperExponent(s.r), e.d = s.d, e.ee = s.e * s.e;
  e.form = s.form, e.ratio = s.ratio, e.closed = s.form == SuperquadricShape::Form::hyperboloid && !s.open;
  e.convex = is_convex(s);
  for (int k = 0; k < 3 && e.convex; ++k) e.rounding[k] = rounding(p[k], e.ratio, e.inverse[k]);
  e.lo = lo * (1 / size), e.hi = hi * (1 / size);
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
  add_cell(pool, e.lo, e.hi);
}

SurfaceUv Superquadric::uv(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const SuperquadricElement& e = pool.elements[i];
  if (part > 0) return face_uv(part, e.lo, e.hi, p);
  const auto scaled = [&](int k) { return component(p, k) * e.inverse[k]; };
  const SpaceFunction x = scaled(0), y = scaled(1), z = scaled(2), rho = radius_of(x, y);
  SpaceFunction v = (component(p, 2) - e.lo.z) / (e.hi.z - e.lo.z);
  if (e.form == SuperquadricShape::Form::ellipsoid) v = angle_of(z, rho) / std::numbers::pi + 0.5;
  if (e.form == SuperquadricShape::Form::toroid) v = turn_of(z, rho - e.d);
  return {turn_of(y, x), v};
}

}  // namespace oktett
