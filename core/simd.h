#pragma once
/// \file Vectors of W lanes for any instruction set, over xsimd: one source for widths 1, 4, 8 and 16.
///
/// All operations are exactly the IEEE operation on each lane, in every width and instruction set, whatever
/// xsimd's of the same name does there; only `fast_fma` may or may not fuse, and serves where any
/// conservative result will do. Unary minus turns the sign bit, of zeros and NaN, too. Comparisons are false
/// on NaN. `min(a, b)` is a < b ? a : b and `max(a, b)` is a > b ? a : b, hence b if either is NaN or both
/// are zeros: write the accumulator second and NaN never enters it. Whole numbers wrap around.
/// tests/core/simd_test.cpp checks each of these on awkward numbers.

#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/simd_native.h"

namespace oktett {

/// W booleans that go with lanes of T.
template <class T, int W, class A>
struct Mask {
  using B = typename native::Choose<T, W, A>::mask;
  static constexpr int kLanesPerPart = native::Choose<T, W, A>::type::size;
  static constexpr int kParts = W / kLanesPerPart;
  B part[kParts];

  OKTETT_INLINE Mask() = default;
  /// Lane i is bit i of `lanes`.
  OKTETT_INLINE static Mask from_bits(unsigned lanes) {
    Mask m;
    for (int i = 0; i < kParts; ++i) native::from_bits(m.part[i], lanes >> (i * kLanesPerPart));
    return m;
  }
  OKTETT_INLINE static Mask all_true() { return from_bits((W < 32 ? 1u << W : 0u) - 1u); }

  OKTETT_INLINE friend Mask operator&(const Mask& a, const Mask& b) {
    Mask m;
    for (int i = 0; i < kParts; ++i) m.part[i] = a.part[i] & b.part[i];
    return m;
  }
  OKTETT_INLINE friend Mask operator|(const Mask& a, const Mask& b) {
    Mask m;
    for (int i = 0; i < kParts; ++i) m.part[i] = a.part[i] | b.part[i];
    return m;
  }
  OKTETT_INLINE friend Mask operator~(const Mask& a) {
    Mask m;
    for (int i = 0; i < kParts; ++i) m.part[i] = ~a.part[i];
    return m;
  }
};

/// Bit i is lane i.
template <class T, int W, class A>
OKTETT_INLINE unsigned bits(const Mask<T, W, A>& m) {
  unsigned b = 0;
  for (int i = 0; i < m.kParts; ++i) b |= native::bits(m.part[i]) << (i * m.kLanesPerPart);
  return b;
}
template <class T, int W, class A>
OKTETT_INLINE bool any(const Mask<T, W, A>& m) {
  return bits(m) != 0;
}
template <class T, int W, class A>
OKTETT_INLINE bool none(const Mask<T, W, A>& m) {
  return bits(m) == 0;
}

/// W lanes of float, double or int32 for instruction set A.
template <class T, int W, class A>
struct Simd {
  using Element = T;
  using Isa = A;
  using M = Mask<T, W, A>;
  using B = typename native::Choose<T, W, A>::type;
  static constexpr int kWidth = W;
  static constexpr int kLanesPerPart = B::size;
  static constexpr int kParts = W / kLanesPerPart;
  B part[kParts];

  OKTETT_INLINE Simd() = default;
  OKTETT_INLINE Simd(T x) {
    for (int i = 0; i < kParts; ++i) part[i] = B(x);
  }
  /// W consecutive elements; no alignment is needed.
  OKTETT_INLINE static Simd load(const T* p) {
    Simd r;
    for (int i = 0; i < kParts; ++i) native::load(r.part[i], p + i * kLanesPerPart);
    return r;
  }
  /// `count` consecutive elements, 1 to W; the lanes behind them repeat the last.
  OKTETT_INLINE static Simd load_front(const T* p, int count) {
    Simd r;
    for (int i = 0; i < kParts; ++i)
      native::load_front(r.part[i], p + i * kLanesPerPart, count - i * kLanesPerPart, p[count - 1]);
    return r;
  }
  /// Four numbers, in this order; for W = 4.
  OKTETT_INLINE static Simd of(T x, T y, T z, T w) {
    static_assert(W == 4);
    Simd r;
    if constexpr (kParts == 1)
      native::set_four(r.part[0], x, y, z, w);
    else
      r.part[0] = x, r.part[1] = y, r.part[2] = z, r.part[3] = w;
    return r;
  }
  OKTETT_INLINE void store(T* p) const {
    for (int i = 0; i < kParts; ++i) native::store(p + i * kLanesPerPart, part[i]);
  }

  OKTETT_INLINE friend Simd operator+(const Simd& a, const Simd& b) {
    Simd r;
    for (int i = 0; i < kParts; ++i) r.part[i] = native::add(a.part[i], b.part[i]);
    return r;
  }
  OKTETT_INLINE friend Simd operator-(const Simd& a, const Simd& b) {
    Simd r;
    for (int i = 0; i < kParts; ++i) r.part[i] = native::subtract(a.part[i], b.part[i]);
    return r;
  }
  OKTETT_INLINE friend Simd operator*(const Simd& a, const Simd& b) {
    Simd r;
    for (int i = 0; i < kParts; ++i) r.part[i] = native::multiply(a.part[i], b.part[i]);
    return r;
  }
  OKTETT_INLINE friend Simd operator/(const Simd& a, const Simd& b) {
    Simd r;
    for (int i = 0; i < kParts; ++i) r.part[i] = native::divide(a.part[i], b.part[i]);
    return r;
  }
  OKTETT_INLINE friend Simd operator-(const Simd& a) {
    Simd r;
    for (int i = 0; i < kParts; ++i) r.part[i] = native::negate(a.part[i]);
    return r;
  }
  OKTETT_INLINE friend M operator<(const Simd& a, const Simd& b) {
    M m;
    for (int i = 0; i < kParts; ++i) m.part[i] = a.part[i] < b.part[i];
    return m;
  }
  OKTETT_INLINE friend M operator<=(const Simd& a, const Simd& b) {
    M m;
    for (int i = 0; i < kParts; ++i) m.part[i] = a.part[i] <= b.part[i];
    return m;
  }
  OKTETT_INLINE friend M operator>(const Simd& a, const Simd& b) { return b < a; }
  OKTETT_INLINE friend M operator>=(const Simd& a, const Simd& b) { return b <= a; }
  OKTETT_INLINE friend M operator==(const Simd& a, const Simd& b) {
    M m;
    for (int i = 0; i < kParts; ++i) m.part[i] = a.part[i] == b.part[i];
    return m;
  }
};

template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> select(const Mask<T, W, A>& m, const Simd<T, W, A>& a, const Simd<T, W, A>& b) {
  Simd<T, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::select(m.part[i], a.part[i], b.part[i]);
  return r;
}
template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> min(const Simd<T, W, A>& a, const Simd<T, W, A>& b) {
  Simd<T, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::min(a.part[i], b.part[i]);
  return r;
}
template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> max(const Simd<T, W, A>& a, const Simd<T, W, A>& b) {
  Simd<T, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::max(a.part[i], b.part[i]);
  return r;
}
template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> abs(const Simd<T, W, A>& a) {
  Simd<T, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::abs(a.part[i]);
  return r;
}
template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> sqrt(const Simd<T, W, A>& a) {
  Simd<T, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::sqrt(a.part[i]);
  return r;
}

/// `a` with its sign turned where `s` has its sign bit set.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> flip_sign(const Simd<float, W, A>& a, const Simd<float, W, A>& s) {
  Simd<float, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::flip_sign(a.part[i], s.part[i]);
  return r;
}

/// True where the instruction set has a fused multiply-add, in every width.
template <class A>
inline constexpr bool kHasFma =
    std::is_same_v<A, Avx2Isa> || std::is_same_v<A, Avx512Isa> || std::is_same_v<A, NeonIsa>;

/// a * b + c, fused where that is fast: the last bit may differ between instruction sets.
template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> fast_fma(const Simd<T, W, A>& a, const Simd<T, W, A>& b, const Simd<T, W, A>& c) {
  if constexpr (kHasFma<A> && W > 1) {
    Simd<T, W, A> r;
    for (int i = 0; i < r.kParts; ++i) r.part[i] = native::fma(a.part[i], b.part[i], c.part[i]);
    return r;
  } else {
    return a * b + c;
  }
}

/// a * b - c, like fast_fma.
template <class T, int W, class A>
OKTETT_INLINE Simd<T, W, A> fast_fms(const Simd<T, W, A>& a, const Simd<T, W, A>& b, const Simd<T, W, A>& c) {
  if constexpr (kHasFma<A> && W > 1) {
    Simd<T, W, A> r;
    for (int i = 0; i < r.kParts; ++i) r.part[i] = native::fms(a.part[i], b.part[i], c.part[i]);
    return r;
  } else {
    return a * b - c;
  }
}

/// 1 / x with a relative error of at most 2^-21: an estimate of the processor (at most 1.5 * 2^-12 off) and a
/// step of Newton's method. Where x or 1 / x is zero, infinite or denormal the result may be any
/// number. The bits differ between instruction sets.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> fast_reciprocal(const Simd<float, W, A>& x) {
  if constexpr (W == 1 || std::is_same_v<A, ScalarIsa>) {
    return Simd<float, W, A>(1.0f) / x;
  } else {
    Simd<float, W, A> r;
    for (int i = 0; i < r.kParts; ++i) r.part[i] = native::estimate_reciprocal(x.part[i]);
    return r * (Simd<float, W, A>(2.0f) - x * r);
  }
}

/// The rounding error of p = a * b, so that a * b = p + error exactly: by a fused multiply-add, or by
/// Dekker's splitting (1971) with the same result as long as nothing overflows or underflows.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> product_error(const Simd<double, W, A>& a, const Simd<double, W, A>& b,
                                               const Simd<double, W, A>& p) {
  if constexpr (kHasFma<A> && W > 1) {
    return fast_fms(a, b, p);
  } else {
    using D = Simd<double, W, A>;
    const D splitter(134217729.0);  // 2^27 + 1
    const D ca = splitter * a, cb = splitter * b;
    const D ah = ca - (ca - a), bh = cb - (cb - b);
    const D al = a - ah, bl = b - bh;
    return al * bl - (((p - ah * bh) - al * bh) - ah * bl);
  }
}

/// Rows to columns: {a0, a1, a2}, {b0, b1, b2}, {c0, c1, c2} become {a0, b0, c0}, {a1, b1, c1}, {a2, b2, c2};
/// the fourth lanes are left undefined.
template <class A>
OKTETT_INLINE void transpose3(Simd<float, 4, A>& a, Simd<float, 4, A>& b, Simd<float, 4, A>& c) {
  if constexpr (Simd<float, 4, A>::kParts == 1) {
    native::transpose3(a.part[0], b.part[0], c.part[0]);
  } else {
    std::swap(a.part[1], b.part[0]), std::swap(a.part[2], c.part[0]), std::swap(b.part[2], c.part[1]);
  }
}

/// Each lane as a double, exactly.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> to_double(const Simd<float, W, A>& a) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  D r;
  if constexpr (F::kLanesPerPart == 1) {
    for (int i = 0; i < W; ++i) r.part[i].v = a.part[i].v;
  } else if constexpr (F::kLanesPerPart == D::kLanesPerPart) {
    for (int i = 0; i < F::kParts; ++i) native::widen(a.part[i], r.part[i]);
  } else {
    for (int i = 0; i < F::kParts; ++i) native::widen(a.part[i], r.part[2 * i], r.part[2 * i + 1]);
  }
  return r;
}

/// Each lane rounded to the nearest float.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> to_float(const Simd<double, W, A>& a) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  F r;
  if constexpr (F::kLanesPerPart == 1) {
    for (int i = 0; i < W; ++i) r.part[i].v = static_cast<float>(a.part[i].v);
  } else if constexpr (F::kLanesPerPart == D::kLanesPerPart) {
    for (int i = 0; i < F::kParts; ++i) r.part[i] = native::narrow(a.part[i]);
  } else {
    for (int i = 0; i < F::kParts; ++i) r.part[i] = native::narrow(a.part[2 * i], a.part[2 * i + 1]);
  }
  return r;
}

/// `lo` followed by `hi`.
template <class T, int W, class A>
OKTETT_INLINE Simd<T, 2 * W, A> concat(const Simd<T, W, A>& lo, const Simd<T, W, A>& hi) {
  Simd<T, 2 * W, A> r;
  if constexpr (Simd<T, 2 * W, A>::kLanesPerPart == Simd<T, W, A>::kLanesPerPart) {
    for (int i = 0; i < lo.kParts; ++i) r.part[i] = lo.part[i], r.part[lo.kParts + i] = hi.part[i];
  } else {
    r.part[0] = native::concat(lo.part[0], hi.part[0]);
  }
  return r;
}

/// The same lanes as a mask of another element type.
template <class To, class From, int W, class A>
OKTETT_INLINE Mask<To, W, A> mask_cast(const Mask<From, W, A>& m) {
  return Mask<To, W, A>::from_bits(bits(m));
}

/// Least and greatest lane; which lane counts where one is NaN is not defined.
template <int W, class A>
OKTETT_INLINE float horizontal_min(const Simd<float, W, A>& a) {
  auto least = a.part[0];
  for (int i = 1; i < a.kParts; ++i) least = native::min(least, a.part[i]);
  return native::reduce_min(least);
}
template <int W, class A>
OKTETT_INLINE float horizontal_max(const Simd<float, W, A>& a) {
  return -horizontal_min(-a);
}

/// Floats as the whole numbers of their bits, and back.
template <int W, class A>
OKTETT_INLINE Simd<std::int32_t, W, A> bit_cast_int(const Simd<float, W, A>& a) {
  Simd<std::int32_t, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::bit_cast_int(a.part[i]);
  return r;
}
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> bit_cast_float(const Simd<std::int32_t, W, A>& a) {
  Simd<float, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::bit_cast_float(a.part[i]);
  return r;
}

/// The lanes in which `a` and `bits` have a bit in common.
template <int W, class A>
OKTETT_INLINE Mask<std::int32_t, W, A> has_bits(const Simd<std::int32_t, W, A>& a, std::int32_t bits) {
  using I = Simd<std::int32_t, W, A>;
  const I wanted(bits);
  I common;
  for (int i = 0; i < a.kParts; ++i) common.part[i] = native::common_bits(a.part[i], wanted.part[i]);
  return ~(common == I(0));
}

/// The next float above `a` where `direction` > 0, the next below where it is < 0, and `a` where it is 0.
/// Beyond an infinity it stays; NaN stays NaN.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> next_float(const Simd<float, W, A>& a, const Simd<float, W, A>& direction) {
  using I = Simd<std::int32_t, W, A>;
  const I zero(0), one(1), lowest(INT32_MIN), infinite(0x7f800000);
  // Numbers floats by their order, both zeros as 0; the same function leads back.
  const auto number = [&](const I& bits) { return select(bits < zero, lowest - bits, bits); };
  const I bits = bit_cast_int(a), place = number(bits), d = bit_cast_int(direction);
  const auto rises = (zero < d) & (place < infinite);
  const auto falls = (d < zero) & (lowest < d) & (-infinite < place);
  const I next = select(rises, place + one, place - one);
  return bit_cast_float(select(rises | falls, number(next), bits));
}

/// 2^n for whole n, -1022 <= n <= 1023.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> power_of_two(const Simd<double, W, A>& n) {
  const auto shifted = n + Simd<double, W, A>(0x1p52 + 1023);
  Simd<double, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::low_bits_to_exponent(shifted.part[i]);
  return r;
}

/// For finite x >= 2^-1022: x = significand 2^exponent with 1 <= significand < 2; returns the significand.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> split_exponent(const Simd<double, W, A>& x, Simd<double, W, A>& exponent) {
  Simd<double, W, A> r;
  for (int i = 0; i < r.kParts; ++i) {
    exponent.part[i] = native::biased_exponent(x.part[i]);
    r.part[i] = native::significand(x.part[i]);
  }
  exponent = exponent - Simd<double, W, A>(1023.0);
  return r;
}

}  // namespace oktett
