#pragma once
/// \file Crossings of a function with zero along a ray, isolated by interval arithmetic: none is missed, and
/// none is invented (compare A. Knoll et al.: Fast Ray Tracing of Arbitrary Implicit Surfaces with Interval and
/// Affine Arithmetic, 2009). Each lane marches along its own range; a step that surely holds no crossing, or
/// one, is taken, any other is halved.
///
/// `field.over(t)` encloses f and df/dt over an interval of t, `field.at(t)` encloses f at a point.

#include "kernels/interval/interval.h"
#include "kernels/shapes/exact.h"

namespace oktett {

namespace march {

/// Certain sign: -1 or 1, or 0 if the enclosure holds zero.
template <class D>
OKTETT_INLINE D sign(const Interval<D>& f) {
  return select(f.lo > D(0.0), D(1.0), select(f.hi < D(0.0), D(-1.0), D(0.0)));
}

/// f over [t, t + h], by its natural extension and by the mean value; and its slope.
template <class Field, class D>
OKTETT_INLINE Slope<D> enclose(const Field& field, const D& t, const D& h) {
  Slope<D> f = field.over(Interval<D>{t, t + h});
  const D half = D(0.5) * h, middle = t + half;
  const D reach = interval::up(max(middle - t, (t + h) - middle));
  const Interval<D> mean = field.at(middle) + f.d * Interval<D>{-reach, reach};
  f.v = intersect(f.v, mean);
  return f;
}

/// The crossing in [lo, hi], where the certain signs at the ends differ: by secants that keep the bracket
/// (the Illinois method; M. Dowell, P. Jarratt 1971), or halving where they do not shorten it.
template <class Field, class D>
OKTETT_INLINE D refine(const Field& field, D lo, D hi, const D& sign_lo, const typename D::M& wanted) {
  const auto middle_of = [](const Interval<D>& f) { return D(0.5) * (f.lo + f.hi); };
  D f_lo = middle_of(field.at(lo)), f_hi = middle_of(field.at(hi)), last_side(0.0), width = hi - lo;
  D x = D(0.5) * (lo + hi);
  auto active = wanted & (lo < hi);
  for (int i = 0; i < 64 && any(active); ++i) {
    D next = (lo * f_hi - hi * f_lo) / (f_hi - f_lo);
    // Every third step halves what secants have not.
    const auto slow = D(i % 3 == 2 ? 1.0 : 0.0) * (hi - lo) > D(0.5) * width;
    const auto good = (next > lo) & (next < hi) & ~slow;
    next = select(good, next, lo + D(0.5) * (hi - lo));
    if (i % 3 == 2) width = hi - lo;
    const Interval<D> f = field.at(next);
    const D s = sign(f), value = middle_of(f);
    x = select(active, next, x);
    const auto unsure = s == D(0.0);
    const auto left = s == sign_lo;
    const auto go_left = active & ~unsure & left, go_right = active & ~unsure & ~left;
    f_hi = select(go_left & (last_side == D(-1.0)), f_hi * D(0.5), select(go_right, value, f_hi));
    f_lo = select(go_right & (last_side == D(1.0)), f_lo * D(0.5), select(go_left, value, f_lo));
    lo = select(go_left, next, lo), hi = select(go_right, next, hi);
    last_side = select(go_left, D(-1.0), select(go_right, D(1.0), last_side));
    // What the function's own rounding leaves open cannot be told better.
    active = active & ~unsure & (hi - lo > D(0x1p-46) * max(abs(lo), abs(hi))) & (next > lo - width) & (lo < hi);
  }
  return select(wanted & (x >= lo) & (x <= hi), x, D(0.5) * (lo + hi));
}

}  // namespace march

/// Steps after which a lane gives up; its last sign is taken to hold to the end. Only rays that lie in a
/// surface whose function is not exactly zero there come near.
inline constexpr int kMaxMarchSteps = 4096;

/// The first K crossings in [a, b], with the part numbers 0.
template <int K, class Field, class D>
OKTETT_INLINE void march_crossings(const Field& field, const D& a, const D& b, const typename D::M& active,
                                   Crossings<K, D>& out) {
  CrossingList<K, D> list(out);
  D up_to(roots::kNoRoot);
  // Lanes without a range compute along with harmless numbers.
  auto open = active & (a <= b);
  D t = select(open, a, D(0.0));
  const D end = select(open, b, D(0.0));
  const D whole = end - t;
  D h = whole, gap = t, s = march::sign(field.at(t));
  const D least = max(D(0x1p-44) * whole, D(0x1p-50) * max(abs(t), abs(end)));
  for (int step = 0; step < kMaxMarchSteps && any(open); ++step) {
    h = min(h, end - t);
    const Slope<D> f = march::enclose(field, t, h);
    const D next = select(h >= end - t, end, t + h);
    const D over = march::sign(f.v), slope = march::sign(f.d), last = march::sign(field.at(next));
    const auto clear = ~(over == D(0.0));
    // Monotone: the signs at both ends say how often f is zero between them.
    const auto monotone = ~clear & ~(slope == D(0.0)) & ~(last == D(0.0));
    const auto tiny = ~clear & ~monotone & (h <= least);
    const D sign_next = select(clear, over, last);
    const auto known = open & (clear | monotone);
    const auto turned = known & ~(s == D(0.0)) & ~(sign_next == s);
    if (any(turned)) {
      // In the gap of unknown sign before this step, or in the step.
      const D from = gap, to = select(clear, t, next);
      const D x = march::refine(field, select(turned, from, t), select(turned, to, t), s, turned);
      list.push(turned, x, sign_next, D(0.0));
    }
    s = select(known, sign_next, s);
    const auto pass = open & (clear | monotone | tiny);
    gap = select(known, next, gap);
    t = select(pass, next, t);
    // Where nothing can be told for long, steps grow all the same as far as they tell nothing new.
    h = select(pass, h * D(2.0), h * D(0.5));
    open = open & (t < end) & (list.count < D(K));
  }
  up_to = select(t >= end, up_to, t);
  list.finish(up_to);
}

}  // namespace oktett
