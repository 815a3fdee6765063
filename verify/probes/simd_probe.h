#pragma once
/// \file Operations of core/simd.h and of sorting and compacting lanes by themselves, for each instruction
/// set, to be compared with the same arithmetic on single numbers.

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/isa.h"

namespace oktett {

/// Operations on lanes. Comparisons give 1 or 0; those of one operand ignore the second. Whole numbers have
/// neither quotients nor roots.
enum class SimdOp : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  negate,
  min,
  max,
  abs,
  sqrt,
  less,
  less_equal,
  equal
};

/// `count` operands and where the results go; T is float, double or std::int32_t.
template <class T>
struct SimdColumns {
  std::size_t count = 0;
  const T* a = nullptr;
  const T* b = nullptr;
  T* out = nullptr;
};

/// What one instruction set does. Widths other than 4, 8 and 16 are ignored; the order functions are those of
/// core/simd_order.h and core/simd_memory.h.
struct SimdProbeCode {
  void (*floats)(SimdOp op, int width, const SimdColumns<float>& run);
  void (*doubles)(SimdOp op, int width, const SimdColumns<double>& run);
  void (*ints)(SimdOp op, int width, const SimdColumns<std::int32_t>& run);
  int (*store_descending)(const float* keys, unsigned lanes, const std::uint32_t* values,
                          std::uint32_t* out_values, float* out_keys);
  /// The lanes of a LaneOrder as they are taken, and their keys; returns their number.
  int (*take_least)(const float* keys, unsigned lanes, const std::uint32_t* values, std::uint32_t* out_values,
                    std::uint32_t* out_keys);
  int (*store_compact)(unsigned lanes, const std::uint32_t* values, std::uint32_t* out);
  /// Eight indices of four bits from the bits 4 k of `words`, looked up in 16 numbers.
  void (*look_up)(const std::uint16_t* words, int k, const float* row, float* out);
  void (*load_words)(const std::uint16_t* words, unsigned flip, float* out);
};

template <class A>
const SimdProbeCode& simd_probe_code();

/// Throws Error if this build holds no code for the set.
const SimdProbeCode& simd_probe_code(Isa isa);

}  // namespace oktett
