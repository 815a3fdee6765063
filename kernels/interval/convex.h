#pragma once
/// \file Crossings of a function that is convex along the ray: at most two. Newton's method from outside
/// approaches each from its own side and cannot step over it.
///
/// `field.sample(t)` gives value, slope and bounds on their errors at a point. What these leave in doubt is
/// left to intervals (march.h).

#include "kernels/interval/march.h"

namespace oktett::interval {

template <class D>
struct Sample {
  D value, slope;
  D error, slope_error;  ///< bounds on the absolute errors of both
};

/// The crossing that one meets first from `start`, where the function is surely positive, on the way to
/// `end`; kNoRoot where there surely is none. Adds to `unsure` the lanes in which nothing is sure.
template <class Field, class D>
OKTETT_INLINE D approach(const Field& field, const D& start, const D& end, const typename D::M& wanted,
                         typename D::M& unsure) {
  const D zero(0.0);
  const D way = select(end < start, D(-1.0), D(1.0));
  D t = start, root(roots::kNoRoot), fall = zero;
  auto open = wanted, found = wanted & ~wanted;
  Sample<D> f{zero, zero, zero, zero};
  for (int i = 0; i < 40 && any(open); ++i) {
    f = field.sample(t);
    fall = -(f.slope * way);
    // The tangent is below the function; if it stays positive as far as the end, so does that.
    const D length = (end - t) * way;
    const auto positive = f.value > f.error;
    const auto none_left = open & positive & (f.value - max(fall, zero) * length > f.error + f.slope_error * length);
    const D step = f.value / fall, next = t + way * step;
    const auto arrived = ~positive | (step < D(0x1p-44) * (abs(t) + D(1.0)));
    const auto lost = ~(fall > zero) | ~(next == next);
    found = found | (open & ~none_left & ~lost & arrived);
    unsure = unsure | (open & ~none_left & lost);
    open = open & ~none_left & ~lost & ~arrived;
    t = select(open, next, t);
    // f is what belongs to t: lanes that have arrived keep theirs below.
    if (any(found)) root = select(found & (root == D(roots::kNoRoot)), t, root);
  }
  unsure = unsure | open;
  if (none(found)) return D(roots::kNoRoot);
  // It is a crossing if the sign has surely changed a little farther on.
  const D here = select(found, root, start);
  const Sample<D> at = field.sample(here);
  const D slope = -(at.slope * way);
  const D reach = D(8.0) * ((abs(at.value) + at.error) / slope) + D(0x1p-46) * (abs(here) + D(1.0));
  const Sample<D> beyond = field.sample(here + way * reach);
  const auto proved = found & (slope > zero) & (reach < D(0x1p-26)) & (beyond.value < -beyond.error) &
                      (reach <= (end - here) * way);
  unsure = unsure | (found & ~proved);
  return select(proved, here, D(roots::kNoRoot));
}

/// Crossings of a convex function in [a, b], as `march`.
template <int K, class Field, class D>
OKTETT_INLINE void convex_crossings(const Field& field, const D& a, const D& b,
                                    const typename D::M& active, Crossings<K, D>& out) {
  const Sample<D> at_a = field.sample(a), at_b = field.sample(b);
  const auto outside_a = active & (at_a.value > at_a.error), inside_a = active & (at_a.value < -at_a.error);
  const auto outside_b = active & (at_b.value > at_b.error), inside_b = active & (at_b.value < -at_b.error);
  auto unsure = active & ~((outside_a | inside_a) & (outside_b | inside_b));
  const D no_root(roots::kNoRoot);
  D enter = no_root, leave = no_root;
  if constexpr (K == 1) {
    // Only the first is asked for: the way out if the range begins inside.
    const auto wanted = ~unsure & (outside_a | (inside_a & outside_b));
    const D root = approach(field, select(inside_a, b, a), select(inside_a, a, b), wanted, unsure);
    enter = select(outside_a, root, no_root), leave = select(inside_a, root, no_root);
  } else {
    enter = approach(field, a, b, outside_a & ~unsure, unsure);
    const auto leaves = ~unsure & outside_b & (inside_a | (enter < no_root));
    leave = approach(field, b, a, leaves, unsure);
    // From inside or after entering there must be a way out.
    unsure = unsure | (leaves & ~(leave < no_root));
  }
  CrossingList<K, D> list(out);
  list.push(active & ~unsure & (enter < no_root), enter, D(-1.0), D(0.0));
  list.push(active & ~unsure & (leave < no_root), leave, D(1.0), D(0.0));
  list.finish(K == 1 ? out.t[0] : no_root);
  if (OKTETT_LIKELY(none(unsure))) return;
  Crossings<K, D> other;
  march<K>(field, a, b, b, unsure, Jumps::list, other);
  for (int k = 0; k < K; ++k) {
    out.t[k] = select(unsure, other.t[k], out.t[k]);
    out.turn[k] = select(unsure, other.turn[k], out.turn[k]);
    out.part[k] = select(unsure, other.part[k], out.part[k]);
  }
  out.up_to = select(unsure, other.up_to, out.up_to);
}

}  // namespace oktett::interval
