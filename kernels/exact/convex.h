#pragma once
/// \file Crossings of a function that is convex along the ray: at most two. Newton's method from outside
/// approaches each from its own side and never steps over it, as the tangent lies below the function.
///
/// `field.sample(t)` gives value, slope and bounds on their errors at a point. What these leave in doubt is
/// left to intervals (march.h). Why nothing is missed and nothing invented: docs/interval.md.

#include "kernels/exact/march.h"

namespace oktett::interval {

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

}  // namespace oktett::interval
