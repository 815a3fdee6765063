#include "core/math.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/eighth_turn.h"

namespace oktett::portable {

static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
static constexpr double kHalfPi = std::numbers::pi / 2;

/// Horner's scheme; `c` from the highest power down.
template <std::size_t N>
static double polynomial(const double (&c)[N], double x) {
  double sum = c[0];
  for (std::size_t i = 1; i < N; ++i) sum = sum * x + c[i];
  return sum;
}

/// 2^n for -1022 <= n <= 1023.
static double power_of_two(int n) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52);
}

double exp2(double x) {
  static constexpr double kTaylor[] = {1 / 87178291200.0,
                                       1 / 6227020800.0,
                                       1 / 479001600.0,
                                       1 / 39916800.0,
                                       1 / 3628800.0,
                                       1 / 362880.0,
                                       1 / 40320.0,
                                       1 / 5040.0,
                                       1 / 720.0,
                                       1 / 120.0,
                                       1 / 24.0,
                                       1 / 6.0,
                                       1 / 2.0,
                                       1,
                                       1};
  if (std::isnan(x)) return x;
  if (x >= 1024) return kInfinity;
  if (x <= -1076) return 0;
  const double whole = std::floor(x + 0.5);
  const int n = static_cast<int>(whole);
  const double fraction = polynomial(kTaylor, (x - whole) * std::numbers::ln2);
  // In two steps, since 2^n may be out of range although the product is not.
  return fraction * power_of_two(n / 2) * power_of_two(n - n / 2);
}

double exp(double x) { return exp2(x * std::numbers::log2e); }

/// For x > 0 and finite: x = m 2^exponent with m in [sqrt(1/2), sqrt(2)); returns ln m.
static double log_mantissa(double x, double& exponent) {
  // 2 atanh(s) / s as a series in s^2, where s = (m - 1) / (m + 1), |s| < 0.1716.
  static constexpr double kSeries[] = {2 / 23.0, 2 / 21.0, 2 / 19.0, 2 / 17.0, 2 / 15.0, 2 / 13.0,
                                       2 / 11.0, 2 / 9.0,  2 / 7.0,  2 / 5.0,  2 / 3.0,  2};
  exponent = 0;
  if (x < std::numeric_limits<double>::min()) x *= power_of_two(54), exponent = -54;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  exponent += static_cast<double>(static_cast<int>(bits >> 52) - 1023);
  if (m >= std::numbers::sqrt2) m *= 0.5, exponent += 1;
  const double s = (m - 1) / (m + 1);
  return s * polynomial(kSeries, s * s);
}

/// Logarithms of special arguments: 0, negative, infinite and NaN. False if `x` is none of these.
static bool special_log(double x, double& result) {
  if (x > 0 && x < kInfinity) return false;
  result = x == 0 ? -kInfinity : x > 0 ? x : kNan;
  return true;
}

double log2(double x) {
  double exponent;
  if (special_log(x, exponent)) return exponent;
  const double m = log_mantissa(x, exponent);
  return exponent + m * std::numbers::log2e;
}

double log(double x) {
  double exponent;
  if (special_log(x, exponent)) return exponent;
  const double m = log_mantissa(x, exponent);
  return exponent * std::numbers::ln2 + m;
}

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

double whole_power(double x, unsigned n) {
  double product = 1;
  for (; n > 1; n >>= 1, x *= x)
    if (n & 1) product *= x;
  return n == 1 ? product * x : product;
}

/// Splits x into quadrant * pi/2 + r with |r| <= pi/4; returns r.
static double reduce_angle(double x, int& quadrant) {
  // pi/2 in three parts of 33 bits: k times a part is exact for k < 2^20 (Cody and Waite 1980).
  static constexpr double kPart[] = {1.57079632673412561417e+00, 6.07710050630396597660e-11,
                                     2.02226624871116645580e-21};
  if (std::abs(x) > 1.6e6) x = std::fmod(x, 2 * std::numbers::pi);
  const double k = std::floor(x / kHalfPi + 0.5);
  quadrant = static_cast<int>(static_cast<std::int64_t>(k) & 3);
  return ((x - k * kPart[0]) - k * kPart[1]) - k * kPart[2];
}

using OneLane = Simd<double, 1, ScalarIsa>;

static double sin_taylor(double r) { return sin_of_eighth(OneLane(r)).part[0].v; }
static double cos_taylor(double r) { return cos_of_eighth(OneLane(r)).part[0].v; }

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

/// For 0 <= x <= 1.
static double atan_unit(double x) {
  static constexpr double kSeries[] = {1 / 25.0,  -1 / 23.0, 1 / 21.0,  -1 / 19.0, 1 / 17.0,
                                       -1 / 15.0, 1 / 13.0,  -1 / 11.0, 1 / 9.0,   -1 / 7.0,
                                       1 / 5.0,   -1 / 3.0,  1};
  // atan x = 2 atan(x / (1 + sqrt(1 + x^2))), twice: x falls below tan(pi/16).
  for (int i = 0; i < 2; ++i) x = x / (1 + std::sqrt(1 + x * x));
  return 4 * x * polynomial(kSeries, x * x);
}

double atan(double x) { return atan2(x, 1); }

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const double ax = std::abs(x), ay = std::abs(y);
  double angle = 0;
  if (ax == ay) {
    angle = ax == 0 ? 0 : kHalfPi / 2;
  } else {
    angle = ay < ax ? atan_unit(ay / ax) : kHalfPi - atan_unit(ax / ay);
  }
  if (std::signbit(x)) angle = std::numbers::pi - angle;
  return std::copysign(angle, y);
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
