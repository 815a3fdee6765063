#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>

#include "io/pov/interpreter.h"
#include "io/pov/numeric.h"

namespace oktett::pov {

void ObjectQueries::begin(const Document&) {}
std::uint64_t ObjectQueries::take_steps() { return 0; }
std::optional<bool> ObjectQueries::inside(const BlockPointer&, const Point&) { return std::nullopt; }
std::optional<ObjectQueries::Hit> ObjectQueries::trace(const BlockPointer&, const Point&, const Point&) {
  return std::nullopt;
}
std::optional<std::pair<ObjectQueries::Point, ObjectQueries::Point>> ObjectQueries::extent(
    const BlockPointer&) {
  return std::nullopt;
}
std::optional<std::array<double, 5>> ObjectQueries::pigment(const BlockPointer&, const Point&) {
  return std::nullopt;
}
std::optional<double> ObjectQueries::pattern(const BlockPointer&, const Point&) { return std::nullopt; }
std::optional<double> ObjectQueries::internal(std::uint32_t, std::span<const double>) { return std::nullopt; }
std::optional<ObjectQueries::Point> ObjectQueries::turbulence(double, double, int, const Point&) {
  return std::nullopt;
}

namespace {

using Point = std::array<double, 3>;

Numbers vector(const Point& p) { return {{p[0], p[1], p[2], 0, 0}, 3, false}; }
Numbers unit(std::uint8_t size, std::size_t axis) {
  Numbers result;
  result.size = size;
  result.v[axis] = 1;
  return result;
}

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// About x, then y, then z, by degrees.
Point rotated(Point p, const Point& degrees) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double angle = degrees[axis] * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double a = p[i], b = p[j];
    p[i] = c * a - s * b;
    p[j] = s * a + c * b;
  }
  return p;
}

/// About any axis, by Rodrigues' formula.
Point rotated_about(const Point& p, Point axis, double degrees) {
  const double length = std::sqrt(dot(axis, axis));
  if (length == 0) return p;
  for (double& x : axis) x /= length;
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const Point side = cross(axis, p);
  const double along = dot(axis, p) * (1 - c);
  Point result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = c * p[i] + s * side[i] + along * axis[i];
  return result;
}

/// A whole number that a text may be asked to have, within bounds.
int bounded(double x) {
  if (!(x > -10000)) return -10000;
  return x < 10000 ? static_cast<int>(x) : 10000;
}

std::string formatted(double x, int width, int digits) {
  char format[16] = "%*.*f";
  if (width < 0) std::copy_n("%0*.*f", 7, format);
  std::string text(
      static_cast<std::size_t>(std::abs(width)) + static_cast<std::size_t>(std::max(digits, 6)) + 400, '\0');
  const int length = std::snprintf(text.data(), text.size(), format, std::abs(width), digits, x);
  text.resize(static_cast<std::size_t>(length));
  return text;
}

/// The number that a text starts with, 0 if there is none.
double leading_number(const std::string& text) {
  const char* p = text.data();
  const char* const end = p + text.size();
  while (p < end && (*p == ' ' || (*p >= '\t' && *p <= '\r'))) ++p;
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  double value = 0;
  if (end - p > 2 && p[0] == '0' && (p[1] | 0x20) == 'x')
    std::from_chars(p + 2, end, value, std::chars_format::hex);
  else if (p < end && *p != '-')
    std::from_chars(p, end, value);
  return negative ? -value : value;
}

/// Days since the start of 2000.
double days_now() {
  const auto seconds =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return (seconds - 946684800.0) / 86400;
}

void append_utf8(std::string& text, unsigned code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xc0 | code >> 6);
    text += static_cast<char>(0x80 | (code & 0x3f));
  } else {
    text += static_cast<char>(0xe0 | code >> 12);
    text += static_cast<char>(0x80 | (code >> 6 & 0x3f));
    text += static_cast<char>(0x80 | (code & 0x3f));
  }
}

}  // namespace

bool is_string_keyword(Keyword keyword) {
  switch (keyword) {
    case "chr"_kw:
    case "concat"_kw:
    case "datetime"_kw:
    case "str"_kw:
    case "strlwr"_kw:
    case "strupr"_kw:
    case "substr"_kw:
    case "vstr"_kw:
      return true;
    default:
      return false;
  }
}

ObjectQueries& Interpreter::queries(const Token& token) {
  if (options_.queries != nullptr) return *options_.queries;
  fail(token.where,
       in_quotes(token.name->text) + " is not available here: it needs the objects of the scene");
}

void Interpreter::check_length(std::size_t length, const Place& where) {
  if (length > limits_.string_length)
    fail(where, "a string is longer than " + std::to_string(limits_.string_length) + " characters");
  // Long texts take as much time and memory as many steps.
  count_step(where, length / 16);
}

BlockPtr Interpreter::parse_object_argument() {
  const Token token = peek();
  const Datum datum = parse_value();
  if (const BlockPtr* block = datum.get<BlockPtr>()) return *block;
  fail_expected("an object", token);
}

/// A linear congruential generator modulo 2^32 with the multiplier 1812433253 and the increment 12345. The
/// result is the state divided by 2^32 - 1. Its outputs agree with the numbers that POV-Ray prints.
Numbers Interpreter::random_number() {
  const Place where = peek().where;
  const double stream = parse_float();
  if (!(stream >= 0 && stream < static_cast<double>(streams_.size())))
    fail(where, "expected a stream of random numbers, as seed() returns them");
  std::uint32_t& state = streams_[static_cast<std::size_t>(stream)];
  state = state * 1812433253u + 12345u;
  return number(state / 4294967295.0);
}

/// A constant or a call; nothing if the keyword is neither.
std::optional<Numbers> Interpreter::parse_builtin(const Token& token) {
  switch (token.name->keyword) {
    case "x"_kw:
      return unit(3, 0);
    case "y"_kw:
      return unit(3, 1);
    case "z"_kw:
      return unit(3, 2);
    case "t"_kw:
      return unit(4, 3);
    case "u"_kw:
      return unit(2, 0);
    case "v"_kw:
      return unit(2, 1);
    case "pi"_kw:
      return number(std::numbers::pi);
    case "on"_kw:
    case "yes"_kw:
    case "true"_kw:
      return number(1);
    case "off"_kw:
    case "no"_kw:
    case "false"_kw:
      return number(0);
    case "clock"_kw:
      return number(options_.clock);
    case "clock_on"_kw:
      return number(options_.clock_on);
    case "version"_kw:
      return number(version_);
    case "now"_kw:
      return number(days_now());
    default:
      break;
  }
  if (!next_is('(')) return std::nullopt;
  const std::string_view name = kKeywords[token.name->keyword];
  if (const NumericFunction* numeric = find_numeric(name)) {
    const std::vector<double> a = parse_arguments();
    if (a.size() < numeric->least || a.size() > numeric->most)
      fail(token.where, in_quotes(name) + " takes " + std::to_string(numeric->least) +
                            (numeric->most > numeric->least ? " or more" : "") +
                            (numeric->least == 1 ? " value, found " : " values, found ") +
                            std::to_string(a.size()));
    if (name == "sqrt" && a[0] < 0) fail(token.where, "the square root of a negative number");
    if ((name == "ln" || name == "log") && !(a[0] > 0))
      fail(token.where, "the logarithm of a number that is not above 0");
    if ((name == "acos" || name == "asin") && std::abs(a[0]) > 1)
      warn(token.where, in_quotes(name) + " of a number beyond 1, which counts as 1");
    return number(numeric->value(a));
  }
  const Level level(*this, token.where);
  const Hold outer = hold_;
  const auto open = [&] {
    hold_ = {};
    expect('(', "behind a function");
  };
  const auto close = [&](const Numbers& value) {
    expect(')', "behind the values of a function");
    hold_ = outer;
    return value;
  };
  const auto next_point = [&] {
    const Point p = parse_point();
    skip_comma();
    return p;
  };
  switch (token.name->keyword) {
    case "asc"_kw: {
      open();
      const std::string text = parse_string();
      return close(number(text.empty() ? 0 : static_cast<unsigned char>(text[0])));
    }
    case "defined"_kw:
      return number(is_defined());
    case "dimensions"_kw:
    case "dimension_size"_kw: {
      open();
      const Token array_name = take();
      if (array_name.kind != Token::Kind::word) fail_expected("the name of an array", array_name);
      const Reference reference = access(array_name);
      const Array* const array = value_of(reference, array_name).array();
      if (array == nullptr) fail_expected("the name of an array", array_name);
      if (token.keyword() == "dimensions"_kw) return close(number(static_cast<double>(array->sizes.size())));
      const std::vector<std::size_t> sizes = array->sizes;
      skip_comma();
      const Place where = peek().where;
      const double index = next_is(')') ? 1 : parse_float();
      if (!(index >= 1 && index < static_cast<double>(sizes.size()) + 1))
        fail(where, "the array " + in_quotes(array_name.name->text) + " has " + std::to_string(sizes.size()) +
                        " dimensions");
      return close(number(static_cast<double>(sizes[static_cast<std::size_t>(index) - 1])));
    }
    case "file_exists"_kw: {
      open();
      return close(number(file_exists(parse_string(), token.where)));
    }
    case "inside"_kw: {
      open();
      const BlockPtr object = parse_object_argument();
      skip_comma();
      const auto value = queries(token).inside(object, next_point());
      count_step(token.where, queries(token).take_steps());
      if (!value) fail(token.where, "'inside' is not available for this object");
      return close(number(*value));
    }
    case "min_extent"_kw:
    case "max_extent"_kw: {
      open();
      const BlockPtr object = parse_object_argument();
      const auto value = queries(token).extent(object);
      count_step(token.where, queries(token).take_steps());
      if (!value) fail(token.where, in_quotes(name) + " is not available for this object");
      return close(vector(name == "min_extent" ? value->first : value->second));
    }
    case "trace"_kw: {
      open();
      const BlockPtr object = parse_object_argument();
      skip_comma();
      const Point origin = next_point(), direction = next_point();
      const auto hit = queries(token).trace(object, origin, direction);
      count_step(token.where, queries(token).take_steps());
      if (!hit) fail(token.where, "'trace' is not available for this object");
      if (peek().kind == Token::Kind::word) {
        const Token normal = take();
        Datum datum;
        datum.value = vector(hit->found ? hit->normal : Point{});
        assign(access(normal), std::move(datum), normal.where);
      }
      return close(vector(hit->found ? hit->point : Point{}));
    }
    case "rand"_kw: {
      open();
      return close(random_number());
    }
    case "seed"_kw: {
      open();
      const double start = parse_float();
      constexpr std::size_t most = 10'000'000;
      if (streams_.size() >= most) fail(token.where, "more than 10000000 streams of random numbers");
      const bool fits = start > -0x1p31 - 1 && start < 0x1p31;
      streams_.push_back(fits ? static_cast<std::uint32_t>(static_cast<std::int32_t>(start)) : 0x80000000u);
      return close(number(static_cast<double>(streams_.size() - 1)));
    }
    case "strcmp"_kw: {
      open();
      const std::string a = parse_string();
      skip_comma();
      const std::string b = parse_string();
      // The difference of the first characters that differ.
      std::size_t i = 0;
      while (i < a.size() && i < b.size() && a[i] == b[i]) ++i;
      const auto code = [i](const std::string& s) {
        return i < s.size() ? static_cast<unsigned char>(s[i]) : 0;
      };
      return close(number(code(a) - code(b)));
    }
    case "strlen"_kw: {
      open();
      return close(number(static_cast<double>(parse_string().size())));
    }
    case "val"_kw: {
      open();
      return close(number(leading_number(parse_string())));
    }
    case "vdot"_kw: {
      open();
      const Point a = next_point(), b = next_point();
      return close(number(dot(a, b)));
    }
    case "vlength"_kw: {
      open();
      const Point a = next_point();
      return close(number(std::sqrt(dot(a, a))));
    }
    case "vcross"_kw: {
      open();
      const Point a = next_point(), b = next_point();
      return close(vector(cross(a, b)));
    }
    case "vnormalize"_kw: {
      open();
      Point a = next_point();
      const double length = std::sqrt(dot(a, a));
      if (length == 0) warn(token.where, "a vector of length 0 has no direction");
      if (length != 0)
        for (double& x : a) x /= length;
      return close(vector(a));
    }
    case "vrotate"_kw: {
      open();
      const Point a = next_point(), degrees = next_point();
      return close(vector(rotated(a, degrees)));
    }
    case "vaxis_rotate"_kw: {
      open();
      const Point a = next_point(), axis = next_point();
      return close(vector(rotated_about(a, axis, parse_float())));
    }
    case "vturbulence"_kw: {
      open();
      const double lambda = parse_float();
      skip_comma();
      const double omega = parse_float();
      skip_comma();
      const double octaves = parse_float();
      skip_comma();
      const auto value = queries(token).turbulence(lambda, omega, bounded(octaves), next_point());
      count_step(token.where, queries(token).take_steps());
      if (!value) fail(token.where, "'vturbulence' is not available");
      return close(vector(*value));
    }
    default:
      return std::nullopt;
  }
}

std::string Interpreter::unescape(const Token& token) {
  std::string result;
  check_length(token.text.size(), token.where);
  const std::string_view text = token.text;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      result += text[i];
      continue;
    }
    const char c = text[++i];
    static constexpr std::string_view from = "abfnrtv0\\'\"", to{"\a\b\f\n\r\t\v\0\\'\"", 11};
    const std::size_t found = from.find(c);
    unsigned code = 0;
    if (found != std::string_view::npos) {
      result += to[found];
    } else if (const char* const digits = text.data() + i + 1;
               c == 'u' && i + 4 < text.size() &&
               std::from_chars(digits, digits + 4, code, 16).ptr == digits + 4) {
      append_utf8(result, code);
      i += 4;
    } else {
      Place where = token.where;
      where.column += static_cast<std::uint32_t>(i);
      fail(where, "unknown character behind a backslash in a string: " + in_quotes({&c, 1}));
    }
  }
  return result;
}

std::string Interpreter::parse_string() {
  const Token token = take();
  if (token.kind == Token::Kind::string) return unescape(token);
  if (token.kind == Token::Kind::word) {
    if (token.name->keyword != kNoKeyword) {
      if (std::optional<std::string> text = parse_string_call(token)) return *text;
    } else {
      const Reference reference = access(token);
      const Datum& datum = value_of(reference, token);
      if (const std::string* text = datum.get<std::string>()) {
        check_length(text->size(), token.where);
        return *text;
      }
    }
  }
  fail_expected("a string", token);
}

std::optional<std::string> Interpreter::parse_string_call(const Token& token) {
  if (!is_string_keyword(token.keyword())) return std::nullopt;
  const Level level(*this, token.where);
  const Hold outer = hold_;
  hold_ = {};
  expect('(', "behind a function");
  std::string result;
  switch (token.name->keyword) {
    case "chr"_kw: {
      const double code = parse_float();
      if (!(code >= 0 && code < 65536)) fail(token.where, "expected the code of a character from 0 to 65535");
      if (code < 256)
        result = static_cast<char>(static_cast<unsigned char>(code));
      else
        append_utf8(result, static_cast<unsigned>(code));
      break;
    }
    case "concat"_kw:
      while (!next_is(')') && !peek().is(')')) {
        result += parse_string();
        check_length(result.size(), token.where);
        skip_comma();
      }
      break;
    case "str"_kw: {
      const double x = parse_float();
      skip_comma();
      const int width = bounded(parse_float());
      skip_comma();
      result = formatted(x, width, bounded(parse_float()));
      break;
    }
    case "vstr"_kw: {
      const Place where = peek().where;
      const double count = parse_float();
      if (!(count >= 1 && count < 6)) fail(where, "expected a number of components from 1 to 5");
      skip_comma();
      const Numbers value = parse_sum();
      skip_comma();
      const std::string separator = parse_string();
      skip_comma();
      const int width = bounded(parse_float());
      skip_comma();
      const int digits = bounded(parse_float());
      for (int i = 0; i < static_cast<int>(count); ++i)
        result += (i == 0 ? "" : separator) + formatted(value.v[static_cast<std::size_t>(i)], width, digits);
      break;
    }
    case "strlwr"_kw:
    case "strupr"_kw:
      result = parse_string();
      for (char& c : result) {
        if (token.keyword() == "strlwr"_kw && c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
        if (token.keyword() == "strupr"_kw && c >= 'a' && c <= 'z') c = static_cast<char>(c - 32);
      }
      break;
    case "substr"_kw: {
      const std::string text = parse_string();
      skip_comma();
      const Place where = peek().where;
      const auto part = [&] {
        const double x = parse_float();
        return x > -1e9 ? static_cast<long>(std::min(x, 1e9)) : -1000000000L;
      };
      const long first = part();
      skip_comma();
      const long count = part();
      // A start of 0 counts as a part of nothing.
      if (first < 0 || count < 0 ||
          static_cast<std::size_t>(first) + static_cast<std::size_t>(count) > text.size() + 1)
        fail(where, "the part of " + std::to_string(count) + " characters from " + std::to_string(first) +
                        " on is not within the string of " + std::to_string(text.size()));
      if (first > 0)
        result = text.substr(static_cast<std::size_t>(first) - 1, static_cast<std::size_t>(count));
      break;
    }
    default: {  // datetime
      const double days = parse_float();
      std::string format = "%Y-%m-%d %H:%M:%SZ";
      skip_comma();
      if (!next_is(')')) format = parse_string();
      const double bounded_days = days > -1e6 ? std::min(days, 1e6) : -1e6;
      const auto seconds = static_cast<std::time_t>(bounded_days * 86400 + 946684800.0);
      std::tm parts{};
      gmtime_r(&seconds, &parts);
      if (format.size() > 1000) fail(token.where, "the format of a date is too long");
      char text[4096];
      result.assign(text, std::strftime(text, sizeof text, format.c_str(), &parts));
    }
  }
  check_length(result.size(), token.where);
  expect(')', "behind the values of a function");
  hold_ = outer;
  return result;
}

}  // namespace oktett::pov
