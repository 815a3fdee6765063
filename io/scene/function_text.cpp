#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "io/scene/shape_text.h"
#include "kernels/functions/expression.h"
#include "kernels/functions/tape_data.h"

namespace oktett {
namespace {

/// How a step is written: of its operands a and b, its constant c and its whole number n.
const char* pattern(TapeOp op) {
  switch (op) {
    case TapeOp::constant:
      return "({c})";
    case TapeOp::negate:
      return "(-{a})";
    case TapeOp::add:
      return "({a}+{b})";
    case TapeOp::add_constant:
      return "({a}+({c}))";
    case TapeOp::subtract:
      return "({a}-{b})";
    case TapeOp::multiply:
      return "({a}*{b})";
    case TapeOp::multiply_constant:
      return "({a}*({c}))";
    case TapeOp::divide:
      return "({a}/{b})";
    case TapeOp::square:
      return "({a}^2)";
    case TapeOp::whole_power:
      return "({a}^({n}))";
    case TapeOp::real_power:
      return "({a}^({c}))";
    case TapeOp::sqrt:
      return "sqrt({a})";
    case TapeOp::abs:
      return "abs({a})";
    case TapeOp::sin:
      return "sin({a})";
    case TapeOp::cos:
      return "cos({a})";
    case TapeOp::sin_cos:
      return "sin({a})";
    case TapeOp::tan:
      return "tan({a})";
    case TapeOp::asin:
      return "asin({a})";
    case TapeOp::acos:
      return "acos({a})";
    case TapeOp::atan:
      return "atan({a})";
    case TapeOp::atan2:
      return "atan2({a}, {b})";
    case TapeOp::exp:
      return "exp({a})";
    case TapeOp::log:
      return "log({a})";
    case TapeOp::min:
      return "min({a}, {b})";
    case TapeOp::max:
      return "max({a}, {b})";
    case TapeOp::floor:
      return "floor({a})";
    case TapeOp::ceil:
      return "ceil({a})";
    case TapeOp::round:
      return "round({a})";
    case TapeOp::sign:
      return "sign({a})";
  }
  return "";
}

}  // namespace

std::string function_text(const FunctionTape& tape) {
  std::vector<std::string> r(static_cast<std::size_t>(tape.registers));
  r[0] = "x", r[1] = "y", r[2] = "z";
  for (const TapeStep& s : tape.steps) {
    // Copies, since a result may overwrite what it is made of.
    const std::string a = r[s.a], b = r[s.b];
    r[s.out] = fmt::format(fmt::runtime(pattern(s.op)), fmt::arg("a", a), fmt::arg("b", b),
                           fmt::arg("c", number_text(s.c)), fmt::arg("n", s.n));
    if (s.op == TapeOp::sin_cos) r[s.b] = "cos(" + a + ")";
    if (r[s.out].size() > kMaxExpressionLength)
      throw Error(fmt::format("the function has more than {} characters when it is written out",
                              kMaxExpressionLength));
  }
  return r[tape.result];
}

}  // namespace oktett
