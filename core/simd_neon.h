#pragma once
/// \file Operations on single registers of 64-bit ARM: what core/simd_x86.h is for x86, and whatever xsimd
/// does otherwise than IEEE there. Included by core/simd_native.h alone.

namespace oktett::native {

using xsimd::batch;
using xsimd::batch_bool;
using Neon = xsimd::neon64;
using NeonFloat = batch<float, Neon>;
using NeonDouble = batch<double, Neon>;
using NeonInt = batch<std::int32_t, Neon>;

// xsimd refines estimates, which leaves two of five quotients of floats off by a bit.
OKTETT_INLINE NeonFloat divide(NeonFloat a, NeonFloat b) { return vdivq_f32(a, b); }
OKTETT_INLINE NeonFloat sqrt(NeonFloat a) { return vsqrtq_f32(a); }

// Sums of signed vectors are undefined where they overflow in GCC's arm_neon.h, and comparisons behind them
// are simplified accordingly; those of unsigned vectors wrap around.
OKTETT_INLINE uint32x4_t as_unsigned(NeonInt a) { return vreinterpretq_u32_s32(a); }
OKTETT_INLINE NeonInt add(NeonInt a, NeonInt b) {
  return vreinterpretq_s32_u32(vaddq_u32(as_unsigned(a), as_unsigned(b)));
}
OKTETT_INLINE NeonInt subtract(NeonInt a, NeonInt b) {
  return vreinterpretq_s32_u32(vsubq_u32(as_unsigned(a), as_unsigned(b)));
}
OKTETT_INLINE NeonInt multiply(NeonInt a, NeonInt b) {
  return vreinterpretq_s32_u32(vmulq_u32(as_unsigned(a), as_unsigned(b)));
}
OKTETT_INLINE NeonInt negate(NeonInt a) { return subtract(NeonInt(0), a); }

// As on x86 the second operand if either is NaN or both are zeros. FMIN and FMAX would return NaN and the
// lesser zero.
OKTETT_INLINE NeonFloat min(NeonFloat a, NeonFloat b) { return vbslq_f32(vcltq_f32(a, b), a, b); }
OKTETT_INLINE NeonFloat max(NeonFloat a, NeonFloat b) { return vbslq_f32(vcgtq_f32(a, b), a, b); }
OKTETT_INLINE NeonDouble min(NeonDouble a, NeonDouble b) { return vbslq_f64(vcltq_f64(a, b), a, b); }
OKTETT_INLINE NeonDouble max(NeonDouble a, NeonDouble b) { return vbslq_f64(vcgtq_f64(a, b), a, b); }

OKTETT_INLINE NeonFloat fma(NeonFloat a, NeonFloat b, NeonFloat c) { return vfmaq_f32(c, a, b); }
OKTETT_INLINE NeonFloat fms(NeonFloat a, NeonFloat b, NeonFloat c) { return vfmaq_f32(vnegq_f32(c), a, b); }
OKTETT_INLINE NeonDouble fma(NeonDouble a, NeonDouble b, NeonDouble c) { return vfmaq_f64(c, a, b); }
OKTETT_INLINE NeonDouble fms(NeonDouble a, NeonDouble b, NeonDouble c) {
  return vfmaq_f64(vnegq_f64(c), a, b);
}

OKTETT_INLINE void set_four(NeonFloat& r, float x, float y, float z, float w) { r = float32x4_t{x, y, z, w}; }

/// 1, 2, 4, 8: lane i of a mask is bit i of a number.
OKTETT_INLINE uint32x4_t lane_weights() { return uint32x4_t{1, 2, 4, 8}; }
OKTETT_INLINE unsigned bits(batch_bool<float, Neon> m) { return vaddvq_u32(vandq_u32(m, lane_weights())); }
OKTETT_INLINE unsigned bits(batch_bool<std::int32_t, Neon> m) {
  return vaddvq_u32(vandq_u32(m, lane_weights()));
}
OKTETT_INLINE unsigned bits(batch_bool<double, Neon> m) {
  return static_cast<unsigned>(vaddvq_u64(vandq_u64(m, uint64x2_t{1, 2})));
}
OKTETT_INLINE void from_bits(batch_bool<float, Neon>& m, unsigned b) {
  m = vtstq_u32(vdupq_n_u32(b), lane_weights());
}
OKTETT_INLINE void from_bits(batch_bool<std::int32_t, Neon>& m, unsigned b) {
  m = vtstq_u32(vdupq_n_u32(b), lane_weights());
}
OKTETT_INLINE void from_bits(batch_bool<double, Neon>& m, unsigned b) {
  m = vtstq_u64(vdupq_n_u64(b), uint64x2_t{1, 2});
}

/// See Simd's transpose3.
OKTETT_INLINE void transpose3(NeonFloat& a, NeonFloat& b, NeonFloat& c) {
  const float32x4_t first = vzip1q_f32(a, b), third = vzip2q_f32(a, b), last = c;
  a = vcombine_f32(vget_low_f32(first), vget_low_f32(last));
  b = vcombine_f32(vget_high_f32(first), vget_low_f32(vextq_f32(last, last, 1)));
  c = vcombine_f32(vget_low_f32(third), vget_high_f32(last));
}

/// Four floats to two registers of two doubles, and back.
OKTETT_INLINE void widen(NeonFloat a, NeonDouble& lo, NeonDouble& hi) {
  lo = vcvt_f64_f32(vget_low_f32(a));
  hi = vcvt_high_f64_f32(a);
}
OKTETT_INLINE NeonFloat narrow(NeonDouble lo, NeonDouble hi) {
  return vcvt_high_f32_f64(vcvt_f32_f64(lo), hi);
}
/// Least lane.
OKTETT_INLINE float reduce_min(NeonFloat a) { return vminvq_f32(a); }
OKTETT_INLINE NeonFloat bit_cast_float(NeonInt a) { return vreinterpretq_f32_s32(a); }
OKTETT_INLINE NeonInt bit_cast_int(NeonFloat a) { return vreinterpretq_s32_f32(a); }

/// The processor's estimate is 2^-8 off, and 2^-16 after one step of Newton's method.
OKTETT_INLINE NeonFloat estimate_reciprocal(NeonFloat a) {
  const float32x4_t r = vrecpeq_f32(a);
  return vmulq_f32(r, vrecpsq_f32(a, r));
}

/// The lanes of a row of 32-bit numbers that `index` names, as places of their bytes for table look-ups.
OKTETT_INLINE uint8x16_t byte_places(uint32x4_t index) {
  return vreinterpretq_u8_u32(vmlaq_u32(vdupq_n_u32(0x03020100), index, vdupq_n_u32(0x04040404)));
}

OKTETT_INLINE NeonDouble low_bits_to_exponent(NeonDouble a) {
  return vreinterpretq_f64_u64(vshlq_n_u64(vreinterpretq_u64_f64(a), 52));
}
OKTETT_INLINE NeonDouble biased_exponent(NeonDouble a) {
  return vcvtq_f64_u64(vshrq_n_u64(vreinterpretq_u64_f64(a), 52));
}
OKTETT_INLINE NeonDouble significand(NeonDouble a) {
  const uint64x2_t low = vandq_u64(vreinterpretq_u64_f64(a), vdupq_n_u64(0x000fffffffffffff));
  return vreinterpretq_f64_u64(vorrq_u64(low, vdupq_n_u64(0x3ff0000000000000)));
}

}  // namespace oktett::native
