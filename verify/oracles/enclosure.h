#pragma once
/// \file Intervals that hold all values of a function over a box, for oracles that know of whole stretches of
/// a ray.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "core/vec3.h"

namespace oktett {

/// All numbers from `lo` to `hi`, which may be infinite. Functions of enclosures hold all values of the exact
/// function of what they hold: each bound is moved outwards by more than rounding does. What is not defined,
/// or not a number, becomes the enclosure of all numbers.
struct Enclosure {
  double lo = 0, hi = 0;

  Enclosure() = default;
  /// The number itself, or its neighbours if it is no double.
  template <class T>
  requires std::is_arithmetic_v<T> Enclosure(T x) : lo(static_cast<double>(x)), hi(lo) {
    if (static_cast<T>(lo) != x) *this = outwards(lo, hi);
  }

  static Enclosure all() { return exactly(-HUGE_VAL, HUGE_VAL); }
  /// From a to b or from b to a.
  static Enclosure between(double a, double b) { return exactly(std::min(a, b), std::max(a, b)); }
  /// What computed bounds stand for.
  static Enclosure outwards(double lo, double hi) {
    if (!(lo <= hi)) return all();
    return exactly(lo * (lo < 0 ? 1 + kRounding : 1 - kRounding) - kTiny,
                   hi * (hi < 0 ? 1 - kRounding : 1 + kRounding) + kTiny);
  }
  /// Grown by `room` to both sides.
  Enclosure with_room(double room) const { return exactly(lo - room, hi + room); }

  bool positive() const { return lo > 0; }
  bool negative() const { return hi < 0; }

  friend Enclosure operator-(const Enclosure& a) { return exactly(-a.hi, -a.lo); }
  friend Enclosure operator+(const Enclosure& a, const Enclosure& b) {
    return outwards(a.lo + b.lo, a.hi + b.hi);
  }
  friend Enclosure operator-(const Enclosure& a, const Enclosure& b) { return a + -b; }
  friend Enclosure operator*(const Enclosure& a, const Enclosure& b) {
    const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    if (std::isnan(p + q + r + s)) return all();
    return outwards(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
  }
  friend Enclosure operator/(const Enclosure& a, const Enclosure& b) {
    if (!(b.lo > 0 || b.hi < 0)) return all();
    return a * outwards(1 / b.hi, 1 / b.lo);
  }
  Enclosure& operator+=(const Enclosure& b) { return *this = *this + b; }
  Enclosure& operator-=(const Enclosure& b) { return *this = *this - b; }

  friend Enclosure min(const Enclosure& a, const Enclosure& b) {
    return exactly(std::min(a.lo, b.lo), std::min(a.hi, b.hi));
  }
  friend Enclosure max(const Enclosure& a, const Enclosure& b) {
    return exactly(std::max(a.lo, b.lo), std::max(a.hi, b.hi));
  }
  friend Enclosure abs(const Enclosure& a) {
    return a.lo >= 0 ? a : a.hi <= 0 ? -a : exactly(0, std::max(-a.lo, a.hi));
  }
  friend Enclosure square(const Enclosure& a) {
    const Enclosure b = abs(a);
    return outwards(b.lo * b.lo, b.hi * b.hi);
  }
  friend Enclosure sqrt(const Enclosure& a) {
    return of_rising(a, 0, [](double x) { return std::sqrt(x); });
  }
  friend Enclosure exp(const Enclosure& a) {
    return of_rising(a, -HUGE_VAL, [](double x) { return std::exp(x); });
  }
  friend Enclosure log(const Enclosure& a) {
    return of_rising(a, 0, [](double x) { return std::log(x); });
  }
  /// Of numbers that are not negative, to a positive power.
  friend Enclosure pow(const Enclosure& a, double p) {
    return of_rising(a, 0, [p](double x) { return std::pow(x, p); });
  }
  friend Enclosure sin(const Enclosure& a) {
    // It turns at pi (k + 1/2).
    constexpr double kRoom = 1e-9;
    const double before = std::floor(a.lo / std::numbers::pi - 0.5 - kRoom),
                 last = std::floor(a.hi / std::numbers::pi - 0.5 + kRoom);
    if (!(last - before < 2)) return exactly(-1, 1);
    Enclosure b = between(std::sin(a.lo), std::sin(a.hi));
    if (last > before) b = std::fmod(last, 2) == 0 ? exactly(b.lo, 1) : exactly(-1, b.hi);
    return outwards(b.lo, b.hi);
  }
  friend Enclosure cos(const Enclosure& a) { return sin(a + std::numbers::pi_v<long double> / 2); }

  /// Of a function that rises from `least` on and is not defined before; off by a few roundings.
  template <class F>
  static Enclosure of_rising(const Enclosure& a, double least, const F& f) {
    // Sums of squares of zeros are widened, too.
    return a.lo >= least - kSlip ? outwards(f(std::max(a.lo, least)), f(a.hi)) : all();
  }

 private:
  static Enclosure exactly(double lo, double hi) {
    Enclosure e;
    e.lo = lo, e.hi = hi;
    return e;
  }
  static constexpr double kRounding = 0x1p-50, kTiny = 1e-300, kSlip = 1e-290;
};

/// The box about two points that are rounded, and about what is between them.
inline Vec3<Enclosure> box_about(const Vec3d& a, const Vec3d& b) {
  Vec3<Enclosure> box;
  for (int k = 0; k < 3; ++k)
    box[k] = Enclosure::between(a[k], b[k]).with_room(1e-15 * (std::abs(a[k]) + std::abs(b[k])) + 1e-18);
  return box;
}

}  // namespace oktett
