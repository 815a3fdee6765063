#pragma once
/// \file Certified roots in an interval for a fixed degree, many polynomials at once. D is a Simd of double;
/// each lane holds its own polynomial and gets the same bits as at width 1.
///
/// The method is that of bernstein.cpp. Instead of a stack, each lane marches along its interval: a step that
/// surely holds no root or one is taken, any other is halved. What cannot be decided in double is left to
/// `solve`, which can use double-double, one lane at a time.

#include "core/simd.h"
#include "kernels/roots/roots.h"

namespace oktett::roots {

/// Up to K roots per lane in ascending order; kNoRoot where there are no more.
template <class D, int K>
struct LaneRoots {
  D x[K], error[K];
  /// Lanes that could not be decided; their other members are not valid.
  typename D::M unsure;
};

/// How to treat clusters of even multiplicity: there the polynomial touches or nearly touches zero and has
/// the same sign on both sides.
enum class Touching { keep, drop };

namespace lanes {

/// Coefficients of p(l + w u), u in [0, 1], in powers of u.
template <int N, class D>
OKTETT_INLINE void shift(const D* c, const D& l, const D& w, D* out) {
  for (int i = 0; i <= N; ++i) out[i] = c[i];
  for (int k = 0; k < N; ++k) {
    for (int i = N - 1; i >= k; --i) out[i] = out[i] + out[i + 1] * l;
  }
  D power = w;
  for (int i = 1; i <= N; ++i) {
    out[i] = out[i] * power;
    power = power * w;
  }
}

/// 1 / binomial(N, i), rounded. A template over D, so that each instruction set has its own copy.
template <int N, class D>
struct InverseBinomials {
  double at[N + 1] = {};
  constexpr InverseBinomials() {
    double binomial = 1;
    for (int i = 0; i <= N; ++i) {
      at[i] = 1 / binomial;
      binomial = binomial * (N - i) / (i + 1);
    }
  }
};

/// From powers to the Bernstein basis, in place.
template <int N, class D>
OKTETT_INLINE void to_bernstein(D* b) {
  constexpr InverseBinomials<N, D> inverse;
  for (int i = 1; i < N; ++i) b[i] = b[i] * D(inverse.at[i]);
  for (int k = 1; k <= N; ++k) {
    for (int i = N; i >= k; --i) b[i] = b[i] + b[i - 1];
  }
}

template <int N, class D>
OKTETT_INLINE D absolute_sum(const D* c, const D& x) {
  D y = abs(c[N]);
  for (int i = N - 1; i >= 0; --i) y = y * x + abs(c[i]);
  return y;
}

/// Bound on the error by underflow, the same for all lanes: N products and sums, scaled by at most 2^(30 N).
inline constexpr double kLaneUnderflow = 0x1p-700, kGreatestEnd = 0x1p30;

/// p(x), its error bound and p'(x); see evaluate in polynomial.cpp.
template <int N, class D>
OKTETT_INLINE void evaluate(const D* c, const D& x, D& value, D& error, D& slope) {
  const D ax = abs(x);
  D y = c[N], m = D(0.5) * abs(y), d(0.0);
  for (int i = N - 1; i >= 0; --i) {
    d = d * x + y;
    y = y * x + c[i];
    m = m * ax + abs(y);
  }
  value = y, slope = d;
  error = D(0x1p-53 * (1 + 0x1p-40)) * (D(2.0) * m - abs(y)) + D(kLaneUnderflow);
}

/// What the coefficients prove about their interval.
template <class D>
struct Finding {
  /// Surely no root; surely one, simple, and none at the ends.
  typename D::M none, one;
};

template <int N, class D>
OKTETT_INLINE Finding<D> examine(const D* b, const D& error) {
  typename D::M above[N + 1], below[N + 1];
  for (int i = 0; i <= N; ++i) above[i] = b[i] > error, below[i] = b[i] < -error;
  // One change of sign: all before b[k] are above, all after it below; the sign of b[k] does not matter.
  auto all_above = above[0], all_below = below[0];
  for (int i = 1; i <= N; ++i) all_above = all_above & above[i], all_below = all_below & below[i];
  const auto end_below = above[0] & below[N], end_above = below[0] & above[N];
  auto one = end_below | end_above;
  if constexpr (N > 1) {
    typename D::M falling = ~one & one, rising = falling;
    for (int k = 1; k < N; ++k) {
      auto fall = end_below, rise = end_above;
      for (int i = 1; i < N; ++i) {
        if (i < k) fall = fall & above[i], rise = rise & below[i];
        if (i > k) fall = fall & below[i], rise = rise & above[i];
      }
      falling = falling | fall, rising = rising | rise;
    }
    one = falling | rising;
  }
  return {all_above | all_below, one};
}

/// A part of the interval with one root; p is above zero just behind l if `first` is.
template <class D>
struct Bracket {
  D l, r, start, first;
};

/// Newton's method within the bracket. The bound is proved by signs; lanes of `wanted` where that fails are
/// returned, and those where the bound is above `fine_enough`.
template <int N, class D>
OKTETT_INLINE typename D::M refine(const D* c, const Bracket<D>& bracket, const D& fine_enough,
                                   const typename D::M& wanted, D& x, D& bound) {
  D lo = bracket.l, hi = bracket.r, last = hi - lo;
  const auto rising = bracket.first < D(0.0);
  x = select((bracket.start > lo) & (bracket.start < hi), bracket.start, lo + D(0.5) * (hi - lo));
  D y(0.0), doubt(0.0), slope(1.0);
  auto active = wanted;
  for (int i = 0; i < 64; ++i) {
    D v, error, d;
    evaluate<N>(c, x, v, error, d);
    y = select(active, v, y);
    doubt = select(active, error, doubt);
    slope = select(active, d, slope);
    active = active & (abs(v) > error);
    const auto left = (rising & (v < D(0.0))) | (~rising & (v > D(0.0)));
    lo = select(active & left, x, lo);
    hi = select(active & ~left, x, hi);
    const D step = v / d, newton = x - step;
    const auto good = (newton > lo) & (newton < hi) & (D(2.0) * abs(step) <= last);
    const D next = select(good, newton, lo + D(0.5) * (hi - lo));
    last = select(active, select(good, abs(step), hi - lo), last);
    active = active & (abs(next - x) > D(0x1p-51) * abs(x)) & (next > lo) & (next < hi);
    if (none(active)) break;
    x = select(active, next, x);
  }
  auto open = wanted;
  D e = D(2.0) * (abs(y) + doubt) / abs(slope) + D(0x1p-52) * abs(x);
  for (int i = 0; i < 2; ++i) {
    const D l = x - e, r = x + e;
    D vl, vr, el, er, d;
    evaluate<N>(c, l, vl, el, d);
    evaluate<N>(c, r, vr, er, d);
    const auto left = (l <= bracket.l) | (rising & (vl < -el)) | (~rising & (vl > el));
    const auto right = (r >= bracket.r) | (rising & (vr > er)) | (~rising & (vr < -er));
    const auto closed = open & left & right;
    bound = select(closed, max(x - l, r - x), bound);
    open = open & ~closed;
    if (none(open)) break;
    e = e * D(8.0);
  }
  return open | (wanted & ~(bound <= fine_enough));
}

}  // namespace lanes

/// The first K roots in [a, b], simple and certified, in lanes of `active`; the others hold nothing valid.
/// Lanes where double arithmetic cannot tell, those with NaN or infinite numbers, and those with an end above
/// 2^30 are `unsure`.
template <int N, int K, class D>
OKTETT_INLINE LaneRoots<D, K> roots_in_lanes(const D* c, const D& a, const D& b,
                                             const typename D::M& active) {
  const D w = b - a;
  static_assert(N >= 1 && N <= 8);
  D q[N + 1];
  lanes::shift<N>(c, a, w, q);
  // One bound for both conversions, of [a, b] here and of its parts below; see to_bernstein in
  // polynomial.cpp.
  const D reach = abs(a) + w;
  const D error = D((6 * N + 12) * 0x1p-53 * (1 + 0x1p-40)) *
                      (lanes::absolute_sum<N>(c, reach) + lanes::absolute_sum<N>(q, D(1.0))) +
                  D(lanes::kLaneUnderflow);
  LaneRoots<D, K> out;
  // Idle lanes compute too; harmless numbers avoid slow operations on subnormals.
  lanes::Bracket<D> bracket[K];
  for (int k = 0; k < K; ++k) bracket[k] = {a, b, b, D(1.0)};
  D l(0.0), h(1.0), count(0.0);
  // If nothing can be decided at all, steps would only become shorter.
  const auto sane = (a <= b) & (error < D(0x1p900)) & (reach <= D(lanes::kGreatestEnd));
  auto open = active & sane;
  out.unsure = active & ~sane;
  for (int i = 0; i < 16 * N && any(open); ++i) {
    D part[N + 1];
    lanes::shift<N>(q, l, h, part);
    lanes::to_bernstein<N>(part);
    const lanes::Finding<D> finding = lanes::examine<N>(part, error);
    const D r = l + h, from = a + w * l, to = min(a + w * r, b);
    const auto found = open & finding.one, pass = open & (finding.one | finding.none);
    for (int k = 0; k < K; ++k) {
      const auto here = found & (count == D(k));
      bracket[k].l = select(here, from, bracket[k].l);
      bracket[k].r = select(here, to, bracket[k].r);
      bracket[k].start = select(here, from + (to - from) * (part[0] / (part[0] - part[N])), bracket[k].start);
      bracket[k].first = select(here, part[0], bracket[k].first);
    }
    count = select(found, count + D(1.0), count);
    l = select(pass, r, l);
    // Steps grow by less than they were halved, so they never return to a cut that lies on a root.
    h = select(pass, min(h * D(1.75), D(1.0) - l), h * D(0.5));
    open = open & (l < D(1.0)) & (count < D(K));
    const auto tiny = open & ~(h > D(0x1p-24)) & ~pass;
    out.unsure = out.unsure | tiny;
    open = open & ~tiny;
  }
  out.unsure = out.unsure | open;
  for (int k = 0; k < K; ++k) {
    out.x[k] = out.error[k] = D(kNoRoot);
    const auto wanted = active & ~out.unsure & (count > D(k));
    if (none(wanted)) continue;
    D x, bound(0.0);
    out.unsure =
        out.unsure | lanes::refine<N>(c, bracket[k], D(0x1p-40) * max(abs(a), abs(b)), wanted, x, bound);
    out.x[k] = select(wanted, x, out.x[k]);
    out.error[k] = select(wanted, bound * D(1 + 0x1p-50), out.error[k]);
  }
  return out;
}

/// Like roots_in_lanes, but calls `solve` for unsure lanes. A cluster is listed once; an even one is left out
/// if the caller wishes. Lanes that `solve` cannot certify stay `unsure` and hold its best guess.
template <int N, int K, Touching kTouching = Touching::keep, class D>
OKTETT_INLINE LaneRoots<D, K> certified_roots(const D* c, const D& a, const D& b,
                                              const typename D::M& active) {
  LaneRoots<D, K> out = roots_in_lanes<N, K>(c, a, b, active);
  const unsigned unsure = bits(out.unsure);
  if (OKTETT_LIKELY(unsure == 0)) return out;
  constexpr int W = D::kWidth;
  double coefficient[N + 1][W], from[W], to[W], x[K][W], error[K][W];
  for (int i = 0; i <= N; ++i) c[i].store(coefficient[i]);
  a.store(from);
  b.store(to);
  for (int k = 0; k < K; ++k) out.x[k].store(x[k]), out.error[k].store(error[k]);
  unsigned left = 0;
  for (int lane = 0; lane < W; ++lane) {
    if (!(unsure >> lane & 1)) continue;
    Polynomial p;
    p.degree = N;
    for (int i = 0; i <= N; ++i) p.c[i] = coefficient[i][lane];
    const bool all = kTouching == Touching::drop;
    const Roots answer = solve(p, from[lane], to[lane], Method::automatic, all ? N : K);
    int k = 0;
    for (int i = 0; i < answer.count && k < K; ++i) {
      if (all && answer.root[i].multiplicity % 2 == 0) continue;
      x[k][lane] = answer.root[i].x;
      error[k++][lane] = answer.root[i].error;
    }
    for (; k < K; ++k) x[k][lane] = error[k][lane] = kNoRoot;
    if (!answer.certified) left |= 1u << lane;
  }
  for (int k = 0; k < K; ++k) out.x[k] = D::load(x[k]), out.error[k] = D::load(error[k]);
  out.unsure = D::M::from_bits(left);
  return out;
}

}  // namespace oktett::roots
