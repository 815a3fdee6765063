#include "kernels/exact/polynomial_expression.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/double_double.h"
#include "core/precise_math.h"
#include "kernels/functions/expression.h"

namespace oktett {
namespace {

/// Coefficients above this are refused; double-double products of two such are still right.
constexpr double kGreatestCoefficient = 1e100;
constexpr int kSide = roots::kMaxDegree + 1;

/// A term; `key` orders by exponents.
struct Term {
  int key;
  DoubleDouble c;
};
int make_key(int i, int j, int k) { return (i * kSide + j) * kSide + k; }
int degree_of(int key) { return key / (kSide * kSide) + key / kSide % kSide + key % kSide; }

/// Sorted by key, no coefficient 0.
using Terms = std::vector<Term>;

int degree_of(const Terms& terms) {
  int degree = 0;
  for (const Term& t : terms) degree = std::max(degree, degree_of(t.key));
  return degree;
}
bool is_constant(const Terms& terms) { return terms.empty() || (terms.size() == 1 && terms[0].key == 0); }
DoubleDouble constant_of(const Terms& terms) { return terms.empty() ? DoubleDouble(0) : terms[0].c; }

Terms constant(const DoubleDouble& c) { return c.hi == 0 ? Terms{} : Terms{{0, c}}; }

/// a + sign b.
Terms sum(const Terms& a, const Terms& b, const DoubleDouble& sign) {
  Terms out;
  std::size_t i = 0, k = 0;
  while (i < a.size() || k < b.size()) {
    if (k == b.size() || (i < a.size() && a[i].key < b[k].key)) {
      out.push_back(a[i++]);
    } else if (i == a.size() || b[k].key < a[i].key) {
      out.push_back({b[k].key, b[k].c * sign}), ++k;
    } else {
      const DoubleDouble c = a[i].c + b[k].c * sign;
      if (c.hi != 0) out.push_back({a[i].key, c});
      ++i, ++k;
    }
  }
  return out;
}

class Expansion {
 public:
  /// `offset` is where the expression begins in the equation.
  Expansion(const Expression& expression, std::size_t offset, std::size_t& products)
      : expression_(expression), offset_(offset), products_(products) {}

  Terms run() {
    std::vector<Terms> results;
    for (std::size_t i = 0; i < expression_.nodes.size(); ++i) {
      const ExpressionNode& node = expression_.nodes[i];
      place_ = expression_.places[i];
      // Each node is the operand of one other only, which comes later.
      const int operands = operand_count(node.op);
      Terms a, b, c;
      if (operands > 0) a = std::move(results[node.a]);
      if (operands > 1) b = std::move(results[node.b]);
      if (operands > 2) c = std::move(results[node.c]);
      results.push_back(apply_node(node, a, b, c));
      for (const Term& t : results.back())
        if (!(std::abs(t.c.hi) <= kGreatestCoefficient)) fail("a coefficient is out of range");
    }
    return std::move(results.back());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(Location{"", 0, static_cast<int>(offset_ + place_) + 1}, message);
  }

  Terms apply_node(const ExpressionNode& node, Terms& a, Terms& b, const Terms& third) {
    switch (node.op) {
      case ExpressionOp::constant:
        return constant(node.value);
      case ExpressionOp::variable:
        return {{node.a == 0 ? make_key(1, 0, 0) : node.a == 1 ? make_key(0, 1, 0) : make_key(0, 0, 1), 1}};
      case ExpressionOp::negate:
        return map(a, [](const DoubleDouble& c) { return c * DoubleDouble(-1); });
      case ExpressionOp::add:
        return sum(a, b, DoubleDouble(1));
      case ExpressionOp::subtract:
        return sum(a, b, DoubleDouble(-1));
      case ExpressionOp::multiply:
        return product(a, b);
      case ExpressionOp::divide:
        if (!is_constant(b)) fail("not a polynomial: the divisor has x, y or z in it");
        if (b.empty()) fail("division by zero");
        return map(a, [&](const DoubleDouble& c) { return c / constant_of(b); });
      case ExpressionOp::power:
        return power(a, b);
      default:
        break;
    }
    if (!is_constant(a) || !is_constant(b) || !is_constant(third))
      fail("not a polynomial: a function of x, y or z");
    return number(apply(node.op, constant_of(a).hi, constant_of(b).hi, constant_of(third).hi));
  }

  Terms number(double value) const {
    if (!std::isfinite(value)) fail("this is not a finite number");
    return constant(value);
  }

  /// Each coefficient c as f(c).
  template <class F>
  static Terms map(Terms terms, const F& f) {
    for (Term& t : terms) t.c = f(t.c);
    return terms;
  }

  Terms product(const Terms& a, const Terms& b) {
    if (degree_of(a) + degree_of(b) > roots::kMaxDegree)
      fail("the degree is above " + std::to_string(roots::kMaxDegree));
    products_ += a.size() * b.size();
    if (products_ > kMaxTermProducts) fail("too much to multiply out");
    Terms all;
    for (const Term& s : a)
      for (const Term& t : b) all.push_back({s.key + t.key, s.c * t.c});
    // Stable: the order of summation depends on the text alone.
    std::stable_sort(all.begin(), all.end(), [](const Term& s, const Term& t) { return s.key < t.key; });
    Terms out;
    for (const Term& t : all) {
      if (!out.empty() && out.back().key == t.key) {
        out.back().c = out.back().c + t.c;
      } else {
        if (!out.empty() && out.back().c.hi == 0) out.pop_back();
        out.push_back(t);
      }
    }
    if (!out.empty() && out.back().c.hi == 0) out.pop_back();
    return out;
  }

  Terms power(const Terms& base, const Terms& exponent) {
    if (!is_constant(exponent)) fail("not a polynomial: the exponent has x, y or z in it");
    const double n = constant_of(exponent).hi;
    const bool whole = n == std::floor(n) && constant_of(exponent).lo == 0;
    if (is_constant(base) && !(whole && n >= 0 && n <= 1024))
      return number(precise::pow(constant_of(base).hi, n));
    if (!whole) fail("not a polynomial: the exponent is not a whole number");
    if (n < 0) fail("not a polynomial: the exponent is negative");
    if (!is_constant(base) && n * degree_of(base) > roots::kMaxDegree)
      fail("the degree is above " + std::to_string(roots::kMaxDegree));
    Terms out = constant(1);
    for (int k = 0; k < static_cast<int>(n); ++k) {
      out = product(out, base);
      if (is_constant(base) && !(std::abs(constant_of(out).hi) <= kGreatestCoefficient)) break;
    }
    return out;
  }

  const Expression& expression_;
  std::size_t offset_, place_ = 0;
  std::size_t& products_;
};

Terms expand(std::string_view text, std::size_t offset, std::size_t& products) {
  constexpr std::string_view kVariables[] = {"x", "y", "z"};
  Expression expression;
  try {
    expression = parse_expression(text, kVariables);
  } catch (const Error& e) {
    throw Error(Location{"", 0, e.where().column + static_cast<int>(offset)}, e.what());
  }
  return Expansion(expression, offset, products).run();
}

}  // namespace

std::vector<Monomial> expand_polynomial(std::string_view equation) {
  const std::size_t equals = equation.find('=');
  std::size_t products = 0;
  Terms terms = expand(equation.substr(0, equals), 0, products);
  if (equals != std::string_view::npos) {
    const std::size_t second = equation.find('=', equals + 1);
    if (second != std::string_view::npos)
      throw Error(Location{"", 0, static_cast<int>(second) + 1}, "a second '='");
    terms = sum(terms, expand(equation.substr(equals + 1), equals + 1, products), DoubleDouble(-1));
  }
  std::vector<Monomial> out;
  for (const Term& t : terms)
    out.push_back({static_cast<std::uint8_t>(t.key / (kSide * kSide)),
                   static_cast<std::uint8_t>(t.key / kSide % kSide), static_cast<std::uint8_t>(t.key % kSide),
                   t.c.hi});
  return out;
}

}  // namespace oktett
