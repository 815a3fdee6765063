#pragma once
/// \file Tools for tests of Bsdf: facets, integrals over directions and the chi-squared test.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "core/vec3.h"

namespace oktett {

/// The direction at the cosine `mu` to z and the azimuth `phi`.
inline Vec3f direction_at(double mu, double phi) {
  const double sine = std::sqrt(1 - mu * mu);
  return {static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
          static_cast<float>(mu)};
}

/// GGX as in Walter 2007, in terms of angles, unlike the code.
inline double walter_density(double cosine, double alpha) {
  const double angle = std::acos(std::min(cosine, 1.0)), t = std::tan(angle) / alpha;
  return 1 / (std::numbers::pi * alpha * alpha * std::pow(std::cos(angle), 4) * (1 + t * t) * (1 + t * t));
}
inline double lambda(double cosine, double alpha) {
  const double t = alpha * std::tan(std::acos(cosine));
  return (std::sqrt(1 + t * t) - 1) / 2;
}

/// Where light goes through a facet that is seen well from `wo`: nearly all of them if they are narrow.
inline Vec3d refracted_by_facets(const Vec3d& wo, double roughness, double eta) {
  const double alpha2 = std::pow(roughness, 4);
  const Vec3d m = normalize(Vec3d{alpha2 * wo.x, alpha2 * wo.y, wo.z});
  const double c = dot(wo, m), behind = std::sqrt(std::max(0.0, 1 - (1 - c * c) / (eta * eta)));
  const Vec3d wi = m * (c / eta - behind) - wo * (1 / eta);
  return {wi.x, wi.y, std::min(wi.z, -1e-3)};
}

/// Polar coordinates about an axis: the unit square maps to the half of the sphere, above or below z = 0,
/// that the axis points to. A direction is (angle to the axis, azimuth) = (A s^4, 2 pi t), where A is the
/// angle at which that azimuth meets z = 0. So the square is dense at the axis and ends at the horizon.
class PolarSquare {
 public:
  explicit PolarSquare(const Vec3d& axis) : axis_(normalize(axis)) {
    make_basis(axis_, tangent_, bitangent_);
  }

  Vec3d direction(double s, double t) const {
    const Vec3d outward = outward_at(t);
    const double angle = horizon(outward) * s * s * s * s;
    return outward * std::sin(angle) + axis_ * std::cos(angle);
  }
  /// Solid angle per area of the square.
  double density(double s, double t) const {
    const double most = horizon(outward_at(t));
    return std::sin(most * s * s * s * s) * most * 4 * s * s * s * 2 * std::numbers::pi;
  }
  void square(const Vec3d& w, double& s, double& t) const {
    const double x = dot(w, tangent_), y = dot(w, bitangent_), z = dot(w, axis_);
    t = std::atan2(y, x) / (2 * std::numbers::pi);
    if (t < 0) t += 1;
    s = std::sqrt(std::sqrt(std::atan2(std::sqrt(x * x + y * y), z) / horizon(outward_at(t))));
  }

 private:
  Vec3d outward_at(double t) const {
    const double phi = 2 * std::numbers::pi * t;
    return tangent_ * std::cos(phi) + bitangent_ * std::sin(phi);
  }
  double horizon(const Vec3d& outward) const {
    return axis_.z > 0 ? std::atan2(axis_.z, -outward.z) : std::atan2(-axis_.z, outward.z);
  }

  Vec3d axis_, tangent_, bitangent_;
};

/// The integral of `f(s, t)` over a rectangle, by Gauss's rule of 3 x 3 points on cells that are split until
/// their quarters agree with them.
template <class F>
double integral(F&& f, double s0, double s1, double t0, double t1, double tolerance, int depth = 8) {
  const auto rule = [&](double a, double b, double c, double d) {
    static constexpr double kPoint[] = {0.1127016653792583, 0.5, 0.8872983346207417};
    static constexpr double kWeight[] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        sum += kWeight[i] * kWeight[j] * f(a + (b - a) * kPoint[i], c + (d - c) * kPoint[j]);
    return sum * (b - a) * (d - c);
  };
  const auto refine = [&](auto&& self, double a, double b, double c, double d, double whole,
                          int left) -> double {
    const double p = (a + b) / 2, q = (c + d) / 2;
    const double part[] = {rule(a, p, c, q), rule(p, b, c, q), rule(a, p, q, d), rule(p, b, q, d)};
    const double sum = part[0] + part[1] + part[2] + part[3];
    if (left == 0 || std::abs(sum - whole) <= tolerance) return sum;
    return self(self, a, p, c, q, part[0], left - 1) + self(self, p, b, c, q, part[1], left - 1) +
           self(self, a, p, q, d, part[2], left - 1) + self(self, p, b, q, d, part[3], left - 1);
  };
  return refine(refine, s0, s1, t0, t1, rule(s0, s1, t0, t1), depth);
}

/// The probability that a sum of squares of `n` standard normal numbers exceeds `chi2`: the regularised
/// incomplete gamma function Q(n / 2, chi2 / 2), by its series and its continued fraction.
inline double chi2_survival(double chi2, double n) {
  const double a = n / 2, x = chi2 / 2;
  if (x <= 0) return 1;
  const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int i = 1; i < 2000; ++i) sum += term *= x / (a + i);
    return 1 - sum * front;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int i = 1; i < 2000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b), c = b + an / c;
    h *= d * c;
  }
  return front * h;
}

/// The probability of counts at least as far from those expected. Bins that expect fewer than 5 are pooled.
inline double chi2_probability(const std::vector<double>& expected, const std::vector<double>& counted) {
  double chi2 = 0, few_expected = 0, few_counted = 0;
  int bins = 0;
  const auto add = [&](double e, double n) { chi2 += (n - e) * (n - e) / e, ++bins; };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] >= 5) {
      add(expected[i], counted[i]);
    } else {
      few_expected += expected[i], few_counted += counted[i];
    }
  }
  if (few_expected >= 1 || few_counted > 5) add(std::max(few_expected, 0.1), few_counted);
  return bins < 2 ? 1 : chi2_survival(chi2, bins - 1);
}

}  // namespace oktett
