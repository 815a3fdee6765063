#include "kernels/roots/polynomial.h"

#include <cmath>

namespace oktett::roots {
namespace {

// Covers the roundings in computing the bound itself, for degrees up to 32.
constexpr double kRoundUp = 1 + 0x1p-40;

/// Pascal's triangle, exactly, and its reciprocals, rounded.
struct Binomials {
  double at[kMaxDegree + 1][kMaxDegree + 1] = {};
  double inverse[kMaxDegree + 1][kMaxDegree + 1] = {};
  constexpr Binomials() {
    for (int n = 0; n <= kMaxDegree; ++n) {
      double binomial = 1;
      for (int i = 0; i <= n; ++i) {
        at[n][i] = binomial;
        inverse[n][i] = 1 / binomial;
        binomial = binomial * (n - i) / (i + 1);
      }
    }
  }
};
constexpr Binomials kBinomials;

OKTETT_INLINE double over_binomial(double a, int n, int i) { return a * kBinomials.inverse[n][i]; }
OKTETT_INLINE DoubleDouble over_binomial(const DoubleDouble& a, int n, int i) {
  return a / DoubleDouble(kBinomials.at[n][i]);
}

}  // namespace

double horner(const Polynomial& p, double x) {
  double y = 0;
  for (int i = p.degree; i >= 0; --i) y = y * x + p.c[i];
  return y;
}

Value evaluate(const Polynomial& p, double x, double& slope) {
  const double ax = std::abs(x);
  double y = p.c[p.degree], m = 0.5 * std::abs(y), d = 0;
  for (int i = p.degree - 1; i >= 0; --i) {
    d = d * x + y;
    y = y * x + p.c[i];
    m = m * ax + std::abs(y);
  }
  slope = d;
  return {y, 0x1p-53 * kRoundUp * (2 * m - std::abs(y)) + kUnderflow};
}

Value evaluate_accurately(const Polynomial& p, double x) {
  DoubleDouble y = p.c[p.degree];
  double m = std::abs(y.hi);
  for (int i = p.degree - 1; i >= 0; --i) {
    y = y * DoubleDouble(x) + DoubleDouble(p.c[i]);
    // Each step adds at most one unit of its product and one of its sum.
    m = m * std::abs(x) + std::abs(y.hi);
  }
  return {y.hi, 3 * kUnit<DoubleDouble> * m + kUnderflow + 0x1p-53 * std::abs(y.hi)};
}

double absolute_sum(const Polynomial& p, double x) {
  double y = 0;
  for (int i = p.degree; i >= 0; --i) y = y * x + std::abs(p.c[i]);
  return y * kRoundUp;
}

int sign_at(const Polynomial& p, double x) {
  double slope;
  Value v = evaluate(p, x, slope);
  if (!(std::abs(v.value) > v.error)) {
    v = evaluate_accurately(p, x);
    if (!(std::abs(v.value) > v.error)) return 0;
  }
  return v.value > 0 ? 1 : -1;
}

Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  d.degree = p.degree - 1;
  for (int i = 1; i <= p.degree; ++i) d.c[i - 1] = i * p.c[i];
  return d;
}

Polynomial reflect(const Polynomial& p) {
  Polynomial q;
  q.degree = p.degree;
  for (int i = 0; i <= p.degree; ++i) q.c[i] = i % 2 ? -p.c[i] : p.c[i];
  return q;
}

template <class T>
double to_bernstein(const Polynomial& p, const T& l, const T& w, T* b) {
  const int n = p.degree;
  for (int i = 0; i <= n; ++i) b[i] = T(p.c[i]);
  if (to_double(l) != 0) {
    for (int k = 0; k < n; ++k) {
      for (int i = n - 1; i >= k; --i) b[i] = b[i] + b[i + 1] * l;
    }
  }
  T power = w;
  for (int i = 1; i <= n; ++i) {
    b[i] = over_binomial(b[i] * power, n, i);
    power = power * w;
  }
  // b[j] = sum over i of binomial(j, i) a[i], by sums of neighbours.
  for (int k = 1; k <= n; ++k) {
    for (int i = n; i >= k; --i) b[i] = b[i] + b[i - 1];
  }
  // At most 2n roundings to shift, 2n+3 to scale with a rounded w, 4 to divide, n to sum.
  const double reach = (std::abs(to_double(l)) + to_double(w)) * kRoundUp;
  return (6 * n + 12) * kUnit<T> * kRoundUp * absolute_sum(p, reach) + kUnderflow;
}

template double to_bernstein<double>(const Polynomial&, const double&, const double&, double*);
template double to_bernstein<DoubleDouble>(const Polynomial&, const DoubleDouble&, const DoubleDouble&,
                                           DoubleDouble*);

}  // namespace oktett::roots
