#include "kernels/functions/expression.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>

#include "core/error.h"
#include "core/noise.h"
#include "core/precise_math.h"

namespace oktett {
namespace {

// fmin and fmax drop a NaN, which would hide a mistake in the other operand.
double min_of(double a, double b) {
  return std::isnan(a) || std::isnan(b) ? std::numeric_limits<double>::quiet_NaN() : std::min(a, b);
}
double max_of(double a, double b) {
  return std::isnan(a) || std::isnan(b) ? std::numeric_limits<double>::quiet_NaN() : std::max(a, b);
}

double sign_of(double a, double) { return a > 0 ? 1 : a < 0 ? -1 : a; }

struct Function {
  const char* name;
  ExpressionOp op;
  /// The second number is ignored by functions of one; null for those of three.
  double (*apply)(double, double);
};

constexpr Function kFunctions[] = {
    {"sqrt", ExpressionOp::sqrt, [](double a, double) { return std::sqrt(a); }},
    {"abs", ExpressionOp::abs, [](double a, double) { return std::abs(a); }},
    {"sin", ExpressionOp::sin, [](double a, double) { return precise::sin(a); }},
    {"cos", ExpressionOp::cos, [](double a, double) { return precise::cos(a); }},
    {"tan", ExpressionOp::tan, [](double a, double) { return precise::tan(a); }},
    {"asin", ExpressionOp::asin, [](double a, double) { return precise::asin(a); }},
    {"acos", ExpressionOp::acos, [](double a, double) { return precise::acos(a); }},
    {"atan", ExpressionOp::atan, [](double a, double) { return precise::atan(a); }},
    {"atan2", ExpressionOp::atan2, precise::atan2},
    {"exp", ExpressionOp::exp, [](double a, double) { return precise::exp(a); }},
    {"log", ExpressionOp::log, [](double a, double) { return precise::log(a); }},
    {"log2", ExpressionOp::log2, [](double a, double) { return precise::log2(a); }},
    {"log10", ExpressionOp::log10, [](double a, double) { return precise::log10(a); }},
    {"pow", ExpressionOp::power, precise::pow},
    {"min", ExpressionOp::min, min_of},
    {"max", ExpressionOp::max, max_of},
    {"floor", ExpressionOp::floor, [](double a, double) { return std::floor(a); }},
    {"ceil", ExpressionOp::ceil, [](double a, double) { return std::ceil(a); }},
    {"round", ExpressionOp::round, [](double a, double) { return std::round(a); }},
    {"sign", ExpressionOp::sign, sign_of},
    {"hypot", ExpressionOp::hypot, precise::hypot},
    {"noise", ExpressionOp::noise, nullptr},
    {"povray_noise", ExpressionOp::povray_noise, nullptr},
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool starts_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/// Recursive descent, one method per level of precedence; each returns the index of the node it made.
class Parser {
 public:
  Parser(std::string_view text, std::span<const std::string_view> variables)
      : text_(text), variables_(variables) {}

  Expression parse() {
    if (text_.size() > kMaxExpressionLength)
      fail(0, "the expression is longer than " + std::to_string(kMaxExpressionLength) + " bytes");
    sum();
    if (peek() != '\0' || pos_ < text_.size())
      fail(pos_, peek() == ')' ? "')' without '('" : "expected an operator or the end");
    return std::move(result_);
  }

 private:
  /// Counts a level of recursion while it lives.
  struct Level {
    Parser& parser;
    explicit Level(Parser& p) : parser(p) {
      if (++parser.depth_ > kMaxExpressionDepth)
        parser.fail(parser.pos_, "nested deeper than " + std::to_string(kMaxExpressionDepth) + " levels");
    }
    ~Level() { --parser.depth_; }
  };

  [[noreturn]] void fail(std::size_t at, const std::string& message) const {
    throw Error(Location{"", 0, static_cast<int>(at) + 1}, message);
  }

  /// The next character that is no space, or NUL at the end.
  char peek() {
    while (pos_ < text_.size() &&
           (text_[pos_] == ' ' || text_[pos_] == '\t' || text_[pos_] == '\n' || text_[pos_] == '\r'))
      ++pos_;
    return pos_ < text_.size() ? text_[pos_] : '\0';
  }

  bool accept(char c) {
    if (peek() != c) return false;
    ++pos_;
    return true;
  }

  std::uint32_t add(std::size_t place, const ExpressionNode& node) {
    result_.nodes.push_back(node);
    result_.places.push_back(static_cast<std::uint32_t>(place));
    return static_cast<std::uint32_t>(result_.nodes.size() - 1);
  }
  std::uint32_t add(std::size_t place, ExpressionOp op, std::uint32_t a, std::uint32_t b = kNoId) {
    return add(place, {op, a, b, 0});
  }

  std::uint32_t sum() { return chain('+', ExpressionOp::add, '-', ExpressionOp::subtract, &Parser::product); }
  std::uint32_t product() {
    return chain('*', ExpressionOp::multiply, '/', ExpressionOp::divide, &Parser::signed_factor);
  }
  /// Operands joined by two operators, from the left.
  std::uint32_t chain(char first, ExpressionOp first_op, char second, ExpressionOp second_op,
                      std::uint32_t (Parser::*operand)()) {
    std::uint32_t left = (this->*operand)();
    while (true) {
      const bool is_first = accept(first);
      if (!is_first && !accept(second)) return left;
      const std::size_t place = pos_ - 1;
      left = add(place, is_first ? first_op : second_op, left, (this->*operand)());
    }
  }

  std::uint32_t signed_factor() {
    const Level level(*this);
    if (accept('-')) {
      const std::size_t place = pos_ - 1;
      return add(place, ExpressionOp::negate, signed_factor());
    }
    if (accept('+')) return signed_factor();
    const std::uint32_t base = primary();
    if (!accept('^')) return base;
    const std::size_t place = pos_ - 1;
    return add(place, ExpressionOp::power, base, signed_factor());
  }

  std::uint32_t primary() {
    const char c = peek();
    if (is_digit(c) || c == '.') return number();
    if (starts_name(c)) return name();
    const std::size_t open = pos_;
    if (!accept('(')) fail(pos_, "expected a number, a name or '('");
    const std::uint32_t inside = sum();
    if (!accept(')')) fail(pos_, "expected ')' for the '(' at column " + std::to_string(open + 1));
    return inside;
  }

  std::uint32_t number() {
    double value = 0;
    const char* begin = text_.data() + pos_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error == std::errc::result_out_of_range) fail(pos_, "number out of range");
    if (error != std::errc()) fail(pos_, "expected a number, a name or '('");
    const std::size_t place = pos_;
    pos_ += static_cast<std::size_t>(end - begin);
    return add(place, {ExpressionOp::constant, kNoId, kNoId, value});
  }

  std::uint32_t name() {
    const std::size_t begin = pos_;
    while (pos_ < text_.size() && (starts_name(text_[pos_]) || is_digit(text_[pos_]))) ++pos_;
    const std::string_view word = text_.substr(begin, pos_ - begin);
    for (std::size_t i = 0; i < variables_.size(); ++i)
      if (word == variables_[i])
        return add(begin, {ExpressionOp::variable, static_cast<std::uint32_t>(i), kNoId, 0});
    if (word == "pi") return add(begin, {ExpressionOp::constant, kNoId, kNoId, std::numbers::pi});
    if (word == "e") return add(begin, {ExpressionOp::constant, kNoId, kNoId, std::numbers::e});
    for (const Function& function : kFunctions)
      if (word == function.name) return call(begin, function);
    fail(begin, "unknown name '" + std::string(word) + "'" + suggestion(word));
  }

  std::string suggestion(std::string_view word) const {
    std::vector<std::string> names = {"pi", "e"};
    for (const std::string_view v : variables_) names.emplace_back(v);
    for (const Function& f : kFunctions) names.emplace_back(f.name);
    return did_you_mean(std::string(word), names);
  }

  std::uint32_t call(std::size_t place, const Function& function) {
    const std::string what = function.name;
    if (!accept('(')) fail(pos_, "expected '(' after " + what);
    std::uint32_t value = sum();
    std::uint32_t arguments[3] = {value, kNoId, kNoId};
    int count = 1;
    const bool any_number = function.op == ExpressionOp::min || function.op == ExpressionOp::max;
    const int expected = operand_count(function.op);
    while (accept(',')) {
      if (++count > expected && !any_number) fail(pos_ - 1, what + " takes " + argument_count(expected));
      if (expected == 3)
        arguments[count - 1] = sum();
      else
        value = add(place, function.op, value, sum());
    }
    if (peek() != ')') fail(pos_, "expected ',' or ')' in the arguments of " + what);
    if (count < expected)
      fail(pos_, what + " takes " + argument_count(expected) + (any_number ? " or more" : ""));
    ++pos_;
    if (expected == 3) return add(place, {function.op, arguments[0], arguments[1], 0, arguments[2]});
    return expected == 1 ? add(place, function.op, value) : value;
  }

  static std::string argument_count(int n) {
    return n == 1 ? "1 argument" : std::to_string(n) + " arguments";
  }

  std::string_view text_;
  std::span<const std::string_view> variables_;
  Expression result_;
  std::size_t pos_ = 0;
  int depth_ = 0;
};

}  // namespace

int operand_count(ExpressionOp op) {
  using enum ExpressionOp;
  if (op == constant || op == variable) return 0;
  if (op == noise || op == povray_noise) return 3;
  const auto pairs = {add, subtract, multiply, divide, power, atan2, min, max, hypot};
  return std::find(pairs.begin(), pairs.end(), op) != pairs.end() ? 2 : 1;
}

Expression parse_expression(std::string_view text, std::span<const std::string_view> variables) {
  return Parser(text, variables).parse();
}

double apply(ExpressionOp op, double a, double b, double c) {
  switch (op) {
    case ExpressionOp::noise:
      return gradient_noise({a, b, c});
    case ExpressionOp::povray_noise:
      return noise_value({a, b, c}, NoiseKind::povray);
    case ExpressionOp::negate:
      return -a;
    case ExpressionOp::add:
      return a + b;
    case ExpressionOp::subtract:
      return a - b;
    case ExpressionOp::multiply:
      return a * b;
    case ExpressionOp::divide:
      return a / b;
    default:
      for (const Function& f : kFunctions)
        if (f.op == op) return f.apply(a, b);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double evaluate(const Expression& expression, std::span<const double> values) {
  std::vector<double> results;
  results.reserve(expression.nodes.size());
  for (const ExpressionNode& node : expression.nodes) {
    if (node.op == ExpressionOp::constant)
      results.push_back(node.value);
    else if (node.op == ExpressionOp::variable)
      results.push_back(values[node.a]);
    else
      results.push_back(apply(node.op, results[node.a], node.b == kNoId ? 0 : results[node.b],
                              node.c == kNoId ? 0 : results[node.c]));
  }
  return results.back();
}

}  // namespace oktett
