#pragma once
/// \file Decimal numbers in text that is followed by zero bytes (MappedFile), independent of the locale. The
/// usual short forms are read eight digits at a time; whatever those steps cannot decide goes to
/// std::from_chars.

#include <bit>
#include <cstdint>
#include <cstring>

#include "io/text/scan.h"

namespace oktett {
namespace detail {

static_assert(std::endian::native == std::endian::little,
              "eight digits are loaded as one little-endian word");

/// Eight characters less '0', the first in the lowest byte.
inline std::uint64_t load_digits(const char* p) {
  std::uint64_t chars;
  std::memcpy(&chars, p, sizeof chars);
  return chars ^ 0x3030303030303030u;
}

/// How many of the eight, from the first on, are digits.
inline int count_digits(std::uint64_t digits) {
  const std::uint64_t others = ((digits + 0x7676767676767676u) | digits) & 0x8080808080808080u;
  return others == 0 ? 8 : std::countr_zero(others) >> 3;
}

/// The value of the first `count` digits, 1 <= count <= 8: pairs, then fours, then all eight at once.
inline std::uint64_t digits_value(std::uint64_t digits, int count) {
  digits <<= 64 - 8 * count;
  digits = digits * 10 + (digits >> 8);
  constexpr std::uint64_t mask = 0x000000ff000000ffu;
  return ((digits & mask) * 0x000f424000000064u + ((digits >> 16) & mask) * 0x0000271000000001u) >> 32;
}

inline constexpr std::uint64_t kPower10[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};
/// The powers of ten that a double holds exactly.
inline constexpr double kExactPower10[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Appends the digits at `p` to `value`, which wraps beyond 19 digits.
inline const char* scan_digits(const char* p, std::uint64_t& value) {
  for (;;) {
    const std::uint64_t digits = load_digits(p);
    const int count = count_digits(digits);
    if (count == 0) return p;
    value = value * kPower10[count] + digits_value(digits, count);
    p += count;
    if (count < 8) return p;
  }
}

/// `significand` * 10^`exponent` rounded to the nearest float, if these steps can prove which it is. The
/// double below is within two units of its last place of the true value. Rounding it once more is right
/// unless a midpoint between two floats lies as near, that is, unless the 29 bits that rounding drops are
/// close to a half.
inline bool round_to_float(std::uint64_t significand, int exponent, float& value) {
  if (exponent < -22 || exponent > 22) return false;
  const auto whole = static_cast<double>(significand);
  const double x = exponent < 0 ? whole / kExactPower10[-exponent] : whole * kExactPower10[exponent];
  if (significand != 0 && !(x >= 0x1p-126 && x < 0x1p127)) return false;
  const std::uint64_t dropped = std::bit_cast<std::uint64_t>(x) & 0x1fffffffu;
  if (dropped - 0x0ffffffcu <= 8) return false;
  value = static_cast<float>(x);
  return true;
}

}  // namespace detail

/// Why a number could not be read.
enum class NumberProblem { none, malformed, overflow };

/// Reads the float at `p`: an optional sign, then a decimal number, `inf` or `nan`, or what old Windows C
/// libraries print for these (`-1.#IND`). The value is rounded to the nearest float; numbers too small for a
/// float become 0. Returns the place behind the number, where a delimiter must stand, or null with the reason
/// in `problem`.
const char* scan_float_exactly(const char* p, float& value, NumberProblem& problem);

/// The same, fast for numbers with up to 19 digits and a small exponent.
inline const char* scan_float(const char* p, float& value, NumberProblem& problem) {
  const bool negative = *p == '-';
  const char* first = p + (negative || *p == '+' ? 1 : 0);
  std::uint64_t significand = 0;
  const char* q = detail::scan_digits(first, significand);
  std::int64_t digits = q - first;
  std::int64_t exponent = 0;
  if (*q == '.') {
    const char* fraction = q + 1;
    q = detail::scan_digits(fraction, significand);
    exponent = fraction - q;
    digits -= exponent;
  }
  if ((*q | 0x20) == 'e') {
    const bool minus = q[1] == '-';
    const char* power = q + 1 + (minus || q[1] == '+' ? 1 : 0);
    const std::uint64_t word = detail::load_digits(power);
    const int count = detail::count_digits(word);
    if (count == 0 || count == 8) return scan_float_exactly(p, value, problem);
    const auto magnitude = static_cast<std::int64_t>(detail::digits_value(word, count));
    exponent += minus ? -magnitude : magnitude;
    q = power + count;
  }
  float magnitude;
  // `1.#INF` looks like a comment behind a number.
  if (*q == '#' || digits < 1 || digits > 19 || !is_delimiter(q) ||
      !detail::round_to_float(significand, static_cast<int>(exponent), magnitude))
    return scan_float_exactly(p, value, problem);
  value = negative ? -magnitude : magnitude;
  return q;
}

/// Reads the decimal number at `p`, which scan_float has accepted, as the nearest double. Returns its end.
const char* scan_double(const char* p, double& value);

/// Reads the digits at `p` as a whole number; beyond 64 bits it stays at the greatest. Returns `p` if there
/// are none.
const char* scan_long_whole(const char* p, std::uint64_t& value);

/// The same, fast for up to seven digits.
inline const char* scan_whole(const char* p, std::uint64_t& value) {
  const std::uint64_t digits = detail::load_digits(p);
  const int count = detail::count_digits(digits);
  if (count == 0 || count == 8) return scan_long_whole(p, value);
  value = detail::digits_value(digits, count);
  return p + count;
}

}  // namespace oktett
