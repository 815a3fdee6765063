#pragma once
/// \file Superquadrics and ratioquadrics (Zachmann 2010; A. H. Barr: Superquadrics and Angle-Preserving
/// Transformations, 1981; C. Blanc, C. Schlick: Ratioquadrics, 1996).

#include "kernels/exact/exact.h"
#include "kernels/exact/march.h"
#include "kernels/exact/superquadric_data.h"

namespace oktett {

// ---- Crossings of a function that is convex along the ray: at most two. Newton's method from outside
// approaches each from its own side and never steps over it, as the tangent lies below the function.
//
// `field.sample(t)` gives value, slope and bounds on their errors at a point. What these leave in doubt is
// left to intervals (march.h). Why nothing is missed and nothing invented: docs/interval.md.

namespace interval {

template <class D>
struct Sample {
  D value, slope;
  D error, slope_error;  ///< bounds on the absolute errors of both

  OKTETT_INLINE typename D::M positive() const { return value > error; }
  OKTETT_INLINE typename D::M negative() const { return value < -error; }
};

/// Steps of Newton's method after which intervals take over.
inline constexpr int kMaxNewtonSteps = 40;
/// A step below kNear is followed by a look kOver beyond the root: the sign must have turned there. kMostOver
/// where rounding hides the sign so near.
inline constexpr double kNear = 0x1p-20, kOver = 0x1p-40, kMostOver = 0x1p-28;

/// The crossing that one meets first from `start`, where the function is surely positive (`first` is its
/// sample), on the way to `end`; kNoRoot where there surely is none. Adds to `unsure` the lanes in which
/// nothing is sure. Ends and function are about 1 in size.
template <class Field, class D>
OKTETT_INLINE D approach(const Field& field, const D& start, const Sample<D>& first, const D& end,
                         const typename D::M& wanted, typename D::M& unsure) {
  const D zero(0.0), way = select(end < start, D(-1.0), D(1.0));
  D t = start, root(roots::kNoRoot);
  Sample<D> f = first;
  auto open = wanted;
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    // If the tangent stays positive as far as the end, so does the function.
    const D fall = -(f.slope * way), length = (end - t) * way;
    const auto missed = f.value - f.error > max(fall + f.slope_error, zero) * length;
    open = open & ~missed;
    const D flat = D(1.0) / fall, step = f.value * flat;
    const auto near = step < D(kNear), lost = ~(fall > zero) | ~(step <= length);
    unsure = unsure | (open & lost);
    open = open & ~lost;
    if (none(open)) break;
    const D over = select(near, min(D(kMostOver), D(kOver) + D(4.0) * f.error * flat), zero);
    const D next = t + way * (step + over);
    const Sample<D> g = field.sample(next);
    const auto turned = open & g.negative(), found = turned & near;
    root = select(found, t + way * step, root);
    // Where f rises, its values before `next` may be lower: as far back as the last tangent is not proof.
    const D gap = over + D(2.0) * (f.error + f.slope_error * step) * flat;
    const D rise = max(g.slope * way + g.slope_error, zero);
    const auto ahead = g.value - g.error > rise * gap, noise = ~g.positive() & ~near;
    const auto doubtful = open & ~found & ~((ahead | noise) & ~turned);
    unsure = unsure | doubtful;
    open = open & ~found & ~doubtful;
    t = next, f = g;
  }
  unsure = unsure | open;
  return root;
}

template <int K, class Field, class D>
OKTETT_NOINLINE void certain_crossings(const Field& field, const D& a, const D& b,
                                       const typename D::M& active, Crossings<K, D>& out) {
  march<K>(field, a, b, b, active, Jumps::list, out);
}

/// Crossings of a convex function in [a, b], as `march`.
template <int K, class Field, class D>
OKTETT_INLINE void convex_crossings(const Field& field, const D& a, const D& b, const typename D::M& active,
                                    Crossings<K, D>& out) {
  const D no_root(roots::kNoRoot);
  const Sample<D> at_a = field.sample(a);
  const auto outside = active & at_a.positive(), inside = active & at_a.negative();
  auto unsure = active & ~(outside | inside);
  D enter = no_root, leave = no_root;
  if (any(outside)) enter = approach(field, a, at_a, b, outside, unsure);
  const auto leaves = K == 1 ? inside : inside | (outside & ~unsure & (enter < no_root));
  if (any(leaves)) {
    const Sample<D> at_b = field.sample(b);
    const auto ends_outside = leaves & at_b.positive(), ends_inside = leaves & at_b.negative();
    unsure = unsure | (leaves & ~(ends_outside | ends_inside));
    leave = approach(field, b, at_b, a, ends_outside, unsure);
    // There must be a way out, after the way in.
    unsure = unsure | (ends_outside & ~(leave < no_root)) | (outside & (leave <= enter));
  }
  CrossingList<K, D> list(out);
  list.push(outside & ~unsure & (enter < no_root), enter, D(-1.0), D(0.0));
  list.push(leaves & ~unsure & (leave < no_root), leave, D(1.0), D(0.0));
  list.finish(K == 1 ? out.t[0] : no_root);
  if (OKTETT_LIKELY(none(unsure))) return;
  Crossings<K, D> other;
  certain_crossings<K>(field, a, b, unsure, other);
  select_crossings(unsure, other, out);
}

}  // namespace interval

// ---- Powers of |x| as superquadrics take them, and the pseudo-powers of ratioquadrics, g_p(x) = x / (p +
// (1 - p) x) (C. Blanc, C. Schlick: Ratioquadrics, 1996). Both rise from 0 through g(1) = 1; their slopes
// rise if p >= 1 and fall if p <= 1. For p > 1 a pseudo-power has a pole at p / (p - 1): from there on it
// counts as infinite.

struct SuperExponent {
  double p = 2;
  int whole = 2;  ///< p if it is a small whole number, else 0

  SuperExponent() = default;
  explicit SuperExponent(double x)
      : p(x), whole(x == static_cast<int>(x < 32 ? x : 0) ? static_cast<int>(x) : 0) {}
};

/// What rounding x does to the slope of a convex power (p >= 1) for |x| below about 1. Rounding that moves x
/// by less than `vague` of itself changes the slope by less than `bend` times as much of itself. Otherwise
/// x is so small that the slope is below `noise`, as is its error.
struct SuperRounding {
  double vague, bend, noise;
};

namespace interval {

/// |x|^p by the ends of |x|, lo <= hi, and the slope by |x|.
template <class D>
OKTETT_INLINE Dual<Interval<D>> power_between(const Interval<D>& x, const SuperExponent& e) {
  const Interval<D> v = e.whole > 0 ? pow_positive(x, e.whole) : pow_positive(x, e.p);
  if (e.p == 1) return {v, Interval<D>(D(1.0))};
  // The slope is p x^(p-1) = p v / x, of which v.lo belongs to x.lo and v.hi to x.hi.
  const D p(e.p), tiny(1e-250);
  const D at_lo = p * v.lo / x.lo, at_hi = p * v.hi / x.hi;
  if (e.p > 1) {
    const D least = select(tiny < x.lo, at_lo, D(0.0)), most = select(D(0.0) < x.hi, at_hi, D(0.0));
    return {v, outward_positive(least, most, D(0x1p-50))};
  }
  // It falls: v.lo may be too small and v.hi too large for it, by far less than 2^-30.
  const D most = select(tiny < x.lo, at_lo * D(1 + 0x1p-30), Interval<D>::infinity());
  const D least = select(tiny < x.hi, at_hi * D(1 - 0x1p-30), D(0.0));
  return {v, outward_positive(least, most, D(0x1p-50))};
}

/// g_p at the point x >= 0 and its denominator.
template <class D>
OKTETT_INLINE Interval<D> ratio_denominator(const D& x, double p) {
  const Interval<D> one(D(1.0)), exponent{D(p)};
  return exponent + (one - exponent) * Interval<D>(x);
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> ratio_between(const Interval<D>& x, const SuperExponent& e) {
  const D zero(0.0), inf = Interval<D>::infinity(), greatest(kGreatest), huge(1e150), p(e.p);
  const D lo = min(huge, x.lo), hi = min(huge, x.hi);
  const Interval<D> b_lo = ratio_denominator(lo, e.p), b_hi = ratio_denominator(hi, e.p);
  const Interval<D> ends = outward_positive(lo / b_lo.hi, hi / b_hi.lo);
  Interval<D> v{select(zero < b_lo.hi, ends.lo, greatest), select(zero < b_hi.lo, ends.hi, inf)};
  if (e.p < 1) v.hi = min(v.hi, D(1 / (1 - e.p) * (1 + 0x1p-48)));
  // p / b^2 rises with x for p > 1 and falls for p < 1.
  const Interval<D>&slow = e.p >= 1 ? b_lo : b_hi, &fast = e.p >= 1 ? b_hi : b_lo;
  const Interval<D> g = outward_positive(p / (slow.hi * slow.hi), p / (fast.lo * fast.lo), D(0x1p-49));
  const D most = select((zero < fast.lo) & (x.hi < huge), g.hi, inf);
  const D least = select((zero < slow.hi) & (x.hi < huge), g.lo, zero);
  return {v, {least, most}};
}

/// The power of |x|, or the pseudo-power.
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> super_power(const Dual<Interval<D>>& x, const SuperExponent& e,
                                              bool ratio) {
  const Interval<D> size = abs(x.v);
  Dual<Interval<D>> r = ratio ? ratio_between(size, e) : power_between(size, e);
  const D one(1.0), zero(0.0);
  const Interval<D> side{select(zero <= x.v.lo, one, -one), select(x.v.hi <= zero, -one, one)};
  const auto still = (x.d.lo == zero) & (x.d.hi == zero);
  r.d = select(still, Interval<D>(zero), carry(x.v, r.d * (side * x.d)));
  r.v = carry(x.v, r.v);
  return r;
}

}  // namespace interval

/// Value, slope, and the value's relative error, of the power of x >= 0, by plain arithmetic.
template <bool kRatio, class D>
OKTETT_INLINE void sample_power(const D& x, const SuperExponent& e, D& value, D& slope, D& relative) {
  const D p(e.p), inf(std::numeric_limits<double>::infinity());
  if constexpr (kRatio) {
    const D below = p + D(1 - e.p) * x, inverse = D(1.0) / below;
    const auto defined = below > D(0.0);
    value = select(defined, x * inverse, inf), slope = select(defined, p * inverse * inverse, inf);
    // The sum cancels near the pole.
    relative = D(0x1p-50) * (p + abs(D(1 - e.p)) * x) * inverse + D(0x1p-50);
  } else if (e.whole > 0) {
    const D below = e.whole > 1 ? lane::pow_whole(x, e.whole - 1) : D(1.0);
    value = below * x, slope = p * below, relative = D(e.p * 0x1p-52);
  } else {
    D exponent;
    value = lane::pow(x, p, exponent);
    slope = select(x > D(0.0), p * value / x, D(0.0));
    relative = lane::pow_error(exponent) + D(0x1p-50);
  }
}

// ---- Superquadrics and ratioquadrics.

struct SuperquadricElement {
  double inverse[3];          ///< 1 / a, 1 / b, 1 / c
  SuperExponent exponent[3];  ///< of x, y and z
  SuperRounding rounding[3];  ///< of x, y and z of a convex one
  SuperExponent q, r;         ///< of the toroid's ring and tube
  double d, ee;               ///< of the toroid: d and e^2
  Vec3d lo, hi;               ///< the box
  SuperquadricShape::Form form;
  bool ratio, closed;
  bool convex;  ///< its function is convex along every line
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

  /// Of a convex one, for points in its box, which the line's nearest point to the origin is near.
  template <bool kRatio>
  OKTETT_INLINE interval::Sample<D> sample(const D& s) const {
    const bool toroid = !kRatio && e.form == Form::toroid;
    interval::Sample<D> f{D(toroid ? 0.0 : -1.0), D(0.0), D(toroid ? 0.0 : 0x1p-50), D(0.0)};
    add_term<kRatio>(line.p.x, line.u.x, 0, s, f);
    add_term<kRatio>(line.p.y, line.u.y, 1, s, f);
    if (toroid) f = in_ring(f);
    add_term<kRatio>(line.p.z, line.u.z, 2, s, f);
    return f;
  }

 private:
  /// Adds the power of a coordinate.
  template <bool kRatio>
  OKTETT_INLINE void add_term(const D& p, const D& u, int axis, const D& s, interval::Sample<D>& f) const {
    const SuperRounding& rounding = e.rounding[axis];
    const D inverse(e.inverse[axis]), noise(rounding.noise), rate = u * inverse;
    const D x = (p + u * s) * inverse, size = abs(x);
    // What rounding moves x by. Where that matters next to x itself, the slope is as good as unknown.
    const D off = (abs(p) + abs(u * s)) * (inverse * D(0x1p-50)), relative_off = off / size;
    const auto vague = ~(relative_off < D(rounding.vague)) & (off > D(0.0));
    D value, slope, relative;
    sample_power<kRatio>(size, e.exponent[axis], value, slope, relative);
    const D along = slope * rate, steep = select(vague, noise, D(2.0) * slope);
    f.value = f.value + value;
    f.slope = f.slope + select(x < D(0.0), -along, along);
    f.error = f.error + value * (relative + D(0x1p-50)) + off * steep;
    const D bend = D(rounding.bend) * relative_off + relative + D(0x1p-50);
    f.slope_error =
        f.slope_error + select(vague, abs(rate) * noise, select(off > D(0.0), abs(along) * bend, D(0.0)));
  }
  /// Below this, powers may have been lost that are far from zero once their root is taken.
  static constexpr double kLeastSum = 1e-200;
  /// The power of the sum of x and y in a toroid whose ring is a point, less e^2. Where the sum is known to
  /// few bits, about the axis, nothing is known.
  OKTETT_INLINE interval::Sample<D> in_ring(const interval::Sample<D>& sum) const {
    const D zero(0.0), inf(std::numeric_limits<double>::infinity()), two(2.0), p(e.q.p);
    D value, slope, relative;
    sample_power<false>(sum.value, e.q, value, slope, relative);
    // Within a quarter of 1 / (1 + p) of the sum its power's slope changes by less than half.
    const D part = sum.error / sum.value;
    const auto vague = ~((part * (D(4.0) + D(4.0) * p) < D(1.0)) & (D(kLeastSum) < sum.value));
    const D along = slope * sum.slope, bend = two * abs(p - D(1.0)) * part + relative + D(0x1p-50);
    const D error =
        two * slope * sum.error + value * (relative + D(0x1p-50)) + D(0x1p-50) * max(D(1.0), D(e.ee));
    const D slope_error = two * slope * sum.slope_error + abs(along) * bend;
    return {value - D(e.ee), select(vague, zero, along), select(vague, inf, error),
            select(vague, inf, slope_error)};
  }
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
