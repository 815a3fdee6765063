#pragma once
/// \file Superquadrics and ratioquadrics (slides; A. H. Barr: Superquadrics and Angle-Preserving
/// Transformations, 1981; C. Blanc, C. Schlick: Ratioquadrics, 1996).

#include "kernels/exact/exact.h"
#include "kernels/exact/superquadric_data.h"
#include "kernels/exact/superquadric_power.h"

namespace oktett {

struct SuperquadricElement {
  double inverse[3];          ///< 1 / a, 1 / b, 1 / c
  SuperExponent exponent[3];  ///< of x, y and z
  SuperRounding rounding[3];  ///< of x, y and z of a convex one
  SuperExponent q, r;         ///< of the toroid's ring and tube
  double d, ee;               ///< of the toroid: d and e^2
  Vec3d lo, hi;               ///< the box
  SuperquadricShape::Form form;
  bool ratio, closed;
  bool convex;  ///< an ellipsoid whose function is convex along every line
};

/// The function of a superquadric along a line.
template <class D>
struct SuperquadricField {
  using Form = SuperquadricShape::Form;
  const SuperquadricElement& e;
  const CenteredLine<D>& line;

  OKTETT_NOINLINE Dual<Interval<D>> over(const Interval<D>& s) const {
    const Dual<Interval<D>> x = term(line.p.x, line.u.x, 0, s), y = term(line.p.y, line.u.y, 1, s);
    const Dual<Interval<D>> z = term(line.p.z, line.u.z, 2, s), sum = x + y;
    if (e.form == Form::ellipsoid) return minus(sum + z, 1);
    if (e.form == Form::hyperboloid) return minus(sum - z, 1);
    const Dual<Interval<D>> ring = minus(interval::super_power(sum, e.q, e.ratio), e.d);
    return minus(interval::super_power(ring, e.r, e.ratio) + z, e.ee);
  }
  OKTETT_INLINE Interval<D> at(const D& s) const { return over(Interval<D>(s)).v; }

  /// Of the convex ellipsoid, for points in its box, which the line's nearest point to the origin is near.
  template <bool kRatio>
  OKTETT_INLINE interval::Sample<D> sample(const D& s) const {
    interval::Sample<D> f{D(-1.0), D(0.0), D(0x1p-50), D(0.0)};
    const D *p[3] = {&line.p.x, &line.p.y, &line.p.z}, *u[3] = {&line.u.x, &line.u.y, &line.u.z};
    for (int k = 0; k < 3; ++k) {
      const SuperExponent& exponent = e.exponent[k];
      const SuperRounding& rounding = e.rounding[k];
      const D inverse(e.inverse[k]), noise(rounding.noise), rate = *u[k] * inverse;
      const D x = (*p[k] + *u[k] * s) * inverse, size = abs(x);
      // What rounding moves x by. Where that matters next to x itself, the slope is as good as unknown.
      const D off = (abs(*p[k]) + abs(*u[k] * s)) * (inverse * D(0x1p-50)), relative_off = off / size;
      const auto vague = ~(relative_off < D(rounding.vague)) & (off > D(0.0));
      D value, slope, relative;
      sample_power<kRatio>(size, exponent, value, slope, relative);
      const D along = slope * rate, steep = select(vague, noise, D(2.0) * slope);
      f.value = f.value + value;
      f.slope = f.slope + select(x < D(0.0), -along, along);
      f.error = f.error + value * (relative + D(0x1p-50)) + off * steep;
      const D bend = D(rounding.bend) * relative_off + relative + D(0x1p-50);
      f.slope_error =
          f.slope_error + select(vague, abs(rate) * noise, select(off > D(0.0), abs(along) * bend, D(0.0)));
    }
    return f;
  }

 private:
  OKTETT_INLINE static Dual<Interval<D>> minus(const Dual<Interval<D>>& a, double b) {
    return {a.v - Interval<D>(D(b)), a.d};
  }
  OKTETT_INLINE Dual<Interval<D>> term(const D& p, const D& u, int axis, const Interval<D>& s) const {
    const D inverse(e.inverse[axis]);
    const Interval<D> x = (Interval<D>(p) + s * u) * inverse;
    const Interval<D> d = select(u == D(0.0), Interval<D>(u), Interval<D>(u) * inverse);
    return interval::super_power(Dual<Interval<D>>{x, d}, e.exponent[axis], e.ratio);
  }
};

/// The same where it is convex, as `convex_crossings` asks for it.
template <bool kRatio, class D>
struct ConvexSuperquadricField : SuperquadricField<D> {
  OKTETT_INLINE interval::Sample<D> sample(const D& s) const {
    return SuperquadricField<D>::template sample<kRatio>(s);
  }
};

/// Parts: 0 the surface, 1 to 6 the faces of the box.
struct Superquadric {
  using Data = SuperquadricShape;
  using Pool = ExactPool<SuperquadricElement>;
  using Form = SuperquadricShape::Form;
  static constexpr int kMaxCrossings = 8;

  static void add(Pool& pool, const SuperquadricShape& shape, const ExactPlace& place);
  /// How far |x|, |y| and |z| reach; infinite if there is no end, NaN if the parameters are out of range.
  static Vec3d reach(const SuperquadricShape& shape);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const SuperquadricElement& e = pool.elements[cell.element];
    const CenteredLine<D> centered(line);
    const SuperquadricField<D> field{e, centered};
    const D a = centered.to_s(range.a), b = centered.to_s(range.b);
    Crossings<K, D> found;
    D first_sign(0.0);
    if (e.convex && e.ratio)
      interval::convex_crossings<K>(ConvexSuperquadricField<true, D>{field}, a, b, active, found);
    else if (e.convex)
      interval::convex_crossings<K>(ConvexSuperquadricField<false, D>{field}, a, b, active, found);
    else
      first_sign = interval::march<K>(field, a, b, b, active, interval::Jumps::list, found);
    place_crossings(found, [&](const D& s) { return centered.to_t(s); });
    // Where the function jumps is surface as well.
    for (D& part : found.part) part = D(0.0);
    if (e.closed)
      close_by_cell(found, first_sign < D(0.0), range, active, out);
    else
      out = found;
  }

  template <class D>
  OKTETT_NOINLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p,
                                    D& value, Vec3<D>& gradient) {
    const SuperquadricElement& e = pool.elements[i];
    const auto power = [&](const D& x, const SuperExponent& exponent, D& rise) {
      const D size = abs(x), side = select(x < D(0.0), D(-1.0), select(D(0.0) < x, D(1.0), D(0.0)));
      D v, s, relative;
      if (e.ratio)
        sample_power<true>(size, exponent, v, s, relative);
      else
        sample_power<false>(size, exponent, v, s, relative);
      rise = side * s;
      return v;
    };
    D v[3], g[3];
    const D* const axis[3] = {&p.x, &p.y, &p.z};
    for (int k = 0; k < 3; ++k) {
      v[k] = power(*axis[k] * D(e.inverse[k]), e.exponent[k], g[k]);
      g[k] = g[k] * D(e.inverse[k]);
    }
    value = ((v[0] + v[1]) + v[2]) - D(1.0);
    if (e.form == Form::hyperboloid) value = ((v[0] + v[1]) - v[2]) - D(1.0), g[2] = -g[2];
    if (e.form == Form::toroid) {
      D around, across;
      const D ring = power(v[0] + v[1], e.q, around) - D(e.d);
      value = (power(ring, e.r, across) + v[2]) - D(e.ee);
      g[0] = g[0] * around * across, g[1] = g[1] * around * across;
    }
    gradient = {g[0], g[1], g[2]};
    if (e.closed) select_faces(e.lo, e.hi, part, p, value, gradient);
  }
  /// u around z; v from bottom to top of an ellipsoid, around the tube of a toroid, the height z of a
  /// hyperboloid. On a face of the box the position on it.
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
};

}  // namespace oktett
