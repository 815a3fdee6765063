#include "core/math.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/elementary.h"

namespace oktett::portable {

/// One lane.
using One = Simd<double, 1, ScalarIsa>;

static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
static constexpr double kHalfPi = std::numbers::pi / 2;

double exp2(double x) {
  if (std::isnan(x)) return x;
  if (x >= 1024) return kInfinity;
  if (x <= -1076) return 0;
  return only_lane(exp2_near<Horner>(One(x), One(std::floor(x + 0.5))));
}

double exp(double x) { return exp2(x * std::numbers::log2e); }

double log2(double x) { return only_lane(log2_by<Horner, true>(One(x))); }
double log(double x) { return only_lane(log_by<Horner, true>(One(x))); }

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNan;
  if (x >= 0) {
    if (std::isinf(y)) return x == 1 ? 1 : (x > 1) == (y > 0) ? kInfinity : 0;
    return exp2(y * log2(x));
  }
  if (std::isinf(y)) return x == -1 ? 1 : (x < -1) == (y > 0) ? kInfinity : 0;
  if (y != std::floor(y)) return std::isinf(x) ? (y > 0 ? kInfinity : 0) : kNan;
  const double magnitude = exp2(y * log2(-x));
  const bool odd = std::floor(y / 2) * 2 != y;
  return odd ? -magnitude : magnitude;
}

double whole_power(double x, unsigned n) { return n == 0 ? 1 : only_lane(pow_whole(One(x), n)); }

/// Splits x into quadrant * pi/2 + r with |r| <= pi/4; returns r.
static double reduce_angle(double x, int& quadrant) {
  if (std::abs(x) > 1.6e6) x = std::fmod(x, 2 * std::numbers::pi);
  const double k = std::floor(x / kHalfPi + 0.5);
  quadrant = static_cast<int>(static_cast<std::int64_t>(k) & 3);
  return only_lane(without_quarters(One(x), One(k)));
}

static double sin_taylor(double r) { return only_lane(sin_of_eighth(One(r))); }
static double cos_taylor(double r) { return only_lane(cos_of_eighth(One(r))); }

double sin(double x) {
  if (!std::isfinite(x)) return kNan;
  int quadrant;
  const double r = reduce_angle(x, quadrant);
  const double s = (quadrant & 1) ? cos_taylor(r) : sin_taylor(r);
  return (quadrant & 2) ? -s : s;
}

double cos(double x) {
  if (!std::isfinite(x)) return kNan;
  int quadrant;
  const double r = reduce_angle(x, quadrant);
  const double c = (quadrant & 1) ? sin_taylor(r) : cos_taylor(r);
  return quadrant == 1 || quadrant == 2 ? -c : c;
}

double tan(double x) {
  if (!std::isfinite(x)) return kNan;
  int quadrant;
  const double r = reduce_angle(x, quadrant);
  return (quadrant & 1) ? -cos_taylor(r) / sin_taylor(r) : sin_taylor(r) / cos_taylor(r);
}

double atan(double x) { return atan2(x, 1); }

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  return only_lane(atan2_lanes(One(y), One(x)));
}

double acos(double x) {
  if (!(x >= -1 && x <= 1)) return kNan;
  return 2 * atan2(std::sqrt(1 - x), std::sqrt(1 + x));
}

double asin(double x) {
  if (!(x >= -1 && x <= 1)) return kNan;
  return atan2(x, std::sqrt((1 - x) * (1 + x)));
}

}  // namespace oktett::portable
