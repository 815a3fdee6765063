#pragma once
/// \file Arithmetic expressions over named variables: parsed once into a flat list of nodes, evaluated as
/// often as needed.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"

namespace oktett {

/// Longest text that is parsed, in bytes.
inline constexpr std::size_t kMaxExpressionLength = 65536;
/// Deepest nesting of parentheses, calls, signs and right-hand sides of `^`; one deeper is an error.
inline constexpr int kMaxExpressionDepth = 200;

/// What a node computes from its operands `a`, `b` and `c`. Domain errors yield NaN or infinity, as in
/// <cmath>.
enum class ExpressionOp : std::uint8_t {
  constant,  ///< `value`
  variable,  ///< the variable with index `a` into the list of names the text was parsed with
  negate,
  add,
  subtract,
  multiply,
  divide,
  power,
  sqrt,
  abs,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  atan2,  ///< angle of the point (b, a), as std::atan2(a, b)
  exp,
  log,  ///< natural logarithm
  log2,
  log10,
  min,  ///< NaN if either operand is
  max,  ///< NaN if either operand is
  floor,
  ceil,
  round,  ///< halves away from zero
  sign,   ///< -1, 0 or 1; NaN for NaN
  hypot,
  noise,         ///< gradient_noise at (a, b, c), see core/noise.h
  povray_noise,  ///< the other noise of core/noise.h there
};

struct ExpressionNode {
  ExpressionOp op = ExpressionOp::constant;
  std::uint32_t a = kNoId;  ///< index of the first operand's node, or of the variable
  std::uint32_t b = kNoId;  ///< index of the second operand's node
  double value = 0;         ///< of a constant
  std::uint32_t c = kNoId;  ///< index of the third operand's node
  bool operator==(const ExpressionNode&) const = default;
};

/// A parsed expression. Operands stand before the nodes that use them; the last node is the whole. Never
/// empty.
struct Expression {
  std::vector<ExpressionNode> nodes;
  /// Per node, the byte of the text at which its operator, name or number stands.
  std::vector<std::uint32_t> places;
};

/// Number of nodes that `op` has as operands: 0, 1, 2 or 3.
int operand_count(ExpressionOp op);

/// Parses `text`: numbers, + - * / ^, parentheses, the constants pi and e, the names in `variables`, and the
/// functions sqrt abs sin cos tan asin acos atan atan2 exp log log2 log10 pow min max floor ceil round sign
/// hypot noise povray_noise (angles in radians; noises take three arguments, min and max take two or more
/// arguments). `^` binds tightest and to the right: -2^2 = -4, 2^3^2 = 512, and its exponent may have a sign.
/// A variable hides a constant of the same name. Throws Error whose `where().column` counts bytes in `text`
/// from 1; its file and line are unset.
Expression parse_expression(std::string_view text, std::span<const std::string_view> variables = {});

/// The value for `values[i]` in place of variable i.
double evaluate(const Expression& expression, std::span<const double> values = {});

/// One operation on numbers; what `evaluate` does at each node but constants and variables. Operands that an
/// operation does not have are ignored.
double apply(ExpressionOp op, double a, double b, double c = 0);

}  // namespace oktett
