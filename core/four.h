#pragma once
/// \file Four floats side by side for code that is compiled once, for the baseline.
///
/// Made from the compiler's vectors, which exist on all targets and give the same bits as floats alone. They
/// have the names of Simd<float, 4, A>, so that templates take either. Code per instruction set uses
/// core/simd.h.

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/platform.h"
#if defined(OKTETT_COMPILED_NEON)
#include <arm_neon.h>
#endif

namespace oktett {

/// True or false in each of four lanes.
struct FourMask {
  using Lanes = std::int32_t __attribute__((vector_size(16)));
  Lanes lanes;  ///< 0 or -1

  OKTETT_INLINE friend FourMask operator&(const FourMask& a, const FourMask& b) {
    return {a.lanes & b.lanes};
  }
  OKTETT_INLINE friend FourMask operator|(const FourMask& a, const FourMask& b) {
    return {a.lanes | b.lanes};
  }
  OKTETT_INLINE friend FourMask operator~(const FourMask& a) { return {~a.lanes}; }
};

OKTETT_INLINE bool any(const FourMask& m) { return (m.lanes[0] | m.lanes[1] | m.lanes[2] | m.lanes[3]) != 0; }
/// Bit k for lane k.
OKTETT_INLINE unsigned bits(const FourMask& m) {
#if defined(__SSE__)
  float __attribute__((vector_size(16))) signs;
  std::memcpy(&signs, &m.lanes, sizeof(signs));
  return static_cast<unsigned>(__builtin_ia32_movmskps(signs));
#elif defined(OKTETT_COMPILED_NEON)
  return vaddvq_u32(vandq_u32(vreinterpretq_u32_s32(m.lanes), uint32x4_t{1, 2, 4, 8}));
#else
  return (m.lanes[0] & 1) | (m.lanes[1] & 2) | (m.lanes[2] & 4) | (m.lanes[3] & 8);
#endif
}

struct Four {
  static constexpr int kWidth = 4;
  using Lanes = float __attribute__((vector_size(16)));
  using M = FourMask;
  Lanes lanes;

  OKTETT_INLINE Four() = default;
  OKTETT_INLINE Four(Lanes v) : lanes(v) {}
  OKTETT_INLINE Four(float x) : lanes{x, x, x, x} {}
  OKTETT_INLINE static Four load(const float* p) {
    Four v;
    std::memcpy(&v.lanes, p, sizeof(v.lanes));
    return v;
  }
  OKTETT_INLINE void store(float* p) const { std::memcpy(p, &lanes, sizeof(lanes)); }

  OKTETT_INLINE friend Four operator+(const Four& a, const Four& b) { return a.lanes + b.lanes; }
  OKTETT_INLINE friend Four operator-(const Four& a, const Four& b) { return a.lanes - b.lanes; }
  OKTETT_INLINE friend Four operator*(const Four& a, const Four& b) { return a.lanes * b.lanes; }
  OKTETT_INLINE friend Four operator/(const Four& a, const Four& b) { return a.lanes / b.lanes; }
  OKTETT_INLINE friend Four operator-(const Four& a) { return -a.lanes; }
  OKTETT_INLINE friend M operator<(const Four& a, const Four& b) { return {a.lanes < b.lanes}; }
  OKTETT_INLINE friend M operator>(const Four& a, const Four& b) { return {a.lanes > b.lanes}; }
  OKTETT_INLINE friend M operator<=(const Four& a, const Four& b) { return {a.lanes <= b.lanes}; }
};

OKTETT_INLINE Four select(const FourMask& m, const Four& a, const Four& b) {
  return m.lanes ? a.lanes : b.lanes;
}
/// The lesser and the greater lane by lane; the second where either is NaN.
OKTETT_INLINE Four min(const Four& a, const Four& b) { return select(a < b, a, b); }
OKTETT_INLINE Four max(const Four& a, const Four& b) { return select(a > b, a, b); }
OKTETT_INLINE Four abs(const Four& a) {
  constexpr std::int32_t kBits = 0x7fffffff;
  const FourMask::Lanes all{kBits, kBits, kBits, kBits};
  FourMask::Lanes bits;
  std::memcpy(&bits, &a.lanes, sizeof(bits));
  bits &= all;
  Four v;
  std::memcpy(&v.lanes, &bits, sizeof(bits));
  return v;
}
/// Correctly rounded.
OKTETT_INLINE Four sqrt(const Four& a) {
#if defined(__SSE__)
  return __builtin_ia32_sqrtps(a.lanes);
#elif defined(OKTETT_COMPILED_NEON)
  return Four(vsqrtq_f32(a.lanes));
#else
  return Four::Lanes{std::sqrt(a.lanes[0]), std::sqrt(a.lanes[1]), std::sqrt(a.lanes[2]),
                     std::sqrt(a.lanes[3])};
#endif
}

}  // namespace oktett
