#pragma once
/// \file Crossings of any function along a ray, isolated by intervals and proven by signs: nothing is
/// sampled, no bound on the slope is asked of the user.
///
/// `field` gives, in lanes,
/// - field.over(t): Dual<Interval<D>>, enclosures of f and f' over an interval of t;
/// - field.at(t): an enclosure of f at a point.
///
/// The ray is walked from a to b. A step over which 0 is not in f (R. E. Moore: Interval Analysis, 1966), nor
/// in the mean value form f(m) + f'(X) (X - m), has a certain sign; the next one is twice as long, but for
/// the first after one that had to be halved. Where f is monotone the signs at the ends decide. Any other
/// step is halved. What rounding does not let one tell, where the ray touches the surface or lies in it, is a
/// *gap*: it is passed over by steps as long as the enclosure is mere rounding noise, and only if the sign
/// has turned on its far side is there a crossing. Steps of 2^-44 of the range end the halving: those over
/// which f is not bounded hold a pole or the border of where f is defined. Undefined counts as
/// positive.

#include "kernels/exact/exact.h"
#include "kernels/interval/dual.h"

namespace oktett::interval {

/// Notes that so many rays were not followed to their ends, as they would have taken too many steps.
void count_uncertified(int rays);
/// How many there have been in this process.
std::uint64_t uncertified_count();

/// Steps after which a ray is given up.
inline constexpr int kMaxSteps = 1 << 16;
/// Marks crossings where f jumps, through a pole or from defined to undefined.
inline constexpr int kJumpPart = 7;

/// What to do with sign changes where f is not bounded.
enum class Jumps {
  drop,        ///< leave them out
  list,        ///< list them as kJumpPart
  list_steep,  ///< and as kJumpPart also those where f is bounded, but steps or is infinitely steep
};

/// 1 or -1 where an enclosure tells the sign, else 0.
template <class D>
OKTETT_INLINE D certain_sign(const Interval<D>& f) {
  return select((D(0.0) < f.lo) | f.is_void(), D(1.0), select(f.hi < D(0.0), D(-1.0), D(0.0)));
}

/// Where a crossing is: f has the certain sign `before` at l and the other one at r. `jump` is 1 if f is not
/// bounded between, 2 if only its derivative is not, else 0.
template <class D>
struct Bracket {
  D l, r, before, jump;
};

/// A representative of what is enclosed.
template <class D>
OKTETT_INLINE D middle(const Interval<D>& f) {
  return f.lo + (f.hi - f.lo) * D(0.5);
}

/// The crossing in a bracket, to within `tolerance` or to where rounding hides the sign: regula falsi in the
/// Illinois form (M. Dowell, P. Jarratt 1971), with bisection where that is slow.
template <class Field, class D>
OKTETT_INLINE D refine(const Field& field, const Bracket<D>& bracket, const D& tolerance,
                       typename D::M active) {
  D l = bracket.l, r = bracket.r, fl = middle(field.at(l)), fr = middle(field.at(r));
  D root = l + (r - l) * D(0.5), side(0.0), slow(0.0);
  active = active & (l < r);
  const auto secant = [&](const D& at_l, const D& at_r) { return l + (r - l) * (at_l / (at_l - at_r)); };
  for (int i = 0; i < 200 && any(active); ++i) {
    const D width = r - l, mid = l + width * D(0.5), step = min(tolerance, width * D(0.25));
    const D guess = min(max(secant(fl, fr), l + step), r - step);
    const D x = select((slow < D(2.0)) & (l < guess) & (guess < r), guess, mid);
    const Interval<D> f = field.at(x);
    const D sign = certain_sign(f), value = middle(f);
    const auto unsure = sign == D(0.0), left = sign == bracket.before;
    const auto to_left = active & ~unsure & left, to_right = active & ~unsure & ~left;
    // An end that stays twice is given half its value.
    fr = select(to_right, value, select(to_left & (side == D(1.0)), fr * D(0.5), fr));
    fl = select(to_left, value, select(to_right & (side == D(-1.0)), fl * D(0.5), fl));
    l = select(to_left, x, l), r = select(to_right, x, r);
    side = select(to_left, D(1.0), D(-1.0));
    slow = select(r - l < width * D(0.5), D(0.0), select(slow < D(2.0), slow + D(1.0), D(0.0)));
    root = select(active & unsure, x, root);
    const D last = secant(fl, fr), inner = l + (r - l) * D(0.5);
    const auto narrow = (r - l <= tolerance) | ~((l < inner) & (inner < r));
    root = select(active & ~unsure & narrow, select((l <= last) & (last <= r), last, inner), root);
    active = active & ~unsure & ~narrow;
  }
  return root;
}

/// A walk along the rays, stopped where K crossings are bracketed.
template <int K, class Field, class D>
struct March {
  using M = typename D::M;
  const Field& field;
  Jumps jumps;
  Bracket<D> found[K];
  D count = D(0.0);
  D t, h, s, g;           ///< place, step, last certain sign, and the last place that has it
  D jump = D(0.0);        ///< of the gap from g to t, as in Bracket
  D grow = D(2.0);        ///< by what the next step is longer, if this one is passed
  D first_sign = D(0.0);  ///< the first certain sign
  M uncertified;

  /// From a to b; and where the sign at b is uncertain, on to where it is certain, as far as `limit`. The
  /// least step is 2^-44 of `range`.
  OKTETT_INLINE March(const Field& f, Jumps j, const D& a, const D& b, const D& limit, const D& range,
                      const M& active)
      : field(f), jumps(j), t(a), h(b - a), s(0.0), g(a) {
    for (int k = 0; k < K; ++k) found[k] = {a, a, D(0.0), D(0.0)};
    const D least = range * D(0x1p-44);
    M live = active & (a < b);
    const M points = active & ~live;
    if (OKTETT_UNLIKELY(any(points))) first_sign = select(points, certain_sign(f.at(a)), first_sign);
    for (int i = 0; i < kMaxSteps && any(live); ++i) {
      step(i == 0, select(t < b, b, limit), least, live);
      live = live & (count < D(K)) & ((t < b) | ((g < t) & (t < limit)));
    }
    uncertified = live;
  }

 private:
  OKTETT_INLINE void step(bool first, const D& end, const D& least, const M& live) {
    const D zero(0.0), two(2.0);
    const D e = min(t + h, end), m = t + (e - t) * D(0.5);
    const Interval<D> x(t, e);
    const Dual<Interval<D>> f = field.over(x);
    Interval<D> value = f.v;
    D sign = certain_sign(value);
    const auto smooth = f.v.is_bounded() & f.d.is_bounded();
    auto open = live & (sign == zero);
    auto noise = open & ~open;
    // Where the first step has one sign, so has its beginning.
    if (first && any(open)) s = first_sign = select(open, certain_sign(field.at(t)), first_sign);
    const auto asked = open & smooth;
    if (any(asked)) {
      const Interval<D> at_m = field.at(m);
      const Interval<D> mean = at_m + f.d * (x - Interval<D>(m));
      value = select(asked & mean.is_bounded(), intersect(f.v, mean), f.v);
      sign = select(open, certain_sign(value), sign);
      open = live & (sign == zero);
      // Where the sign in the middle is certain, as beside a pole, a wide enclosure there is no noise.
      noise = open & asked & (certain_sign(at_m) == zero) &
              (value.hi - value.lo <= D(8.0) * (at_m.hi - at_m.lo) + D(kTiny * 16));
    }
    auto known = live & ~open, monotone = open & smooth & ((zero < f.d.lo) | (f.d.hi < zero));
    D reached = t;
    if (any(monotone)) {
      const D sign_e = certain_sign(field.at(e));
      const auto told = monotone & ~(sign_e == zero);
      // The crossing may be anywhere up to e.
      sign = select(told, sign_e, sign), reached = select(told, e, reached);
      known = known | told;
    }
    const auto turned = known & ~(s == zero) & ~(sign == s);
    if (any(turned)) push(turned, reached);
    first_sign = select(known & (first_sign == zero), sign, first_sign);
    const auto shortest = (e - t <= least) | ~((t < m) & (m < e));
    const auto skip = (open & ~known) & (noise | monotone | shortest);
    const D steep = select(f.v.is_bounded(), select(jump == zero, two, jump), D(1.0));
    jump = select(known, zero, select(skip & ~smooth, steep, jump));
    const auto go = known | skip;
    s = select(known, sign, s), g = select(known, e, g);
    // What is twice as long as a step that follows a failure would likely fail as well.
    h = select(go, (e - t) * grow, select(live, (e - t) * D(0.5), h));
    grow = select(go, two, D(1.0));
    t = select(go, e, t);
  }

  OKTETT_INLINE void push(const M& turned, const D& reached) {
    const auto listed = jumps == Jumps::drop ? turned & ~(jump == D(1.0)) : turned;
    for (int k = 0; k < K; ++k) {
      const auto here = listed & (count == D(k));
      found[k].l = select(here, g, found[k].l), found[k].r = select(here, reached, found[k].r);
      found[k].before = select(here, s, found[k].before), found[k].jump = select(here, jump, found[k].jump);
    }
    count = select(listed, count + D(1.0), count);
  }
};

/// The first K crossings of `field` on [a, b], finite, in the lanes of `active`. Their parts are 0 or
/// kJumpPart. A crossing that is not told apart from b may lie between b and `limit`. The least step is
/// 2^-44 of `range` and the tolerance of crossings 2^-42 of it; `range` is at least b - a, and more where
/// [a, b] is one cell of a larger box. Returns the first certain sign from a on, 0 if there is none.
template <int K, class Field, class D>
OKTETT_INLINE D march(const Field& field, const D& a, const D& b, const D& limit, const D& range,
                      const typename D::M& active, Jumps jumps, Crossings<K, D>& out) {
  const March<K, Field, D> walk(field, jumps, a, b, limit, range, active);
  const D tolerance = max(range * D(0x1p-42), max(abs(a), abs(b)) * D(0x1p-50));
  CrossingList<K, D> list(out);
  for (int k = 0; k < K; ++k) {
    const auto here = active & (D(k) < walk.count);
    if (none(here)) break;
    const Bracket<D>& bracket = walk.found[k];
    const D x = refine(field, bracket, tolerance, here);
    const auto wall = jumps == Jumps::list_steep ? bracket.jump > D(0.0) : bracket.jump == D(1.0);
    list.push(here, x, -bracket.before, select(wall, D(kJumpPart), D(0.0)));
  }
  list.finish(select(walk.count < D(K), D(roots::kNoRoot), walk.t));
  const unsigned lost = bits(walk.uncertified);
  if (OKTETT_UNLIKELY(lost != 0)) count_uncertified(__builtin_popcount(lost));
  return walk.first_sign;
}

/// The same with b - a for `range`.
template <int K, class Field, class D>
OKTETT_INLINE D march(const Field& field, const D& a, const D& b, const D& limit, const typename D::M& active,
                      Jumps jumps, Crossings<K, D>& out) {
  return march(field, a, b, limit, b - a, active, jumps, out);
}

}  // namespace oktett::interval
