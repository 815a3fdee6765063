#include "kernels/roots/methods.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace oktett::roots {
namespace {

/// e with 2^e <= |x| < 2^(e+1), for finite x != 0.
int exponent_of(double x) {
  const int biased = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52) & 0x7ff;
  if (biased) return biased - 1023;
  const double up = x * 0x1p60;  // subnormal
  return (static_cast<int>(std::bit_cast<std::uint64_t>(up) >> 52) & 0x7ff) - 1083;
}

double power_of_two(int e) { return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52); }

/// All roots are below 2^(the result) in absolute value: |x| < 2 max |c[n-k] / c[n]|^(1/k) (M. Fujiwara,
/// Tohoku Math. J. 10, 1916).
int root_exponent(const Polynomial& p) {
  const int top = exponent_of(p.c[p.degree]);
  int bound = -2200;
  for (int k = 1; k <= p.degree; ++k) {
    if (p.c[p.degree - k] == 0) continue;
    const int ratio = exponent_of(p.c[p.degree - k]) + 1 - top;
    bound = std::max(bound, ratio > 0 ? (ratio + k - 1) / k : -(-ratio / k));
  }
  return bound + 1;
}

}  // namespace

double scale_by_power(double y, int shift) {
  // Three steps cover every sum of two exponents of doubles; all but the last are exact.
  while (shift > 1000) y *= 0x1p1000, shift -= 1000;
  while (shift < -1000) y *= 0x1p-1000, shift += 1000;
  return y * power_of_two(shift);
}

Normalized normalize(const Polynomial& p, double a, double b) {
  Normalized out;
  out.zeros = 0;
  out.shift = 0;
  int high = p.degree, low = 0;
  if (high > kMaxDegree || a != a || b != b) return out.state = Normalized::bad_input, out;
  for (int i = 0; i <= high; ++i) {
    if (!std::isfinite(p.c[i])) return out.state = Normalized::bad_input, out;
  }
  while (high >= 0 && p.c[high] == 0) --high;
  if (a > b) return out.state = Normalized::empty_interval, out;
  if (high < 0) return out.state = Normalized::zero_polynomial, out;
  while (p.c[low] == 0) ++low;
  out.zeros = low;
  out.p.degree = high - low;
  if (high == low) return out.state = Normalized::no_root, out;
  for (int i = low; i <= high; ++i) out.p.c[i - low] = p.c[i];

  // 2^shift is at least the greater end, but not more than the roots need.
  const double reach = std::max(std::abs(a), std::abs(b));
  if (reach == 0) return out.state = Normalized::no_root, out;
  int shift = std::isfinite(reach) ? exponent_of(reach) : 1100;
  if (std::isfinite(reach) && reach != power_of_two(std::max(shift, -1022))) ++shift;
  int largest = -1 << 20;
  const auto find_largest = [&] {
    largest = -1 << 20;
    for (int i = 0; i <= out.p.degree; ++i) {
      if (out.p.c[i] != 0) largest = std::max(largest, exponent_of(out.p.c[i]) + i * shift);
    }
  };
  find_largest();
  if (exponent_of(out.p.c[out.p.degree]) + out.p.degree * shift == largest || shift > 1023) {
    const int bound = root_exponent(out.p);
    if (bound < shift) {
      shift = bound;
      find_largest();
    }
  }
  const auto clip = [&](double x) { return std::clamp(scale_by_power(x, -shift), -1.0, 1.0); };
  const double end = scale_by_power(1, std::min(shift, 1023));
  if (a > end || b < -end) return out.state = Normalized::no_root, out;
  out.a = std::isfinite(a) ? clip(a) : -1;
  out.b = std::isfinite(b) ? clip(b) : 1;
  out.shift = shift;
  for (int i = 0; i <= out.p.degree; ++i) {
    out.p.c[i] = scale_by_power(out.p.c[i], i * shift - largest - 1);
  }
  return out.state = Normalized::ready, out;
}

}  // namespace oktett::roots
