#pragma once
/// \file What a function tape is made of (function_tape.h).

#include <cstddef>
#include <cstdint>
#include <vector>

namespace oktett {

/// Longest tape, and how many values it may need at a time besides x, y and z.
inline constexpr std::size_t kMaxTapeSteps = 1024;
inline constexpr int kMaxTapeRegisters = 48;
/// Whole exponents up to this are powers by squaring, defined for negative numbers, too.
inline constexpr int kMaxTapePower = 256;

enum class TapeOp : std::uint8_t {
  constant,  ///< c
  negate,
  add,
  add_constant,  ///< a + c
  subtract,
  multiply,
  multiply_constant,  ///< a c
  divide,
  square,
  whole_power,  ///< a^n
  real_power,   ///< a^c, for a >= 0
  sqrt,
  abs,
  sin,
  cos,
  sin_cos,  ///< the cosine goes to the register `b`
  tan,
  asin,
  acos,
  atan,
  atan2,
  exp,
  log,
  min,
  max,
  floor,
  ceil,
  round,
  sign,
};

/// Registers 0 to 2 hold x, y and z.
struct TapeStep {
  TapeOp op = TapeOp::constant;
  std::uint8_t out = 0, a = 0, b = 0;
  int n = 0;
  double c = 0;
};

struct FunctionTape {
  std::vector<TapeStep> steps;
  std::uint8_t result = 0;  ///< the register
  int registers = 3;        ///< how many are used
  bool varies = false;      ///< whether x, y or z matter
};

}  // namespace oktett
