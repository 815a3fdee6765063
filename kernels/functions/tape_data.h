#pragma once
/// \file Functions of x, y and z, as tapes: lists of steps over a few registers, compiled from a text.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace oktett {

/// Most steps of a tape, and most values that it needs at a time besides x, y and z.
inline constexpr std::size_t kMaxTapeSteps = 1024;
inline constexpr int kMaxTapeRegisters = 48;
/// Powers with a whole exponent of at most this magnitude are computed by squaring and defined for negative
/// numbers.
inline constexpr int kMaxTapePower = 256;

/// What a step computes from the registers a and b and the numbers c and n: OP(name, text, step) for each
/// operation. `text` is the expression as it is written, `step` the statements that compute it.
/// Powers with a real exponent are defined for a >= 0. `sin_cos` puts the cosine into the
/// register b. Of noises, n is the register of the third operand.
#define OKTETT_TAPE_OPS(OP)                                                                        \
  OP(constant, "({c})", set(out, s.c))                                                             \
  OP(negate, "(-{a})", out = -a)                                                                   \
  OP(add, "({a}+{b})", out = a + b)                                                                \
  OP(add_constant, "({a}+({c}))", out = plus(a, s.c))                                              \
  OP(subtract, "({a}-{b})", out = a - b)                                                           \
  OP(multiply, "({a}*{b})", out = a * b)                                                           \
  OP(multiply_constant, "({a}*({c}))", out = times(a, s.c))                                        \
  OP(divide, "({a}/{b})", out = a / b)                                                             \
  OP(square, "({a}^2)", out = sqr(a))                                                              \
  OP(whole_power, "({a}^({n}))", out = pow(a, s.n))                                                \
  OP(real_power, "({a}^({c}))", out = pow(a, s.c))                                                 \
  OP(sqrt, "sqrt({a})", out = sqrt(a))                                                             \
  OP(abs, "abs({a})", out = abs(a))                                                                \
  OP(sin, "sin({a})", out = sin(a))                                                                \
  OP(cos, "cos({a})", out = cos(a))                                                                \
  OP(sin_cos, "sin({a})", T sine; T cosine; sin_cos(a, sine, cosine); out = sine; r[s.b] = cosine) \
  OP(tan, "tan({a})", out = tan(a))                                                                \
  OP(asin, "asin({a})", out = asin(a))                                                             \
  OP(acos, "acos({a})", out = acos(a))                                                             \
  OP(atan, "atan({a})", out = atan(a))                                                             \
  OP(atan2, "atan2({a}, {b})", out = atan2(a, b))                                                  \
  OP(exp, "exp({a})", out = exp(a))                                                                \
  OP(log, "log({a})", out = log(a))                                                                \
  OP(min, "min({a}, {b})", out = min(a, b))                                                        \
  OP(max, "max({a}, {b})", out = max(a, b))                                                        \
  OP(floor, "floor({a})", out = floor(a))                                                          \
  OP(ceil, "ceil({a})", out = ceil(a))                                                             \
  OP(round, "round({a})", out = round(a))                                                          \
  OP(sign, "sign({a})", out = sign(a))                                                             \
  OP(noise, "noise({a}, {b}, {third})", out = noise(a, b, r[s.n], NoiseKind::gradient))            \
  OP(povray_noise, "povray_noise({a}, {b}, {third})", out = noise(a, b, r[s.n], NoiseKind::povray))
enum class TapeOp : std::uint8_t {
#define OP(name, text, step) name,
  OKTETT_TAPE_OPS(OP)
#undef OP
};

/// One step: register `out` becomes the result. Registers 0 to 2 hold x, y and z.
struct TapeStep {
  TapeOp op = TapeOp::constant;
  std::uint8_t out = 0, a = 0, b = 0;
  int n = 0;
  double c = 0;
};

/// Whether an operation has three operands.
constexpr bool has_third(TapeOp op) { return op == TapeOp::noise || op == TapeOp::povray_noise; }

/// Whether the step reads the register.
inline bool reads(const TapeStep& step, std::uint8_t reg) {
  if (step.op == TapeOp::constant) return false;
  return step.a == reg || (step.b == reg && step.op != TapeOp::sin_cos) ||
         (has_third(step.op) && step.n == reg);
}

/// A function as its steps in order. compile_function makes one.
struct FunctionTape {
  std::vector<TapeStep> steps;
  std::uint8_t result = 0;  ///< the register that holds the value after the last step
  int registers = 3;        ///< how many are used
  bool varies = false;      ///< whether the value depends on x, y or z
};

/// The names of the variables of a function in space, and of one on a surface.
inline constexpr std::string_view kSpaceVariables[] = {"x", "y", "z"};
inline constexpr std::string_view kSurfaceVariables[] = {"u", "v"};

/// Compiles a text: numbers, + - * / ^, parentheses, up to three variables, the constants pi and e, and
/// the functions sqrt abs sin cos tan asin acos atan atan2 exp log log2 log10 pow min max floor ceil round
/// sign hypot (angles in radians) and noise(a, b, c) and povray_noise(a, b, c),
/// Perlin's noise and POV-Ray's. Constants are rounded
/// to double. a^b, where b is no constant, is exp(b log a); it and powers with an exponent that is not whole,
/// or greater than kMaxTapePower, are defined for a >= 0 only.
///
/// Throws Error if the text cannot be read, holds a constant without a finite value, such as 1/0, or is too
/// long. Error::where().column counts bytes in `text` from 1.
FunctionTape compile_function(std::string_view text,
                              std::span<const std::string_view> variables = kSpaceVariables);

/// The function at one point (of u, v and 0 for one on a surface); NaN where it is not defined. Code for many
/// points runs the tape in lanes instead.
double value_at(const FunctionTape& tape, double x, double y, double z);

}  // namespace oktett
