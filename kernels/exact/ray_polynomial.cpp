#include "kernels/exact/ray_polynomial.h"

#include <cmath>

#include "kernels/roots/polynomial.h"
#include "kernels/roots/roots.h"

namespace oktett {
namespace {

/// A value, and what its terms add up to without their signs.
struct Weighed {
  double value, size;
  double certainty() const { return size > 0 ? std::abs(value) / size : 0; }
};

Weighed value_at(const roots::Polynomial& p, double x) {
  double y = 0, m = 0;
  for (int i = p.degree; i >= 0; --i) y = y * x + p.c[i], m = m * std::abs(x) + std::abs(p.c[i]);
  return {y, m};
}

}  // namespace

void find_sign_changes(const double* c, int degree, roots::Method method, int wanted, SignChanges& out) {
  roots::Polynomial p;
  p.degree = degree;
  for (int i = 0; i <= degree; ++i) p.c[i] = c[i];
  out.count = 0;
  const auto keep = [&](const roots::Roots& answer) {
    out.count = 0;
    for (int i = 0; i < answer.count && out.count < wanted; ++i)
      if (answer.root[i].multiplicity % 2 == 1) out.s[out.count++] = answer.root[i].x;
  };
  roots::Roots some = roots::solve(p, -1, 1, method, wanted);
  // A chain that has run out of digits invents and misses roots, and so does a closed form whose roots are
  // close together.
  if ((method == roots::Method::sturm || method == roots::Method::closed) && !some.certified)
    method = roots::Method::bernstein, some = roots::solve(p, -1, 1, method, wanted);
  keep(some);
  // Those that only touch took the place of others.
  if (out.count < some.count && some.count == wanted) keep(roots::solve(p, -1, 1, method));
  if (out.count == 0) return;
  // The turns follow from any one of them, or from the sign before the first.
  const Weighed before = value_at(p, -1);
  double certainty = before.certainty(), first = before.value > 0 ? -1 : 1;
  const roots::Polynomial derivative = roots::derivative(p);
  for (int i = 0; i < out.count; ++i) {
    const Weighed slope = value_at(derivative, out.s[i]);
    const double turn = slope.value < 0 ? -1 : 1;
    if (slope.certainty() > certainty) certainty = slope.certainty(), first = i % 2 == 0 ? turn : -turn;
  }
  for (int i = 0; i < out.count; ++i) out.turn[i] = i % 2 == 0 ? first : -first;
}

void PartwiseChanges::push(double place, double way) {
  if (count < kMaxRayDegree + 2) s[count] = place, turn[count++] = way;
}

void PartwiseChanges::add(const double* c, int degree, roots::Method method, double sign, double middle,
                          double half, int most) {
  SignChanges found;
  if (c != nullptr) find_sign_changes(c, degree, method, kMaxRayDegree, found);
  const double before = found.count > 0 ? -found.turn[0] : sign;
  int first = 0;
  if (first_sign == 0) {
    first_sign = before;
  } else if (before != sign_) {
    constexpr double kNear = 0x1p-30;
    const bool twice =
        count > 0 && found.count > 0 && found.s[0] < -1 + kNear && s[count - 1] > middle - half * (1 + kNear);
    if (twice)
      first = 1;
    else
      push(middle - half, before);
  }
  for (int i = first; i < found.count && count < most; ++i) push(middle + half * found.s[i], found.turn[i]);
  sign_ = found.count > 0 ? found.turn[found.count - 1] : sign;
}

}  // namespace oktett
