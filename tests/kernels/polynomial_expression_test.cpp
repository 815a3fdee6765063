#include "kernels/exact/polynomial_expression.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "core/error.h"
#include "kernels/functions/expression.h"

namespace oktett::polynomial_expression_test {
namespace {

using Terms = std::map<std::tuple<int, int, int>, double>;

Terms terms_of(const std::string& equation) {
  Terms terms;
  for (const Monomial& m : expand_polynomial(equation))
    EXPECT_TRUE(terms.emplace(std::tuple{m.i, m.j, m.k}, m.c).second) << "twice in " << equation;
  return terms;
}

std::string failure_of(const std::string& equation) {
  try {
    expand_polynomial(equation);
  } catch (const Error& e) {
    return std::to_string(e.where().column) + ": " + e.what();
  }
  return "no error";
}

TEST(PolynomialExpression, MultipliesOut) {
  EXPECT_EQ(terms_of("x^2 + y^2 - 1"), (Terms{{{2, 0, 0}, 1}, {{0, 2, 0}, 1}, {{0, 0, 0}, -1}}));
  EXPECT_EQ(terms_of("(x+y)*(x-y)"), (Terms{{{2, 0, 0}, 1}, {{0, 2, 0}, -1}}));
  EXPECT_EQ(terms_of("(x+2*z)^3"), (Terms{{{3, 0, 0}, 1}, {{2, 0, 1}, 6}, {{1, 0, 2}, 12}, {{0, 0, 3}, 8}}));
  EXPECT_EQ(terms_of("-(x - 3)/4 + +y"), (Terms{{{1, 0, 0}, -0.25}, {{0, 0, 0}, 0.75}, {{0, 1, 0}, 1}}));
  EXPECT_EQ(terms_of("2^-1*x + sqrt(16)*y + pow(2, 3)*z - min(3, 2)"),
            (Terms{{{1, 0, 0}, 0.5}, {{0, 1, 0}, 4}, {{0, 0, 1}, 8}, {{0, 0, 0}, -2}}));
  EXPECT_EQ(terms_of("pow(x, 2) + x^0 + 4^0.5"), (Terms{{{2, 0, 0}, 1}, {{0, 0, 0}, 3}}));
  EXPECT_EQ(terms_of("x - x"), Terms{});
  EXPECT_EQ(terms_of("x^2^2^1 - 0*y"), (Terms{{{4, 0, 0}, 1}}));
}

TEST(PolynomialExpression, SubtractsTheRightSide) {
  EXPECT_EQ(terms_of("x^4 = 0"), (Terms{{{4, 0, 0}, 1}}));
  EXPECT_EQ(terms_of("x = y - 2"), (Terms{{{1, 0, 0}, 1}, {{0, 1, 0}, -1}, {{0, 0, 0}, 2}}));
  EXPECT_EQ(terms_of("x = x"), Terms{});
}

/// Sums and products are exact to far below a double's precision, then rounded once.
TEST(PolynomialExpression, RoundsOnce) {
  const Terms t = terms_of("(x + 1e-10)^2 + 3*(x/3)^2 - 4/3*x^2");
  EXPECT_EQ(t.at({1, 0, 0}), 2e-10);
  EXPECT_LT(std::abs(t.count({2, 0, 0}) ? t.at({2, 0, 0}) : 0), 1e-30);
}

TEST(PolynomialExpression, SaysWhatIsNoPolynomialAndWhere) {
  EXPECT_EQ(failure_of("x^2 + 1/y"), "8: not a polynomial: the divisor has x, y or z in it");
  EXPECT_EQ(failure_of("x^2 = 1/(y+1)"), "8: not a polynomial: the divisor has x, y or z in it");
  EXPECT_EQ(failure_of("x^0.5"), "2: not a polynomial: the exponent is not a whole number");
  EXPECT_EQ(failure_of("x^(1/3)"), "2: not a polynomial: the exponent is not a whole number");
  EXPECT_EQ(failure_of("1 + x^-2"), "6: not a polynomial: the exponent is negative");
  EXPECT_EQ(failure_of("2^x"), "2: not a polynomial: the exponent has x, y or z in it");
  EXPECT_EQ(failure_of("1 + sin(x)"), "5: not a polynomial: a function of x, y or z");
  EXPECT_EQ(failure_of("max(1, z)"), "1: not a polynomial: a function of x, y or z");
  EXPECT_EQ(failure_of("x / 0"), "3: division by zero");
  EXPECT_EQ(failure_of("x + sqrt(-1)"), "5: this is not a finite number");
  EXPECT_EQ(failure_of("x = 1 = y"), "7: a second '='");
  EXPECT_EQ(failure_of("x + = 1").substr(0, 2), "5:");
  EXPECT_EQ(failure_of("x = "), "5: expected a number, a name or '('");
  EXPECT_EQ(failure_of("x = w"), "5: unknown name 'w'");
}

TEST(PolynomialExpression, HasBounds) {
  EXPECT_EQ(terms_of("x^32").size(), 1u);
  EXPECT_EQ(failure_of("x^33"), "2: the degree is above 32");
  EXPECT_EQ(failure_of("x^20*y^13"), "5: the degree is above 32");
  EXPECT_EQ(failure_of("x^1e99"), "2: the degree is above 32");
  EXPECT_EQ(terms_of("(x+y+z+1)^32").size(), 6545u);
  const std::string much = "(x+y+z+1)^16*(x+y+z+1)^16";
  EXPECT_EQ(terms_of(much).size(), 6545u);
  EXPECT_EQ(failure_of(much + "+" + much), "49: too much to multiply out");
  EXPECT_EQ(failure_of("x*1e101"), "3: a coefficient is out of range");
  EXPECT_EQ(failure_of("x*1e60*1e60"), "7: a coefficient is out of range");
  EXPECT_EQ(failure_of("(1e60)^1000*x").substr(0, 3), "7: ");
  EXPECT_EQ(failure_of("x+" + std::string(kMaxExpressionLength, '1')).substr(0, 3), "1: ");
}

/// The multiplied-out polynomial has the values of the expression as written.
TEST(PolynomialExpression, HasTheValuesOfWhatWasWritten) {
  rc::check([] {
    const auto piece = [] {
      std::string s = "(";
      for (const char* v : {"x", "y", "z", "1"}) {
        s += std::to_string(*rc::gen::inRange(-9, 10)) + "*" + v;
        s += *v == '1' ? ")" : "+";
      }
      const int power = *rc::gen::inRange(0, 5);
      return s + "^" + std::to_string(power);
    };
    const std::string text = piece() + "*" + piece() + "-" + piece() + "/" +
                             std::to_string(*rc::gen::inRange(1, 9)) + "+" + piece();
    constexpr std::string_view kNames[] = {"x", "y", "z"};
    const double at[3] = {0.5, -0.75, 0.25};
    double sum = 0, size = 0;
    for (const Monomial& m : expand_polynomial(text)) {
      const double v = m.c * std::pow(at[0], m.i) * std::pow(at[1], m.j) * std::pow(at[2], m.k);
      sum += v, size += std::abs(v);
    }
    RC_ASSERT(std::abs(sum - evaluate(parse_expression(text, kNames), at)) <= 1e-12 * size + 1e-12);
  });
}

}  // namespace
}  // namespace oktett::polynomial_expression_test
