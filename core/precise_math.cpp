#include "core/precise_math.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/double_double.h"
#include "core/math.h"

namespace oktett::precise {
namespace {

using Wide = DoubleDouble;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const Wide kLn2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
const Wide kLn10{0x1.26bb1bbb55516p+1, -0x1.f48ad494ea3e9p-53};
/// Pi / 2 to 212 bits.
constexpr double kHalfPi[] = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110,
                              0x1.4cf98e804177dp-164};

Wide square_root(const Wide& a) {
  if (a.hi == 0) return a;
  const double s = std::sqrt(a.hi);
  return quick_two_sum(s, (a - two_product(s, s)).hi / (2 * s));
}

/// e^x = r 2^k for |x| < 800; returns r.
Wide exp_parts(const Wide& x, int& k) {
  constexpr int kHalvings = 9;
  k = static_cast<int>(std::floor(x.hi / kLn2.hi + 0.5));
  Wide r = x - kLn2 * Wide(k);
  r = {std::ldexp(r.hi, -kHalvings), std::ldexp(r.lo, -kHalvings)};
  // e^r - 1 by its series; (1 + s)^2 = 1 + (2 s + s^2) leads back.
  Wide s = r;
  for (int n = 9; n > 1; --n) s = r + r * s / Wide(n);
  for (int i = 0; i < kHalvings; ++i) s = s + s + s * s;
  return Wide(1) + s;
}

double exp_of(const Wide& x) {
  if (std::isnan(x.hi)) return kNan;
  if (x.hi > 710) return kInfinity;
  if (x.hi < -746) return 0;
  int k = 0;
  const Wide r = exp_parts(x, k);
  if (k > -1020) return std::ldexp(r.hi, k);
  // A denormal number, rounded once: to a whole number of the least. Where r.hi is half way, r.lo decides.
  const double steps = std::ldexp(r.hi, k + 1074), whole = std::rint(steps), rest = steps - whole;
  const bool up = rest == 0.5 && r.lo > 0, down = rest == -0.5 && r.lo < 0;
  return std::ldexp(whole + (up ? 1 : 0) - (down ? 1 : 0), -1074);
}

/// For finite x > 0.
Wide log_of(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654757) m *= 2, --exponent;
  // 2 atanh(s) = 2 s (1 + s^2 / 3 + s^4 / 5 + ...), |s| < 0.1716.
  const Wide s = two_sum(m, -1) / two_sum(m, 1), s2 = s * s;
  Wide sum = Wide(1) / Wide(45);
  for (int n = 43; n > 0; n -= 2) sum = sum * s2 + Wide(1) / Wide(n);
  return kLn2 * Wide(exponent) + s * sum * Wide(2);
}

/// 0, negative, infinite and NaN arguments of logarithms; false if `x` is none of these.
bool special_log(double x, double& result) {
  if (x > 0 && x < kInfinity) return false;
  result = x == 0 ? -kInfinity : x > 0 ? x : kNan;
  return true;
}

/// A fixed-point fraction of a quarter turn, and the number of quarter turns before it.
struct Turn {
  int quadrant;
  Wide rest;  ///< radians, at most pi / 4 in magnitude
};

/// For |x| >= 2^20, with as many digits of 2 / pi as the exponent asks for (Payne 1983).
Turn reduce_large(double x) {
  // The digits of 2 / pi before the point, which are 0, and 1280 bits behind it.
  static constexpr std::uint64_t kTwoOverPi[] = {
      0x0000000000000000, 0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041, 0xfe5163abdebbc561,
      0xb7246e3a424dd2e0, 0x06492eea09d1921c, 0xfe1deb1cb129a73e, 0xe88235f52ebb4484, 0xe99c7026b45f7e41,
      0x3991d639835339f4, 0x9c845f8bbdf9283b, 0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7,
      0x4f463f669e5fea2d, 0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab,
      0xf0cfbc209af4361d};
  int exponent = 0;
  const auto m = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::abs(x), &exponent), 53));
  exponent -= 53;
  // Bits of 2 / pi that stand for whole turns of the product do not count. The next 192 are enough.
  const int begin = exponent - 2;  // bits before this one are left out; may be negative
  const auto word_from = [](int bit) {
    // From -34 to 1097, so all words that are read are there.
    const int i = (bit + 64) / 64, shift = (bit + 64) % 64;
    return shift == 0 ? kTwoOverPi[i] : kTwoOverPi[i] << shift | kTwoOverPi[i + 1] >> (64 - shift);
  };
  __extension__ using Product = unsigned __int128;
  // m times the window, modulo 2^192: its two highest bits are the quadrant.
  std::uint64_t low = 0, middle = 0, high = 0;
  const Product p0 = Product{m} * word_from(begin + 128);
  const Product p1 = Product{m} * word_from(begin + 64) + (p0 >> 64);
  low = static_cast<std::uint64_t>(p0);
  middle = static_cast<std::uint64_t>(p1);
  high = m * word_from(begin) + static_cast<std::uint64_t>(p1 >> 64);
  int quadrant = static_cast<int>(high >> 62);
  // A fraction of at least a half is counted from the next quadrant back.
  const bool back = (high >> 61 & 1) != 0;
  if (back) {
    quadrant = (quadrant + 1) & 3;
    low = ~low, middle = ~middle, high = ~high;
  }
  high &= (std::uint64_t{1} << 62) - 1;
  Wide fraction = 0;
  const std::uint64_t words[] = {low, middle, high};
  for (int i = 0; i < 6; ++i) {
    const auto digits = static_cast<std::uint32_t>(words[i / 2] >> (i % 2 * 32));
    fraction = fraction + Wide(std::ldexp(static_cast<double>(digits), 32 * i - 190));
  }
  if (back) fraction = -fraction;
  Wide rest = fraction * Wide(kHalfPi[0], kHalfPi[1]);
  if (std::signbit(x)) {
    rest = -rest;
    quadrant = -quadrant & 3;
  }
  return {quadrant, rest};
}

Turn reduce(double x) {
  if (std::abs(x) >= 0x1p20) return reduce_large(x);
  const double k = std::floor(x / kHalfPi[0] + 0.5);
  const Wide first = two_product(k, kHalfPi[0]), second = two_product(k, kHalfPi[1]);
  // The first difference is exact: both are close together.
  const Wide rest = ((Wide(x - first.hi) - Wide(first.lo)) - second) - Wide(k * kHalfPi[2]);
  return {static_cast<int>(static_cast<std::int64_t>(k) & 3), rest};
}

/// Sine and cosine of |r| <= pi / 4 by their series.
std::pair<Wide, Wide> sin_cos(const Wide& r) {
  const Wide r2 = r * r;
  Wide s = 1, c = 1;
  for (int n = 28; n > 0; n -= 2) {
    s = Wide(1) - r2 * s / Wide(n * (n + 1));
    c = Wide(1) - r2 * c / Wide(n * (n - 1));
  }
  return {r * s, c};
}

/// Sine and cosine of any finite number.
std::pair<Wide, Wide> sin_cos_of(double x) {
  const Turn turn = reduce(x);
  const auto [s, c] = sin_cos(turn.rest);
  switch (turn.quadrant) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// The angle of (x, y), neither of them 0, infinite or NaN.
double angle(Wide y, Wide x) {
  // Tiny angles are their tangents.
  if (x.hi > 0 && std::abs(y.hi) < 0x1p-60 * x.hi) return y.hi / x.hi;
  int exponent = 0;
  std::frexp(std::max(std::abs(x.hi), std::abs(y.hi)), &exponent);
  for (Wide* const w : {&x, &y}) *w = {std::ldexp(w->hi, -exponent), std::ldexp(w->lo, -exponent)};
  // An estimate, and the angle by which it is off: its sine and tangent are the same to 106 bits.
  const double estimate = portable::atan2(y.hi, x.hi);
  const auto [s, c] = sin_cos_of(estimate);
  return (Wide(estimate) + (y * c - x * s) / (x * c + y * s)).hi;
}

}  // namespace

double exp(double x) { return exp_of(x); }

double log(double x) {
  double special;
  return special_log(x, special) ? special : log_of(x).hi;
}
double log2(double x) {
  double special;
  return special_log(x, special) ? special : (log_of(x) / kLn2).hi;
}
double log10(double x) {
  double special;
  return special_log(x, special) ? special : (log_of(x) / kLn10).hi;
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const bool whole = y == std::floor(y), odd = whole && std::abs(y) < 0x1p53 && std::floor(y / 2) * 2 != y;
  const double size = std::abs(x), sign = odd && std::signbit(x) ? -1 : 1;
  if (std::isinf(y)) return size == 1 ? 1 : (size > 1) == (y > 0) ? kInfinity : 0;
  if (size == 0 || std::isinf(size)) return sign * ((size > 0) == (y > 0) ? kInfinity : 0);
  if (x < 0 && !whole) return kNan;
  if (size == 1) return sign;
  const Wide exponent =
      std::abs(y) > 0x1p66 ? Wide((y > 0) == (size > 1) ? 1e4 : -1e4) : log_of(size) * Wide(y);
  return sign * exp_of(exponent);
}

double sin(double x) {
  if (!std::isfinite(x)) return kNan;
  return x == 0 ? x : sin_cos_of(x).first.hi;
}
double cos(double x) { return std::isfinite(x) ? sin_cos_of(x).second.hi : kNan; }
double tan(double x) {
  if (!std::isfinite(x)) return kNan;
  if (x == 0) return x;
  const auto [s, c] = sin_cos_of(x);
  return (s / c).hi;
}

double asin(double x) {
  if (!(x >= -1 && x <= 1)) return kNan;
  const Wide across = square_root(two_sum(1, -x) * two_sum(1, x));
  return x == 0 || across.hi == 0 ? portable::atan2(x, across.hi) : angle(x, across);
}
double acos(double x) {
  if (!(x >= -1 && x <= 1)) return kNan;
  const Wide across = square_root(two_sum(1, -x) * two_sum(1, x));
  return x == 0 || across.hi == 0 ? portable::atan2(across.hi, x) : angle(across, x);
}
double atan(double x) { return precise::atan2(x, 1); }
double atan2(double y, double x) {
  // Along axes and diagonals, where the angle is a part of pi.
  const bool plain = std::isfinite(x) && std::isfinite(y) && x != 0 && y != 0;
  return plain ? angle(y, x) : portable::atan2(y, x);
}

double hypot(double x, double y) {
  if (std::isinf(x) || std::isinf(y)) return kInfinity;
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const double most = std::max(std::abs(x), std::abs(y));
  if (most == 0) return 0;
  int exponent = 0;
  std::frexp(most, &exponent);
  const double a = std::ldexp(x, -exponent), b = std::ldexp(y, -exponent);
  return std::ldexp(square_root(two_product(a, a) + two_product(b, b)).hi, exponent);
}

}  // namespace oktett::precise
