#include "io/pov/numeric.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace oktett::pov {
namespace {

using Values = std::span<const double>;

/// Whole numbers of 64 bits, as far as there are any.
std::int64_t whole(double x) {
  if (!(std::abs(x) < 0x1p63)) return 0;
  return static_cast<std::int64_t>(x);
}

double select(Values a) {
  if (a.size() == 3) return a[0] < 0 ? a[1] : a[2];
  return a[0] < 0 ? a[1] : a[0] == 0 ? a[2] : a[3];
}

double both(Values a, std::int64_t (*combine)(std::int64_t, std::int64_t)) {
  std::int64_t result = whole(a[0]);
  for (const double x : a.subspan(1)) result = combine(result, whole(x));
  return static_cast<double>(result);
}

constexpr std::size_t kMany = 1000;

// In alphabetical order.
constexpr NumericFunction kFunctions[] = {
    {"abs", 1, 1, [](Values a) { return std::abs(a[0]); }},
    {"acos", 1, 1, [](Values a) { return std::acos(std::clamp(a[0], -1.0, 1.0)); }},
    {"acosh", 1, 1, [](Values a) { return std::acosh(a[0]); }},
    {"asin", 1, 1, [](Values a) { return std::asin(std::clamp(a[0], -1.0, 1.0)); }},
    {"asinh", 1, 1, [](Values a) { return std::asinh(a[0]); }},
    {"atan", 1, 1, [](Values a) { return std::atan(a[0]); }},
    {"atan2", 2, 2, [](Values a) { return std::atan2(a[0], a[1]); }},
    {"atanh", 1, 1, [](Values a) { return std::atanh(a[0]); }},
    {"bitwise_and", 2, kMany,
     [](Values a) { return both(a, [](std::int64_t p, std::int64_t q) { return p & q; }); }},
    {"bitwise_or", 2, kMany,
     [](Values a) { return both(a, [](std::int64_t p, std::int64_t q) { return p | q; }); }},
    {"bitwise_xor", 2, kMany,
     [](Values a) { return both(a, [](std::int64_t p, std::int64_t q) { return p ^ q; }); }},
    {"ceil", 1, 1, [](Values a) { return std::ceil(a[0]); }},
    {"cos", 1, 1, [](Values a) { return std::cos(a[0]); }},
    {"cosh", 1, 1, [](Values a) { return std::cosh(a[0]); }},
    {"degrees", 1, 1, [](Values a) { return a[0] * (180 / std::numbers::pi); }},
    {"div", 2, 2, [](Values a) { return std::trunc(a[0] / a[1]); }},
    {"exp", 1, 1, [](Values a) { return std::exp(a[0]); }},
    {"floor", 1, 1, [](Values a) { return std::floor(a[0]); }},
    {"int", 1, 1, [](Values a) { return std::trunc(a[0]); }},
    {"ln", 1, 1, [](Values a) { return std::log(a[0]); }},
    {"log", 1, 1, [](Values a) { return std::log10(a[0]); }},
    {"max", 1, kMany, [](Values a) { return *std::max_element(a.begin(), a.end()); }},
    {"min", 1, kMany, [](Values a) { return *std::min_element(a.begin(), a.end()); }},
    {"mod", 2, 2, [](Values a) { return std::fmod(a[0], a[1]); }},
    {"pow", 2, 2, [](Values a) { return std::pow(a[0], a[1]); }},
    {"radians", 1, 1, [](Values a) { return a[0] * (std::numbers::pi / 180); }},
    {"select", 3, 4, select},
    {"sin", 1, 1, [](Values a) { return std::sin(a[0]); }},
    {"sinh", 1, 1, [](Values a) { return std::sinh(a[0]); }},
    {"sqr", 1, 1, [](Values a) { return a[0] * a[0]; }},
    {"sqrt", 1, 1, [](Values a) { return std::sqrt(a[0]); }},
    {"tan", 1, 1, [](Values a) { return std::tan(a[0]); }},
    {"tanh", 1, 1, [](Values a) { return std::tanh(a[0]); }},
};

}  // namespace

const NumericFunction* find_numeric(std::string_view name) {
  const auto* const found = std::ranges::lower_bound(kFunctions, name, {}, &NumericFunction::name);
  return found != std::end(kFunctions) && found->name == name ? found : nullptr;
}

Numbers combine(char operation, const Numbers& a, const Numbers& b) {
  Numbers result;
  result.size = std::max(a.size, b.size);
  result.is_color = a.is_color || b.is_color;
  for (std::size_t i = 0; i < result.size; ++i) {
    const double p = a.size == 1 ? a.v[0] : a.v[i], q = b.size == 1 ? b.v[0] : b.v[i];
    result.v[i] = operation == '+' ? p + q : operation == '-' ? p - q : operation == '*' ? p * q : p / q;
  }
  return result;
}

int component_index(std::string_view name) {
  if (name == "x" || name == "u" || name == "red") return 0;
  if (name == "y" || name == "v" || name == "green") return 1;
  if (name == "z" || name == "blue") return 2;
  if (name == "t" || name == "filter") return 3;
  if (name == "transmit") return 4;
  return name == "gray" || name == "grey" ? -1 : -2;
}

}  // namespace oktett::pov
