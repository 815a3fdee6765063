#include "io/pov/translate/functions.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <exception>

#include "io/pov/internal_functions.h"
#include "io/pov/read_pov.h"
#include "kernels/functions/expression.h"

namespace oktett::pov {
namespace {

/// What a function is called that cannot be written.
struct Unwritable {
  std::string why;
};

std::string number_of(double value) {
  if (!std::isfinite(value)) throw Unwritable{"a number that is not finite"};
  return value < 0 ? fmt::format("({})", value) : fmt::format("{}", value);
}

/// How a function is written; {0}, {1}, ... are its operands.
struct Formula {
  std::string_view name;
  const char* text;
};
constexpr Formula kFormulas[] = {
    {"+", "({0} + {1})"},
    {"-", "({0} - {1})"},
    {"*", "({0} * {1})"},
    {"/", "({0} / {1})"},
    {"neg", "(-{0})"},
    {"!", "(1 - abs(sign({0})))"},
    {"<", "max(0, sign({1} - {0}))"},
    {">", "max(0, sign({0} - {1}))"},
    {"<=", "(1 - max(0, sign({0} - {1})))"},
    {">=", "(1 - max(0, sign({1} - {0})))"},
    {"=", "(1 - abs(sign({0} - {1})))"},
    {"!=", "abs(sign({0} - {1}))"},
    {"&", "abs(sign({0}) * sign({1}))"},
    {"|", "max(abs(sign({0})), abs(sign({1})))"},
    {"abs", "abs({0})"},
    {"sqrt", "sqrt({0})"},
    {"sqr", "({0})^2"},
    {"pow", "pow({0}, {1})"},
    {"sin", "sin({0})"},
    {"cos", "cos({0})"},
    {"tan", "tan({0})"},
    {"asin", "asin({0})"},
    {"acos", "acos({0})"},
    {"atan", "atan({0})"},
    {"atan2", "atan2({0}, {1})"},
    {"sinh", "((exp({0}) - exp(-({0}))) / 2)"},
    {"cosh", "((exp({0}) + exp(-({0}))) / 2)"},
    {"tanh", "(1 - 2 / (exp(2 * ({0})) + 1))"},
    {"asinh", "(sign({0}) * log(abs({0}) + sqrt(({0})^2 + 1)))"},
    {"acosh", "log({0} + sqrt(({0})^2 - 1))"},
    {"atanh", "(log((1 + {0}) / (1 - {0})) / 2)"},
    {"exp", "exp({0})"},
    {"ln", "log({0})"},
    {"log", "log10({0})"},
    {"floor", "floor({0})"},
    {"ceil", "ceil({0})"},
    {"int", "(sign({0}) * floor(abs({0})))"},
    {"mod", "({0} - {1} * sign({0} / {1}) * floor(abs({0} / {1})))"},
    {"div", "(sign({0} / {1}) * floor(abs({0} / {1})))"},
    {"degrees", "({0} * 180 / pi)"},
    {"radians", "({0} * pi / 180)"},
};

class Writer {
 public:
  Writer(const Function& function, std::vector<std::string> parameters, const Document& document, int depth)
      : function_(function), parameters_(std::move(parameters)), document_(document), depth_(depth) {}

  std::string text() {
    if (function_.nodes.empty()) throw Unwritable{"an empty function"};
    if (depth_ > 100) throw Unwritable{"functions nested deeper than 100 levels"};
    for (const FunctionNode& node : function_.nodes) {
      texts_.push_back(write(node));
      if (texts_.back().size() > kMaxExpressionLength - 64)
        throw Unwritable{fmt::format("more than {} characters when it is written out", kMaxExpressionLength)};
    }
    return texts_.back();
  }

 private:
  std::string write(const FunctionNode& node) {
    using Op = FunctionNode::Op;
    std::vector<std::string> operands;
    for (const std::uint32_t i : node.operands) operands.push_back(texts_.at(i));
    switch (node.op) {
      case Op::constant:
        return number_of(node.number);
      case Op::parameter:
        return parameters_.at(node.index);
      case Op::call:
        return call(node.name, operands);
      case Op::internal:
        return internal(node.index, operands);
      case Op::user:
        if (node.function == nullptr) throw Unwritable{"an unknown function"};
        operands.resize(std::max(operands.size(), node.function->parameters.size()), "0");
        return Writer(*node.function, operands, document_, depth_ + 1).text();
      case Op::spline:
        throw Unwritable{"a spline"};
      case Op::pattern:
        throw Unwritable{"a pattern"};
      case Op::transform:
        return transformed(node, operands);
    }
    throw Unwritable{"an unknown step"};
  }

  std::string internal(std::uint32_t number, const std::vector<std::string>& operands) const {
    if (number == kNoiseFunction || number == kNoiseGeneratorFunction)
      throw Unwritable{"noise (f_noise3d or f_noise_generator)"};
    if (std::optional<std::string> text = internal_text(number, operands)) return *text;
    throw Unwritable{
        fmt::format("a function of functions.inc that has no formula here ({})",
                    function_.name.empty() ? fmt::format("internal({})", number) : function_.name)};
  }

  /// A component of a place that a transform has moved.
  std::string transformed(const FunctionNode& node, const std::vector<std::string>& operands) const {
    if (node.block == nullptr || operands.size() < 3 || node.index > 2)
      throw Unwritable{"an unknown transform"};
    const Matrix matrix = evaluate_transform(*node.block, document_);
    std::string sum = number_of(matrix[3][node.index]);
    for (std::size_t i = 0; i < 3; ++i)
      if (matrix[i][node.index] != 0)
        sum += fmt::format(" + {} * {}", number_of(matrix[i][node.index]), operands[i]);
    return "(" + sum + ")";
  }

  static std::string call(std::string_view name, const std::vector<std::string>& operands) {
    for (const Formula& pattern : kFormulas)
      if (pattern.name == name) return fill(pattern.text, operands);
    if (name == "min" || name == "max") {
      if (operands.size() == 1) return operands[0];
      return fmt::format("{}({})", name, fmt::join(operands, ", "));
    }
    if (name == "if" || name == "select" || name == "?") return select(name, operands);
    throw Unwritable{fmt::format("'{}'", name)};
  }

  /// `select` asks whether its first operand is below 0, `if` whether it is not 0.
  static std::string select(std::string_view name, const std::vector<std::string>& operands) {
    if (name == "select" && operands.size() == 3)
      return fill("(max(0, -sign({0})) * {1} + (1 - max(0, -sign({0}))) * {2})", operands);
    if (name == "select" && operands.size() == 4)
      return fill("(max(0, -sign({0})) * {1} + (1 - abs(sign({0}))) * {2} + max(0, sign({0})) * {3})",
                  operands);
    return fill("(abs(sign({0})) * {1} + (1 - abs(sign({0}))) * {2})", operands);
  }

  static std::string fill(const char* text, std::vector<std::string> operands) {
    std::size_t needed = 0;
    for (const char* at = text; *at != '\0'; ++at)
      if (*at == '{' && at[1] >= '0' && at[1] <= '9')
        needed = std::max<std::size_t>(needed, static_cast<std::size_t>(at[1] - '0') + 1);
    if (operands.size() < needed) throw Unwritable{"a function with too few operands"};
    operands.resize(8);
    return fmt::format(fmt::runtime(text), operands[0], operands[1], operands[2], operands[3], operands[4],
                       operands[5], operands[6], operands[7]);
  }

  const Function& function_;
  std::vector<std::string> parameters_;
  const Document& document_;
  int depth_;
  std::vector<std::string> texts_;
};

}  // namespace

std::optional<std::string> function_text(Context& context, const Function& function, const Place& where,
                                         double threshold) {
  try {
    std::string text = Writer(function, {"x", "y", "z"}, context.document, 0).text();
    if (threshold != 0) text += fmt::format(" - {}", number_of(threshold));
    parse_expression(text, std::array<std::string_view, 3>{"x", "y", "z"});
    return text;
  } catch (const Unwritable& reason) {
    context.warn(where, "this function contains " + reason.why +
                            ", which expressions here do not have; it is left out");
  } catch (const std::exception& error) {
    context.warn(where, fmt::format("this function is no expression here: {}; it is left out", error.what()));
  }
  return std::nullopt;
}

}  // namespace oktett::pov
