#pragma once
/// \file Operations of the SIMD layer on one register: those of xsimd batches, and those that xsimd lacks or
/// whose treatment of NaN differs between its versions. A single lane has the same operations, so that width
/// 1 is the same source.

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <xsimd/xsimd.hpp>

#include "core/platform.h"
#if defined(OKTETT_COMPILED_SSE42)
#include <immintrin.h>
#elif defined(OKTETT_COMPILED_NEON)
#include <arm_neon.h>
#endif

namespace oktett {

/// Tags that name the instruction set in every template of the hot code, so that no two sets share an
/// instantiation.
struct ScalarIsa {};
struct Sse42Isa {};
struct Avx2Isa {};
struct Avx512Isa {};
struct NeonIsa {};

/// Lanes of double for set A. SSE4.2 and NEON have registers of two: with eight lanes most
/// values would live in memory.
template <class A>
inline constexpr int kDoubleLanes = 8;
template <>
inline constexpr int kDoubleLanes<Sse42Isa> = 4;
template <>
inline constexpr int kDoubleLanes<NeonIsa> = 4;
template <>
inline constexpr int kDoubleLanes<ScalarIsa> = 1;

namespace native {

/// One lane in a general register. `A` keeps instantiations of different instruction sets apart.
template <class T, class A>
struct Lane {
  static constexpr int size = 1;
  T v;
  OKTETT_INLINE Lane() = default;
  OKTETT_INLINE Lane(T x) : v(x) {}
};

template <class T, class A>
struct LaneBool {
  bool v;
};

/// Chooses the batch type for elements T, W lanes and instruction set A. `type` has at most W lanes; several
/// are used if it has fewer.
template <class T, int W, class A>
struct Choose {
  using type = Lane<T, A>;
  using mask = LaneBool<T, A>;
};

// Each choice names the xsimd architecture of its registers.
#define OKTETT_CHOOSE(T, W, A, ARCH)         \
  template <>                                \
  struct Choose<T, W, A> {                   \
    using type = xsimd::batch<T, ARCH>;      \
    using mask = xsimd::batch_bool<T, ARCH>; \
  };
/// For lanes of 32 bits and of 64.
#define OKTETT_CHOOSE_ALL(W, A, NARROW, WIDE) \
  OKTETT_CHOOSE(float, W, A, NARROW)          \
  OKTETT_CHOOSE(std::int32_t, W, A, NARROW)   \
  OKTETT_CHOOSE(double, W, A, WIDE)

#if defined(OKTETT_COMPILED_SSE42)
OKTETT_CHOOSE_ALL(4, Sse42Isa, xsimd::sse4_2, xsimd::sse4_2)
OKTETT_CHOOSE_ALL(8, Sse42Isa, xsimd::sse4_2, xsimd::sse4_2)
OKTETT_CHOOSE_ALL(16, Sse42Isa, xsimd::sse4_2, xsimd::sse4_2)
#endif
#if defined(OKTETT_COMPILED_AVX2)
using XsimdAvx2 = xsimd::fma3<xsimd::avx2>;
OKTETT_CHOOSE_ALL(4, Avx2Isa, xsimd::sse4_2, XsimdAvx2)
OKTETT_CHOOSE_ALL(8, Avx2Isa, XsimdAvx2, XsimdAvx2)
OKTETT_CHOOSE_ALL(16, Avx2Isa, XsimdAvx2, XsimdAvx2)
#endif
#if defined(OKTETT_COMPILED_AVX512)
OKTETT_CHOOSE_ALL(4, Avx512Isa, xsimd::sse4_2, XsimdAvx2)
OKTETT_CHOOSE_ALL(8, Avx512Isa, XsimdAvx2, xsimd::avx512bw)
OKTETT_CHOOSE_ALL(16, Avx512Isa, xsimd::avx512bw, xsimd::avx512bw)
#endif
#if defined(OKTETT_COMPILED_NEON)
OKTETT_CHOOSE(double, 2, NeonIsa, xsimd::neon64)
OKTETT_CHOOSE_ALL(4, NeonIsa, xsimd::neon64, xsimd::neon64)
OKTETT_CHOOSE_ALL(8, NeonIsa, xsimd::neon64, xsimd::neon64)
OKTETT_CHOOSE_ALL(16, NeonIsa, xsimd::neon64, xsimd::neon64)
#endif
#undef OKTETT_CHOOSE_ALL
#undef OKTETT_CHOOSE

// Operations on one lane, by plain arithmetic. Each gives the same bits as the operation of the same name on
// a batch.

/// The type to compute in: whole numbers wrap around, as those of a batch do.
template <class T>
using Wrapping =
    typename std::conditional_t<std::is_integral_v<T>, std::make_unsigned<T>, std::type_identity<T>>::type;

template <class T, class A>
OKTETT_INLINE Lane<T, A> operator+(Lane<T, A> a, Lane<T, A> b) {
  return static_cast<T>(static_cast<Wrapping<T>>(a.v) + static_cast<Wrapping<T>>(b.v));
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> operator-(Lane<T, A> a, Lane<T, A> b) {
  return static_cast<T>(static_cast<Wrapping<T>>(a.v) - static_cast<Wrapping<T>>(b.v));
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> operator*(Lane<T, A> a, Lane<T, A> b) {
  return static_cast<T>(static_cast<Wrapping<T>>(a.v) * static_cast<Wrapping<T>>(b.v));
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> operator/(Lane<T, A> a, Lane<T, A> b) {
  return a.v / b.v;
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> negate(Lane<T, A> a) {
  return static_cast<T>(-static_cast<Wrapping<T>>(a.v));
}
template <class T, class A>
OKTETT_INLINE LaneBool<T, A> operator<(Lane<T, A> a, Lane<T, A> b) {
  return {a.v < b.v};
}
template <class T, class A>
OKTETT_INLINE LaneBool<T, A> operator<=(Lane<T, A> a, Lane<T, A> b) {
  return {a.v <= b.v};
}
template <class T, class A>
OKTETT_INLINE LaneBool<T, A> operator==(Lane<T, A> a, Lane<T, A> b) {
  return {a.v == b.v};
}
template <class T, class A>
OKTETT_INLINE LaneBool<T, A> operator&(LaneBool<T, A> a, LaneBool<T, A> b) {
  return {a.v && b.v};
}
template <class T, class A>
OKTETT_INLINE LaneBool<T, A> operator|(LaneBool<T, A> a, LaneBool<T, A> b) {
  return {a.v || b.v};
}
template <class T, class A>
OKTETT_INLINE LaneBool<T, A> operator~(LaneBool<T, A> a) {
  return {!a.v};
}

template <class T, class A>
OKTETT_INLINE void load(Lane<T, A>& r, const T* p) {
  r.v = *p;
}
template <class T, class A>
OKTETT_INLINE void store(T* p, Lane<T, A> a) {
  *p = a.v;
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> select(LaneBool<T, A> m, Lane<T, A> a, Lane<T, A> b) {
  return m.v ? a.v : b.v;
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> min(Lane<T, A> a, Lane<T, A> b) {
  return a.v < b.v ? a.v : b.v;
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> max(Lane<T, A> a, Lane<T, A> b) {
  return a.v > b.v ? a.v : b.v;
}
template <class T, class A>
OKTETT_INLINE Lane<T, A> abs(Lane<T, A> a) {
  return __builtin_fabs(a.v);
}
template <class A>
OKTETT_INLINE Lane<float, A> abs(Lane<float, A> a) {
  return __builtin_fabsf(a.v);
}
template <class A>
OKTETT_INLINE Lane<float, A> sqrt(Lane<float, A> a) {
  return __builtin_sqrtf(a.v);
}
template <class A>
OKTETT_INLINE Lane<double, A> sqrt(Lane<double, A> a) {
  return __builtin_sqrt(a.v);
}
template <class A>
OKTETT_INLINE Lane<float, A> flip_sign(Lane<float, A> a, Lane<float, A> s) {
  return __builtin_signbit(s.v) ? -a.v : a.v;
}
template <class T, class A>
OKTETT_INLINE unsigned bits(LaneBool<T, A> m) {
  return m.v;
}
template <class T, class A>
OKTETT_INLINE void from_bits(LaneBool<T, A>& m, unsigned b) {
  m.v = b & 1;
}

template <class A>
OKTETT_INLINE Lane<std::int32_t, A> bit_cast_int(Lane<float, A> a) {
  return std::bit_cast<std::int32_t>(a.v);
}
template <class A>
OKTETT_INLINE Lane<float, A> bit_cast_float(Lane<std::int32_t, A> a) {
  return std::bit_cast<float>(a.v);
}
template <class A>
OKTETT_INLINE Lane<std::int32_t, A> common_bits(Lane<std::int32_t, A> a, Lane<std::int32_t, A> b) {
  return a.v & b.v;
}

template <class A>
OKTETT_INLINE Lane<double, A> low_bits_to_exponent(Lane<double, A> a) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a.v) << 52);
}
template <class A>
OKTETT_INLINE Lane<double, A> biased_exponent(Lane<double, A> a) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a.v) >> 52 | 0x4330000000000000u) - 0x1p52;
}
template <class A>
OKTETT_INLINE Lane<double, A> significand(Lane<double, A> a) {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(a.v) & 0x000fffffffffffffu) |
                               0x3ff0000000000000u);
}

// Operations on xsimd batches of any instruction set. Those that differ between sets are in core/simd_x86.h
// and core/simd_neon.h.

// The IEEE operation, or addition and so on of whole numbers that wraps around. What xsimd does otherwise on
// a set has an overload for it.
template <class B>
OKTETT_INLINE B add(B a, B b) {
  return a + b;
}
template <class B>
OKTETT_INLINE B subtract(B a, B b) {
  return a - b;
}
template <class B>
OKTETT_INLINE B multiply(B a, B b) {
  return a * b;
}
template <class B>
OKTETT_INLINE B divide(B a, B b) {
  return a / b;
}
/// With the sign bit turned, zeros and NaN included: xsimd subtracts from 0 with AVX-512, which keeps +0.
template <class T, class X>
OKTETT_INLINE xsimd::batch<T, X> negate(xsimd::batch<T, X> a) {
  if constexpr (std::is_integral_v<T>)
    return subtract(xsimd::batch<T, X>(T(0)), a);
  else
    return a ^ xsimd::batch<T, X>(T(-0.0));
}
/// An estimate of 1 / a, at most 1.5 * 2^-12 off, for numbers in the middle of the range.
template <class X>
OKTETT_INLINE xsimd::batch<float, X> estimate_reciprocal(xsimd::batch<float, X> a) {
  return xsimd::reciprocal(a);
}

template <class T, class X>
OKTETT_INLINE void load(xsimd::batch<T, X>& r, const T* p) {
  r = xsimd::batch<T, X>::load_unaligned(p);
}
/// `count` elements from p on, if there are so many lanes; `rest` in the other lanes.
template <class T, class B>
OKTETT_INLINE void load_front(B& r, const T* p, int count, T rest) {
  T lanes[B::size];
  for (int i = 0; i < static_cast<int>(B::size); ++i) lanes[i] = i < count ? p[i] : rest;
  load(r, lanes);
}
template <class T, class X>
OKTETT_INLINE void store(T* p, xsimd::batch<T, X> a) {
  a.store_unaligned(p);
}
template <class T, class X>
OKTETT_INLINE xsimd::batch<T, X> select(xsimd::batch_bool<T, X> m, xsimd::batch<T, X> a,
                                        xsimd::batch<T, X> b) {
  return xsimd::select(m, a, b);
}
template <class T, class X>
OKTETT_INLINE xsimd::batch<T, X> abs(xsimd::batch<T, X> a) {
  return xsimd::abs(a);
}
template <class T, class X>
OKTETT_INLINE xsimd::batch<T, X> sqrt(xsimd::batch<T, X> a) {
  return xsimd::sqrt(a);
}

template <class X>
OKTETT_INLINE xsimd::batch<float, X> flip_sign(xsimd::batch<float, X> a, xsimd::batch<float, X> s) {
  return a ^ (s & xsimd::batch<float, X>(-0.0f));
}

template <class X>
OKTETT_INLINE xsimd::batch<std::int32_t, X> common_bits(xsimd::batch<std::int32_t, X> a,
                                                        xsimd::batch<std::int32_t, X> b) {
  return a & b;
}

// Declared here so that templates can name them; instruction sets that have them provide overloads.
template <class B>
B fma(B, B, B) = delete;
template <class B>
B fms(B, B, B) = delete;
template <class B>
B concat(B, B) = delete;
template <class B>
void set_four(B&, float, float, float, float) = delete;
template <class B>
void transpose3(B&, B&, B&) = delete;
template <class... B>
void widen(B&&...) = delete;
template <class... B>
float narrow(B&&...) = delete;
template <class A>
OKTETT_INLINE float reduce_min(Lane<float, A> a) {
  return a.v;
}

}  // namespace native
}  // namespace oktett

#if defined(OKTETT_COMPILED_SSE42)
#include "core/simd_x86.h"
#elif defined(OKTETT_COMPILED_NEON)
#include "core/simd_neon.h"
#endif
