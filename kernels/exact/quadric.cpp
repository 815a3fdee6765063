#include "kernels/exact/quadric.h"

#include <algorithm>
#include <cmath>

#include "core/double_double.h"
#include "core/math.h"
#include "kernels/exact/surface_uv.h"

namespace oktett {

namespace {

/// Boxes around what they bound are larger by this, so that the function is surely not negative outside.
constexpr double kMargin = 0x1p-20;

/// x.Qx + 2 h.x + j; of Q xx, yy, zz, xy, xz, yz.
template <class T>
struct Form {
  T q[6], h[3], j;
};

/// Which of q is at row i, column k of Q.
constexpr int at(int i, int k) { return i == k ? i : i + k + 2; }

Form<double> form_of(const QuadricShape& s) {
  const auto& c = s.coefficients;
  return {{c[0], c[1], c[2], c[3] / 2, c[4] / 2, c[5] / 2}, {c[6] / 2, c[7] / 2, c[8] / 2}, c[9]};
}

/// The form of x' for x = center + scale x'; in double-double, for what is far away cancels.
Form<DoubleDouble> moved(const Form<double>& f, const Vec3d& center, const Vec3d& scale) {
  Form<DoubleDouble> out;
  DoubleDouble j = f.j;
  for (int i = 0; i < 3; ++i) {
    DoubleDouble qc = 0;
    for (int k = 0; k < 3; ++k) qc = qc + two_product(f.q[at(i, k)], center[k]);
    j = j + (qc + DoubleDouble(f.h[i]) + DoubleDouble(f.h[i])) * DoubleDouble(center[i]);
    out.h[i] = (qc + DoubleDouble(f.h[i])) * DoubleDouble(scale[i]);
    for (int k = i; k < 3; ++k)
      out.q[at(i, k)] = two_product(f.q[at(i, k)], scale[i]) * DoubleDouble(scale[k]);
  }
  out.j = j;
  return out;
}

/// Where the surface and the solid inside of it can be.
struct Region {
  Vec3d lo, hi;
  bool empty() const { return !(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z); }
  void cut(int axis, double from, double to) {
    const double margin = kMargin * (to - from);
    if (from - margin > lo[axis]) lo[axis] = from - margin;
    if (to + margin < hi[axis]) hi[axis] = to + margin;
  }
};

/// The box of the ellipsoid, if the form is one with a positive definite Q: center +- sqrt(k (Q^-1)_ii),
/// where k is minus the least value. An ellipsoid without points makes the region empty.
void cut_to_ellipsoid(const Form<double>& f, Region& region) {
  const double *q = f.q, xx = q[0], yy = q[1], zz = q[2], xy = q[3], xz = q[4], yz = q[5];
  const double cofactor[6] = {yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy,
                              xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz};
  const double det = xx * cofactor[0] + xy * cofactor[3] + xz * cofactor[4];
  // What is nearly singular may be so by rounding only.
  if (!(xx > 0 && yy > 0 && zz > 0 && cofactor[2] > 1e-10 * xx * yy && det > 1e-10 * xx * yy * zz)) return;
  Vec3d center;
  for (int i = 0; i < 3; ++i) {
    center[i] = 0;
    for (int k = 0; k < 3; ++k) center[i] -= cofactor[at(i, k)] * f.h[k] / det;
  }
  const double depth = -moved(f, center, {1, 1, 1}).j.hi;
  for (int i = 0; i < 3; ++i) {
    const double reach = std::sqrt(std::max(depth, 0.0) * cofactor[i] / det);
    if (reach > 0)
      region.cut(i, center[i] - reach - 0x1p-50 * std::abs(center[i]),
                 center[i] + reach + 0x1p-50 * std::abs(center[i]));
    else
      region.hi[i] = region.lo[i];
  }
}

/// The least value of q x^2 + 2 h x in [lo, hi].
double least(double q, double h, double lo, double hi) {
  const auto value = [&](double x) {
    if (std::isfinite(x)) return (q * x + 2 * h) * x;
    if (q != 0) return q > 0 ? kInfinity : -kInfinity;
    return h == 0 ? 0 : (h > 0) == (x > 0) ? kInfinity : -kInfinity;
  };
  double v = std::min(value(lo), value(hi));
  if (q > 0 && lo < -h / q && -h / q < hi) v = std::min(v, -(h * h) / q);
  return v;
}

/// Without mixed terms, each coordinate is bounded by what the others can make of the function at least.
void cut_by_axes(const Form<double>& f, Region& region) {
  if (f.q[3] != 0 || f.q[4] != 0 || f.q[5] != 0) return;
  for (int i = 0; i < 3; ++i) {
    const double q = f.q[i], h = f.h[i];
    double rest = f.j;
    for (int k = 0; k < 3; ++k)
      if (k != i) rest += least(f.q[k], f.h[k], region.lo[k], region.hi[k]);
    if (!std::isfinite(rest)) continue;
    if (q > 0) {
      const double discriminant = h * h - q * rest;
      if (discriminant < -1e-9 * (h * h + std::abs(q * rest))) return void(region.hi = region.lo);
      const double reach = std::sqrt(std::max(discriminant, 1e-15 * (h * h + std::abs(q * rest)))) / q;
      region.cut(i, -h / q - reach, -h / q + reach);
    } else if (q == 0 && h != 0) {
      const double end = -rest / (2 * h), width = region.hi[i] - region.lo[i];
      const double margin = kMargin * (std::isfinite(width) ? std::max(width, std::abs(end)) : std::abs(end));
      // No face without room for rounding.
      if (h > 0 && margin > 0) region.hi[i] = std::min(region.hi[i], end + margin);
      if (h < 0 && margin > 0) region.lo[i] = std::max(region.lo[i], end - margin);
    }
  }
}

/// About the size of what the form describes near the origin.
double natural_size(const Form<double>& f) {
  double q = 0, h = 0;
  for (const double x : f.q) q = std::max(q, std::abs(x));
  for (const double x : f.h) h = std::max(h, std::abs(x));
  const double size = q > 0 ? std::max(std::sqrt(std::abs(f.j) / q), h / q) : std::abs(f.j) / h;
  return size > 0 && std::isfinite(size) ? size : 1;
}

Form<double> negative(Form<double> f) {
  for (double& x : f.q) x = -x;
  for (double& x : f.h) x = -x;
  f.j = -f.j;
  return f;
}

}  // namespace

void Quadric::add(Pool& pool, const QuadricShape& s, const ExactPlace& place) {
  for (const double c : s.coefficients)
    if (!std::isfinite(c)) return;
  if (std::all_of(s.coefficients.begin(), s.coefficients.end() - 1, [](double c) { return c == 0; })) return;
  const Form<double> f = form_of(s);
  const Vec3d infinite{kInfinity, kInfinity, kInfinity};
  Region region{s.clipped ? s.lo : -infinite, s.clipped ? s.hi : infinite};
  if (region.empty()) return;
  const bool closed = s.clipped && !s.open;
  cut_to_ellipsoid(f, region);
  cut_by_axes(f, region);
  // What is outside of an ellipsoid has its surface there, too; as a solid it has no bounds.
  if (s.clipped && s.open) cut_to_ellipsoid(negative(f), region);
  if (region.empty()) return;
  Vec3d center, scale;
  double size = 0;
  for (int k = 0; k < 3; ++k)
    if (std::isfinite(region.hi[k] - region.lo[k])) size = std::max(size, (region.hi[k] - region.lo[k]) / 2);
  if (size == 0) size = natural_size(f);
  for (int k = 0; k < 3; ++k) {
    const bool finite = std::isfinite(region.hi[k] - region.lo[k]);
    scale[k] = unit_for(finite ? (region.hi[k] - region.lo[k]) / 2 : size);
    center[k] = finite ? origin_for((region.lo[k] + region.hi[k]) / 2, scale[k]) : 0;
  }
  const Form<DoubleDouble> own = moved(f, center, scale);
  double greatest = std::abs(own.j.hi);
  for (const DoubleDouble& x : own.q) greatest = std::max(greatest, std::abs(x.hi));
  for (const DoubleDouble& x : own.h) greatest = std::max(greatest, std::abs(x.hi));
  if (!(greatest > 0 && std::isfinite(greatest))) return;
  const int exponent = -std::ilogb(greatest);
  QuadricElement e{};
  for (int k = 0; k < 6; ++k) {
    e.q[k] = std::ldexp(own.q[k].hi, exponent);
    e.q_size = std::max(e.q_size, std::abs(e.q[k]));
  }
  for (int k = 0; k < 3; ++k) {
    e.h[k] = std::ldexp(own.h[k].hi, exponent);
    e.h_size = std::max(e.h_size, std::abs(e.h[k]));
    e.lo[k] = (region.lo[k] - center[k]) / scale[k];
    e.hi[k] = (region.hi[k] - center[k]) / scale[k];
  }
  e.j = std::ldexp(own.j.hi, exponent);
  e.closed = closed, e.clipped = s.clipped;
  add_element(pool, e, place.to_world * Affine::translation(center) * Affine::scaling(scale), place);
  add_cell(pool, e.lo, e.hi);
}

void Quadric::equation(const QuadricElement& e, const double (&in)[6], double (&out)[4]) {
  DoubleDouble a = 0, b = 0, c = e.j;
  for (int i = 0; i < 3; ++i) {
    const DoubleDouble p = in[i], d = in[3 + i], h = e.h[i];
    DoubleDouble qp = 0, qd = 0;
    for (int k = 0; k < 3; ++k) {
      qp = qp + two_product(e.q[at(i, k)], in[k]);
      qd = qd + two_product(e.q[at(i, k)], in[3 + k]);
    }
    a = a + qd * d;
    b = b + (qp + h) * d;
    c = c + (qp + h + h) * p;
  }
  out[0] = a.hi, out[1] = b.hi, out[2] = c.hi;
  out[3] = (b * b - a * c).hi;
}

bool Quadric::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const QuadricElement& e = pool.elements[i];
  for (int face = 1; e.clipped && face <= 6; ++face)
    if (!(face_value(e.lo, e.hi, face, p) < 0)) return false;
  return slope_at<Quadric>(pool, i, 0, p).value < 0;
}

SurfaceUv Quadric::uv(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const QuadricElement& e = pool.elements[i];
  if (part > 0) return face_uv(part, e.lo, e.hi, p);
  const double height = e.hi.z - e.lo.z;
  const SpaceFunction z = component(p, 2);
  return {turn_around_z(p), std::isfinite(height) ? (z - e.lo.z) / height : z};
}

}  // namespace oktett
