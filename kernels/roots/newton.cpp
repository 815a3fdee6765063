#include "kernels/roots/methods.h"

#include <algorithm>
#include <cmath>

namespace oktett::roots {
namespace {

/// Newton steps from `y` in (l, r), which shrinks; bisection where they do not converge. Ends when the step
/// is below the resolution or the sign is in doubt. Returns the last value and slope.
struct Iterate {
  double y;
  Value value;
  double slope;
};
Iterate newton_steps(const Polynomial& p, double y, double& l, double& r, int sign_lo) {
  Iterate at{y, {}, 0};
  double last = r - l;
  for (int i = 0; i < 100; ++i) {
    at.value = evaluate(p, at.y, at.slope);
    const double v = at.value.value;
    if (!(std::abs(v) > at.value.error)) break;
    ((v > 0) == (sign_lo > 0) ? l : r) = at.y;
    double step = v / at.slope, next = at.y - step;
    if (!(next > l && next < r && 2 * std::abs(step) <= last)) {
      next = l + 0.5 * (r - l);
      step = r - l;
    }
    last = std::abs(step);
    if (next <= l || next >= r || std::abs(next - at.y) <= 0x1p-52 * std::abs(at.y)) break;
    at.y = next;
  }
  return at;
}

/// Bounds above this fraction of the interval's greater end are improved in double-double arithmetic.
constexpr double kFineEnough = 0x1p-40;

double ulp(double x) { return 0x1p-52 * std::abs(x) + 0x1p-1000; }

/// The tightest interval x +- error that contains the root described at refine_newton, given x near it and a
/// guess of the error.
Root enclose(const Polynomial& p, double x, double error, double lo, double hi, int sign_lo) {
  for (error = std::max(error, ulp(x));; error *= 4) {
    const double l = x - error, r = x + error;
    const bool left = l <= lo || sign_at(p, l) == sign_lo, right = r >= hi || sign_at(p, r) == -sign_lo;
    if (left && right) {
      const double e = std::max(x - std::max(l, lo), std::min(r, hi) - x);
      return {x, e * (1 + 0x1p-50), 1};
    }
  }
}

/// Continues where the sign was in doubt in double. The slope in double is accurate enough for the steps.
OKTETT_NOINLINE Root refine_accurately(const Polynomial& p, Iterate at, double l, double r, int sign_lo) {
  double step = r - l;
  for (int i = 0; i < 60; ++i) {
    at.value = evaluate_accurately(p, at.y);
    const double v = at.value.value;
    if (!(std::abs(v) > at.value.error)) {
      step = 2 * at.value.error / std::abs(at.slope);
      break;
    }
    ((v > 0) == (sign_lo > 0) ? l : r) = at.y;
    if (i) evaluate(p, at.y, at.slope);
    double next = at.y - v / at.slope;
    if (i % 4 == 3 || !(next > l && next < r)) next = l + 0.5 * (r - l);
    step = std::abs(next - at.y);
    if (next <= l || next >= r) break;
    at.y = next;
    if (step <= 0x1p-36 * std::abs(next)) {
      step *= 0x1p-12;
      break;
    }
  }
  if (!(step <= r - l)) step = r - l;
  return enclose(p, at.y, step, l, r, sign_lo);
}

}  // namespace

Root refine_newton(const Polynomial& p, double lo, double hi, int sign_lo, double start) {
  double l = lo, r = hi;
  if (!(start > lo && start < hi)) start = lo + 0.5 * (hi - lo);
  Iterate at = newton_steps(p, start, l, r, sign_lo);
  double error = 2 * (std::abs(at.value.value) + at.value.error) / std::abs(at.slope);
  if (OKTETT_UNLIKELY(!(error <= kFineEnough * std::max(std::abs(lo), std::abs(hi))))) {
    return refine_accurately(p, at, l, r, sign_lo);
  }
  if (!(error <= r - l)) error = r - l;
  return enclose(p, at.y, error, l, r, sign_lo);
}

Roots solve_newton(const Normalized& n) {
  // Derivatives of p, then their roots from the lowest degree up: the roots of each are the critical points
  // of the next.
  Polynomial d[kMaxDegree];
  const int degree = n.p.degree;
  d[degree - 1] = n.p;
  for (int k = degree - 2; k >= 0; --k) d[k] = derivative(d[k + 1]);
  double critical[kMaxDegree + 2] = {n.a, n.b};
  int count = 2;
  Roots out;
  for (int k = 0; k < degree; ++k) {
    const bool last = k == degree - 1;
    double next[kMaxDegree + 2];
    int found = 0;
    next[found++] = n.a;
    double left = horner(d[k], critical[0]);
    for (int i = 0; i + 1 < count; ++i) {
      const double right = horner(d[k], critical[i + 1]);
      if (left == 0 && i == 0 && last) out.add({critical[0], ulp(critical[0]), 1});
      if (right == 0 && last) out.add({critical[i + 1], ulp(critical[i + 1]), 1});
      if ((left < 0 && right > 0) || (left > 0 && right < 0)) {
        const double lo = critical[i], hi = critical[i + 1], start = lo + (hi - lo) * (left / (left - right));
        if (last) {
          out.add(refine_newton(d[k], lo, hi, left < 0 ? -1 : 1, start));
        } else {
          double l = lo, r = hi;
          next[found++] = newton_steps(d[k], start > lo && start < hi ? start : lo + 0.5 * (hi - lo), l, r,
                                       left < 0 ? -1 : 1)
                              .y;
        }
      }
      left = right;
    }
    next[found++] = n.b;
    count = found;
    std::copy(next, next + found, critical);
  }
  return out;
}

}  // namespace oktett::roots
