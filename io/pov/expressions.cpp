#include <algorithm>
#include <cmath>

#include "io/pov/evaluate.h"
#include "io/pov/interpreter.h"
#include "io/pov/numeric.h"

namespace oktett::pov {
namespace {

bool starts_color(Keyword keyword) {
  switch (keyword) {
    case "color"_kw:
    case "colour"_kw:
    case "rgb"_kw:
    case "rgbf"_kw:
    case "rgbt"_kw:
    case "rgbft"_kw:
    case "srgb"_kw:
    case "srgbf"_kw:
    case "srgbt"_kw:
    case "srgbft"_kw:
    case "red"_kw:
    case "green"_kw:
    case "blue"_kw:
      return true;
    default:
      return false;
  }
}

/// From the curve of sRGB to linear.
double decoded(double x) {
  if (x <= 0.04045) return x / 12.92;
  return std::pow((x + 0.055) / 1.055, 2.4);
}

}  // namespace

bool is_color_keyword(Keyword keyword) { return starts_color(keyword); }

double Interpreter::to_float(const Numbers& value, const Place& where) const {
  if (value.size != 1)
    fail(where, value.is_color ? "expected a number, found a colour" : "expected a number, found a vector");
  return value.v[0];
}

double Interpreter::parse_float() {
  const Place where = peek().where;
  return to_float(parse_sum(), where);
}

std::array<double, 3> Interpreter::parse_point() {
  const Numbers value = parse_sum();
  if (value.size == 1) return {value.v[0], value.v[0], value.v[0]};
  return {value.v[0], value.v[1], value.v[2]};
}

/// `condition ? this : that`; both are computed.
Numbers Interpreter::parse_relation() {
  const Place where = peek().where;
  const Numbers value = parse_logic();
  if (ends_expression() && *at_.p != '<' && *at_.p != '>') return value;
  if (!take_if('?')) return value;
  const Level level(*this, where);
  const bool holds = to_float(value, where) != 0;
  const Numbers chosen = parse_relation();
  expect(':', "behind the first value of '?'");
  const Numbers other = parse_relation();
  return holds ? chosen : other;
}

/// The string that stands next, if one does. A name that stands for something else becomes the next term.
std::optional<std::string> Interpreter::take_string() {
  if (term_) return std::nullopt;
  const Token& next = peek();
  if (next.kind == Token::Kind::string || is_string_keyword(next.keyword())) return parse_string();
  if (next.kind != Token::Kind::word || next.keyword() != kNoKeyword) return std::nullopt;
  const Token name = take();
  const Reference reference = access(name);
  const Datum datum = value_of(reference, name);
  if (const std::string* text = datum.get<std::string>()) {
    check_length(text->size(), name.where);
    return *text;
  }
  term_ = call_value(datum, name);
  return std::nullopt;
}

/// Whether the comparison of `text`, which was read, with the string that follows holds.
bool Interpreter::compare_string(const std::string& text) {
  const Token operation = peek();
  const bool is_comparison = operation.is('<') || operation.is('>') || operation.is('=') || operation.is('!');
  if (!is_comparison) fail_expected("a comparison behind a string", operation);
  take();
  const bool or_equal = operation.sign != '=' && pending_.empty() && *at_.p == '=';
  if (operation.sign == '!' && !or_equal) fail_expected("an operator", operation);
  if (or_equal) ++at_.p;
  const int order = text.compare(parse_string());
  if (operation.sign == '!') return order != 0;
  if (operation.sign == '=' || (or_equal && order == 0)) return order == 0;
  return operation.sign == '<' ? order < 0 : order > 0;
}

/// Comparisons, joined by `&` and `|`, which bind alike.
Numbers Interpreter::parse_logic() {
  constexpr double tolerance = 1e-10;
  const Place where = peek().where;
  const auto compared = [&] {
    const std::optional<std::string> text = take_string();
    Numbers value = text ? number(compare_string(*text)) : parse_sum();
    for (;;) {
      if (!next_is('<') && !next_is('>') && !next_is('=') && !next_is('!') && !next_is('#')) {
        if (pending_.empty() && !is_letter(*at_.p)) return value;
      }
      const Token operation = peek();
      const bool is_comparison =
          operation.is('<') || operation.is('>') || operation.is('=') || operation.is('!');
      if (!is_comparison) return value;
      take();
      const bool or_equal = operation.sign != '=' && pending_.empty() && *at_.p == '=';
      if (operation.sign == '!' && !or_equal) fail_expected("an operator", operation);
      if (or_equal) ++at_.p;
      const double a = to_float(value, where);
      const Place right = peek().where;
      const double b = to_float(parse_sum(), right);
      const bool equal = std::abs(a - b) < tolerance || a == b;
      bool holds = equal;
      if (operation.sign == '!') holds = !equal;
      if (operation.sign == '<') holds = or_equal ? a <= b || equal : a < b && !equal;
      if (operation.sign == '>') holds = or_equal ? a >= b || equal : a > b && !equal;
      value = number(holds);
    }
  };
  Numbers value = compared();
  for (;;) {
    if (ends_expression()) return value;
    const bool both = peek().is('&');
    if (!both && !peek().is('|')) return value;
    take();
    const bool left = to_float(value, where) != 0;
    const Place right_place = peek().where;
    const bool right = to_float(compared(), right_place) != 0;
    value = number(both ? left && right : left || right);
  }
}

Numbers Interpreter::parse_sum() {
  Numbers value = parse_product();
  while (!ends_expression()) {
    const char sign = peek().sign;
    if (!peek().is('+') && !peek().is('-')) break;
    take();
    value = combine(sign, value, parse_product());
  }
  return value;
}

Numbers Interpreter::parse_product() {
  Numbers value = parse_factor();
  while (!ends_expression()) {
    const Token operation = peek();
    if (!operation.is('*') && !operation.is('/')) break;
    take();
    const Numbers other = parse_factor();
    if (operation.sign == '/' &&
        std::find(other.v.begin(), other.v.begin() + other.size, 0) != other.v.begin() + other.size &&
        value.size <= other.size)
      warn(operation.where, "division by zero");
    value = combine(operation.sign, value, other);
  }
  return value;
}

Numbers Interpreter::parse_factor() {
  if (term_) return parse_term();
  bool negative = false;
  while (peek().is('+') || peek().is('-')) negative ^= take().sign == '-';
  if (peek().is('!')) {
    bool inverted = false;
    while (peek().is('!')) take(), inverted = !inverted;
    const Place where = peek().where;
    const bool holds = to_float(parse_term(), where) != 0;
    return number((holds != inverted) ? (negative ? -1 : 1) : 0);
  }
  Numbers value = parse_term();
  if (negative)
    for (std::size_t i = 0; i < value.size; ++i) value.v[i] = -value.v[i];
  return value;
}

Numbers Interpreter::parse_term() {
  if (term_) {
    const Numbers value = *term_;
    term_.reset();
    return value;
  }
  const Token token = take();
  switch (token.kind) {
    case Token::Kind::number:
      return number(token.number);
    case Token::Kind::sign:
      if (token.sign == '(') {
        const Level level(*this, token.where);
        const Hold outer = hold_;
        hold_ = {};
        const Numbers value = parse_relation();
        expect(')', "behind an expression");
        hold_ = outer;
        return parse_postfix(value);
      }
      if (token.sign == '<') {
        push_back(token);
        return parse_postfix(parse_vector());
      }
      break;
    case Token::Kind::word: {
      if (token.name->keyword != kNoKeyword) {
        if (const std::optional<Numbers> value = parse_builtin(token)) return parse_postfix(*value);
        break;
      }
      const Reference reference = access(token);
      const Datum datum = value_of(reference, token);
      return call_value(datum, token);
    }
    default:
      break;
  }
  fail_expected("a number, a vector or a colour", token);
}

/// The number, vector or colour that a name stands for, or that its call returns.
Numbers Interpreter::call_value(const Datum& datum, const Token& name) {
  if (const Numbers* value = datum.get<Numbers>()) return parse_postfix(*value);
  if (const FunctionPtr* function = datum.get<FunctionPtr>()) {
    const std::vector<double> arguments = parse_arguments();
    const FunctionCaller caller(*this, name.where);
    return parse_postfix(caller.call(**function, arguments));
  }
  if (const SplinePtr* spline = datum.get<SplinePtr>()) {
    const Level level(*this, name.where);
    expect('(', "behind the name of a spline");
    const double at = parse_float();
    Spline copy;
    const Spline* used = spline->get();
    if (take_if(',')) {
      const Token kind = take();
      count_step(name.where, (*spline)->points.size());
      copy = **spline;
      if (!spline_kind(kind.keyword(), copy.kind))
        fail_expected("a kind of spline, such as linear_spline", kind);
      used = &copy;
    }
    expect(')', "behind the place on a spline");
    count_step(name.where, steps_of(*used));
    Numbers value{evaluate(*used, at), static_cast<std::uint8_t>(used->size), false};
    return parse_postfix(value);
  }
  const bool is_text = datum.get<std::string>() != nullptr;
  fail(name.where, "expected a number, a vector or a colour, found " + in_quotes(name.name->text) +
                       (is_text         ? ", which is a string"
                        : datum.array() ? ", which is an array"
                                        : ", which is something else"));
}

Numbers Interpreter::parse_postfix(Numbers value) {
  // A value that is the last of a macro may be followed by what stands behind the call.
  while (next_is('#') ? peek().is('.') : next_is('.')) {
    take();
    const Token name = take();
    const int index = name.kind == Token::Kind::word ? component_index(name.name->text) : -2;
    if (index == -2) fail_expected("a component such as x or red behind '.'", name);
    if (value.size == 1 || index >= value.size)
      fail(name.where, value.size == 1 ? "a number has no components"
                                       : "this vector of " + std::to_string(value.size) +
                                             " has no component " + in_quotes(name.name->text));
    double result = 0;
    if (index >= 0) result = value.v[static_cast<std::size_t>(index)];
    if (index == -1)
      for (std::size_t i = 0; i < 3; ++i) result += kGray[i] * value.v[i];
    value = number(result);
  }
  return value;
}

/// `<a, b, ...>`. More than five numbers go to `long_vector`, where there is one.
Numbers Interpreter::parse_vector(std::vector<Numbers>* long_vector) {
  const Token opening = take();
  const Level level(*this, opening.where);
  const Hold outer = hold_;
  hold_ = {};
  Numbers result;
  std::size_t size = 0;
  for (;;) {
    if (peek().is('>')) break;
    const Place where = peek().where;
    const double x = to_float(parse_sum(), where);
    if (size < 5) result.v[size] = x;
    ++size;
    if (size > 5) {
      if (long_vector == nullptr) fail(where, "expected '>', as a vector has 2 to 5 components");
      if (long_vector->empty())
        for (const double y : result.v) long_vector->push_back(number(y));
      long_vector->push_back(number(x));
      if (++values_ > limits_.values) fail(where, "more than " + std::to_string(limits_.values) + " values");
    }
    skip_comma();
  }
  take();
  hold_ = outer;
  if (size < 2) fail(opening.where, "expected a vector of 2 to 5 components, found " + std::to_string(size));
  result.size = static_cast<std::uint8_t>(std::min<std::size_t>(size, 5));
  return result;
}

/// `red 1` and the like behind a colour.
bool Interpreter::add_channel(Numbers& color) {
  if (ends_expression()) return false;
  std::size_t index;
  switch (peek().keyword()) {
    case "red"_kw:
      index = 0;
      break;
    case "green"_kw:
      index = 1;
      break;
    case "blue"_kw:
      index = 2;
      break;
    case "filter"_kw:
    case "alpha"_kw:
      index = 3;
      break;
    case "transmit"_kw:
      index = 4;
      break;
    default:
      return false;
  }
  take();
  color.v[index] = parse_float();
  return true;
}

/// A colour whose first keyword was read.
Numbers Interpreter::parse_color(const Token& first) {
  const Level level(*this, first.where);
  Token token = first;
  Numbers color;
  color.size = 5;
  color.is_color = true;
  bool any = true;
  if (token.keyword() == "color"_kw || token.keyword() == "colour"_kw) {
    if (starts_color(peek().keyword())) {
      token = take();
    } else if (peek().keyword() == "filter"_kw || peek().keyword() == "transmit"_kw ||
               peek().keyword() == "alpha"_kw) {
      any = false;
    } else {
      const Numbers value = parse_sum();
      if (value.size == 1)
        color.v.fill(value.v[0]);
      else
        color.v = value.v;
      any = false;
    }
  }
  if (any) {
    const std::string& name = token.name->text;
    if (name == "red" || name == "green" || name == "blue") {
      push_back(token);
    } else {
      const bool is_srgb = name.starts_with('s');
      const std::string channels = name.substr(is_srgb ? 4 : 3);
      const Numbers value = parse_sum();
      const auto at = [&](std::size_t i) { return value.size == 1 ? value.v[0] : value.v[i]; };
      for (std::size_t i = 0; i < 3; ++i) color.v[i] = at(i);
      if (channels.empty() && value.size > 3) color.v = value.v;
      if (channels == "f") color.v[3] = at(3);
      if (channels == "t") color.v[4] = at(3);
      if (channels == "ft") color.v[3] = at(3), color.v[4] = at(4);
      if (channels == "t" && value.size == 5 && value.is_color) color.v = value.v;
      if (is_srgb)
        for (std::size_t i = 0; i < 3; ++i) color.v[i] = decoded(color.v[i]);
    }
  }
  while (add_channel(color)) {}
  return color;
}

std::vector<double> Interpreter::parse_arguments() {
  const Level level(*this, peek().where);
  const Hold outer = hold_;
  hold_ = {};
  std::vector<double> arguments;
  expect('(', "before the values of a function");
  while (!take_if(')')) {
    const Place where = peek().where;
    arguments.push_back(to_float(parse_relation(), where));
    if (!take_if(',') && !peek().is(')')) fail_expected("',' or ')'", peek());
  }
  hold_ = outer;
  return arguments;
}

}  // namespace oktett::pov
