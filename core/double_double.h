#pragma once
/// \file Numbers of about 106 bits as sums of two doubles, by error-free transformations. No fused
/// multiply-add: the same bits on every machine. Sum and product are off by less than kUnit relatively, as
/// long as nothing overflows or underflows.
///
/// D. E. Knuth, The Art of Computer Programming 2, section 4.2.2; T. J. Dekker: A floating-point technique
/// for extending the available precision, Numer. Math. 18, 1971; bounds from M. Joldes, J.-M. Muller,
/// V. Popescu: Tight and rigorous error bounds for basic building blocks of double-word arithmetic, ACM
/// Trans. Math. Softw. 44(2), 2017.

#include "core/platform.h"

namespace oktett {

/// The number hi + lo; |lo| is at most half an ulp of hi.
struct DoubleDouble {
  double hi, lo;
  DoubleDouble() = default;
  OKTETT_INLINE DoubleDouble(double h, double l = 0) : hi(h), lo(l) {}
};

/// a + b exactly (Knuth).
OKTETT_INLINE DoubleDouble two_sum(double a, double b) {
  const double s = a + b, v = s - a;
  return {s, (a - (s - v)) + (b - v)};
}

/// a + b exactly if |a| >= |b| or a = 0 (Dekker).
OKTETT_INLINE DoubleDouble quick_two_sum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}

/// a * b exactly (Dekker, with Veltkamp's splitting); needs |a|, |b| < 2^995.
OKTETT_INLINE DoubleDouble two_product(double a, double b) {
  const double splitter = 134217729.0;  // 2^27 + 1
  const double ca = splitter * a, cb = splitter * b, p = a * b;
  const double ah = ca - (ca - a), bh = cb - (cb - b);
  const double al = a - ah, bl = b - bh;
  return {p, al * bl - (((p - ah * bh) - al * bh) - ah * bl)};
}

OKTETT_INLINE DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  DoubleDouble s = two_sum(a.hi, b.hi);
  const DoubleDouble t = two_sum(a.lo, b.lo);
  s = quick_two_sum(s.hi, s.lo + t.hi);
  return quick_two_sum(s.hi, s.lo + t.lo);
}
OKTETT_INLINE DoubleDouble operator-(const DoubleDouble& a) { return {-a.hi, -a.lo}; }
OKTETT_INLINE DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
OKTETT_INLINE DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = two_product(a.hi, b.hi);
  return quick_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
OKTETT_INLINE DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double q1 = a.hi / b.hi;
  const DoubleDouble r = a - b * q1;
  const double q2 = r.hi / b.hi;
  const DoubleDouble r2 = r - b * q2;
  return quick_two_sum(q1, q2) + DoubleDouble(r2.hi / b.hi);
}

OKTETT_INLINE double to_double(double a) { return a; }
OKTETT_INLINE double to_double(const DoubleDouble& a) { return a.hi; }

/// A bound on the relative error of one operation.
template <class T>
inline constexpr double kUnit = 0x1p-53;
template <>
inline constexpr double kUnit<DoubleDouble> = 0x1p-102;

}  // namespace oktett
