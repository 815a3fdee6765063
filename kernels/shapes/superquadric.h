#pragma once
/// \file Superquadrics and ratioquadrics (slides; A. H. Barr: Superquadrics and Angle-Preserving
/// Transformations, 1981; C. Blanc, C. Schlick: Ratioquadrics, 1996).

#include "kernels/shapes/exact.h"
#include "kernels/shapes/superquadric_power.h"

namespace oktett {

struct SuperquadricElement {
  double inverse[3];         ///< 1 / a, 1 / b, 1 / c
  SuperExponent exponent[3]; ///< of x, y and z
  SuperExponent q, r;        ///< of the toroid's ring and tube
  double d, ee;              ///< of the toroid: d and e^2
  Vec3d lo, hi;              ///< the box
  SuperquadricShape::Form form;
  bool ratio, closed;
  bool convex;  ///< an ellipsoid whose function is convex along every line
};

/// The function of a superquadric along a line.
template <SuperquadricShape::Form kForm, bool kRatio, class D>
struct SuperquadricField {
  const SuperquadricElement& e;
  const CenteredLine<D>& line;

  OKTETT_INLINE Dual<Interval<D>> term(const D& p, const D& u, int axis, const Interval<D>& s) const {
    const D inverse(e.inverse[axis]);
    const Interval<D> x = (Interval<D>(p) + s * u) * inverse;
    const Interval<D> d = select(u == D(0.0), Interval<D>(u), Interval<D>(u) * inverse);
    return interval::super_power<kRatio>(Dual<Interval<D>>{x, d}, e.exponent[axis]);
  }
  OKTETT_INLINE Dual<Interval<D>> over(const Interval<D>& s) const {
    using Form = SuperquadricShape::Form;
    const Dual<Interval<D>> x = term(line.p.x, line.u.x, 0, s), y = term(line.p.y, line.u.y, 1, s);
    const Dual<Interval<D>> z = term(line.p.z, line.u.z, 2, s);
    const auto minus = [](const Dual<Interval<D>>& a, double b) {
      return Dual<Interval<D>>{a.v - Interval<D>(D(b)), a.d};
    };
    if constexpr (kForm == Form::ellipsoid) return minus((x + y) + z, 1);
    if constexpr (kForm == Form::hyperboloid) return minus((x + y) - z, 1);
    const Dual<Interval<D>> ring = minus(interval::super_power<kRatio>(x + y, e.q), e.d);
    return minus(interval::super_power<kRatio>(ring, e.r) + z, e.ee);
  }
  OKTETT_INLINE Interval<D> at(const D& s) const { return over(Interval<D>(s)).v; }

  /// Of the convex ellipsoid.
  OKTETT_INLINE interval::Sample<D> sample(const D& s) const {
    interval::Sample<D> f{D(-1.0), D(0.0), D(0x1p-50), D(0.0)};
    const D *p[3] = {&line.p.x, &line.p.y, &line.p.z}, *u[3] = {&line.u.x, &line.u.y, &line.u.z};
    for (int k = 0; k < 3; ++k) {
      const D inverse(e.inverse[k]), x = (*p[k] + *u[k] * s) * inverse, rate = *u[k] * inverse;
      D value, slope, relative;
      sample_power<kRatio>(abs(x), e.exponent[k], value, slope, relative);
      f.value = f.value + value;
      const D along = slope * rate;
      f.slope = f.slope + select(x < D(0.0), -along, along);
      // x is off by its rounding, which counts by the slope there and twice that, near 0 a little beyond.
      const D off = (abs(*p[k]) + abs(*u[k] * s)) * inverse * D(0x1p-50);
      f.error = f.error + value * (relative + D(0x1p-50)) + off * (slope * D(2.0)) + off * off;
      f.slope_error = f.slope_error + abs(along) * D(0x1p-20) + abs(rate) * D(0x1p-30);
    }
    return f;
  }
};

/// Parts: 0 the surface, 1 to 6 the faces of the box.
struct Superquadric {
  using Data = SuperquadricShape;
  using Pool = ExactPool<SuperquadricElement>;
  using Form = SuperquadricShape::Form;
  static constexpr int kMaxCrossings = 8;

  static void add(Pool& pool, const ExactShape& shape, const Affine& to_world, std::uint32_t item);
  /// How far |x|, |y| and |z| reach; infinite if there is no end, NaN if the parameters are out of range.
  static Vec3d reach(const SuperquadricShape& shape);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const SuperquadricElement& e = pool.elements[cell.element];
    const auto form = [&](auto ratio) {
      constexpr bool kRatio = decltype(ratio)::value;
      if (e.form == Form::ellipsoid) return solve<K, Form::ellipsoid, kRatio>(e, line, range, active, out);
      if (e.form == Form::toroid) return solve<K, Form::toroid, kRatio>(e, line, range, active, out);
      solve<K, Form::hyperboloid, kRatio>(e, line, range, active, out);
    };
    if (e.ratio)
      form(std::true_type{});
    else
      form(std::false_type{});
  }

  static double value(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static Vec3d gradient(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u around z; v from bottom to top of an ellipsoid, around the tube of a toroid, the height z of a
  /// hyperboloid. On a face of the box the position on it.
  static void uv(const Pool& pool, std::size_t i, int part, const Vec3d& p, Surface& s);

 private:
  template <int K, Form kForm, bool kRatio, class D>
  static void solve(const SuperquadricElement& e, const Line<D>& line, const LineRange<D>& range,
                    const typename D::M& active, Crossings<K, D>& out) {
    const CenteredLine<D> centered(line);
    const SuperquadricField<kForm, kRatio, D> field{e, centered};
    const D a = centered.to_s(range.a), b = centered.to_s(range.b), no_root(roots::kNoRoot);
    Crossings<K, D> found;
    D first_sign(0.0);
    bool done = false;
    if constexpr (kForm == Form::ellipsoid) {
      if (e.convex) interval::convex_crossings<K>(field, a, b, active, found), done = true;
    }
    if (!done)
      first_sign = interval::march<K>(field, a, b, b, active, interval::Jumps::list, found);
    for (int k = 0; k < K; ++k)
      found.t[k] = select(found.t[k] < no_root, centered.to_t(found.t[k]), no_root);
    found.up_to = select(found.up_to < no_root, centered.to_t(found.up_to), no_root);
    if (kForm == Form::hyperboloid && e.closed)
      close_by_cell(found, first_sign < D(0.0), range, active, out);
    else
      out = found;
  }
};

}  // namespace oktett
