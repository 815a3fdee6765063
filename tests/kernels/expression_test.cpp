#include "kernels/functions/expression.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace oktett::expression_test {
namespace {

double value_of(const std::string& text) { return evaluate(parse_expression(text)); }

struct Failure {
  int column = 0;
  std::string message;
};

Failure failure_of(const std::string& text) {
  try {
    parse_expression(text);
  } catch (const Error& e) {
    return {e.where().column, e.what()};
  }
  return {};
}

TEST(Expression, KnowsNumbersAndConstants) {
  EXPECT_EQ(value_of("42"), 42);
  EXPECT_EQ(value_of(" .5 "), 0.5);
  EXPECT_EQ(value_of("5."), 5);
  EXPECT_EQ(value_of("1.5e-3"), 1.5e-3);
  EXPECT_EQ(value_of("pi"), std::numbers::pi);
  EXPECT_EQ(value_of("e"), std::numbers::e);
  EXPECT_EQ(value_of("\t2*pi\n/3\r"), 2 * std::numbers::pi / 3);
}

TEST(Expression, FollowsPrecedence) {
  EXPECT_EQ(value_of("1+2*3"), 7);
  EXPECT_EQ(value_of("(1+2)*3"), 9);
  EXPECT_EQ(value_of("8-4-2"), 2);
  EXPECT_EQ(value_of("8/4/2"), 1);
  EXPECT_EQ(value_of("2*3^2"), 18);
  EXPECT_EQ(value_of("2^3^2"), 512);
  EXPECT_EQ(value_of("-2^2"), -4);
  EXPECT_EQ(value_of("(-2)^2"), 4);
  EXPECT_EQ(value_of("2^-2"), 0.25);
  EXPECT_EQ(value_of("2^-2^2"), 0.0625);
  EXPECT_EQ(value_of("--3"), 3);
  EXPECT_EQ(value_of("2--+3"), 5);
  EXPECT_EQ(value_of("2*-3"), -6);
}

TEST(Expression, CallsFunctions) {
  EXPECT_EQ(value_of("sqrt(16)"), 4);
  EXPECT_EQ(value_of("abs(-3)"), 3);
  EXPECT_EQ(value_of("sin(0)+cos(0)+tan(0)"), 1);
  EXPECT_EQ(value_of("asin(1)"), std::asin(1.0));
  EXPECT_EQ(value_of("acos(0.5)"), std::acos(0.5));
  EXPECT_EQ(value_of("atan(2)"), std::atan(2.0));
  EXPECT_EQ(value_of("atan2(1,-1)"), std::atan2(1.0, -1.0));
  EXPECT_EQ(value_of("exp(0)"), 1);
  EXPECT_EQ(value_of("log(e)"), 1);
  EXPECT_EQ(value_of("log2(8)"), 3);
  EXPECT_EQ(value_of("log10(1000)"), 3);
  EXPECT_EQ(value_of("pow(2, 10)"), 1024);
  EXPECT_EQ(value_of("min(3, 1, 2)"), 1);
  EXPECT_EQ(value_of("max(3, 1, 4, 2)"), 4);
  EXPECT_EQ(value_of("floor(-1.5)"), -2);
  EXPECT_EQ(value_of("ceil(-1.5)"), -1);
  EXPECT_EQ(value_of("round(2.5)"), 3);
  EXPECT_EQ(value_of("sign(-7)+sign(0)"), -1);
  EXPECT_EQ(value_of("hypot(3,4)"), 5);
}

TEST(Expression, LeavesTheDomainAsNaNOrInfinity) {
  EXPECT_TRUE(std::isnan(value_of("sqrt(-1)")));
  EXPECT_TRUE(std::isnan(value_of("0/0")));
  EXPECT_TRUE(std::isinf(value_of("1/0")));
  EXPECT_TRUE(std::isnan(value_of("min(sqrt(-1), 1)")));
  EXPECT_TRUE(std::isnan(value_of("max(1, sqrt(-1))")));
  EXPECT_TRUE(std::isnan(value_of("sign(0/0)")));
}

TEST(Expression, BindsVariables) {
  const std::string_view names[] = {"x", "y1", "e"};
  const Expression parsed = parse_expression("x^2 + 3*y1 - e", names);
  const double values[] = {4, 5, 6};
  EXPECT_EQ(evaluate(parsed, values), 16 + 15 - 6);
  const std::string_view others[] = {"X", "_a", "bZ_"};
  EXPECT_EQ(evaluate(parse_expression("X + _a*bZ_", others), values), 4 + 5 * 6);
}

/// The parsed form can be walked without recursion: operands come first, the last node is the root.
TEST(Expression, ListsOperandsBeforeTheirUsers) {
  const std::string_view names[] = {"x"};
  const Expression parsed = parse_expression("min(x, 2, sin(x)) ^ -3", names);
  for (std::size_t i = 0; i < parsed.nodes.size(); ++i) {
    const ExpressionNode& node = parsed.nodes[i];
    EXPECT_TRUE(operand_count(node.op) == 0 || node.a < i);
    EXPECT_TRUE(operand_count(node.op) >= 2 ? node.b < i : node.b == kNoId);
  }
  EXPECT_EQ(parsed.nodes.back().op, ExpressionOp::power);
}

TEST(Expression, ErrorsCarryTheColumn) {
  const auto expect = [](const std::string& text, int column, const std::string& part) {
    const Failure failure = failure_of(text);
    EXPECT_EQ(failure.column, column) << text << ": " << failure.message;
    EXPECT_NE(failure.message.find(part), std::string::npos) << text << ": " << failure.message;
  };
  expect("", 1, "expected a number, a name or '('");
  expect("2*", 3, "expected a number, a name or '('");
  expect("2 * )", 5, "expected a number, a name or '('");
  expect("1 2", 3, "expected an operator or the end");
  expect("2x", 2, "expected an operator or the end");
  expect("2e", 2, "expected an operator or the end");
  expect("1)", 2, "')' without '('");
  expect("(1+2", 5, "expected ')' for the '(' at column 1");
  expect("3 + sine(1)", 5, "unknown name 'sine'; did you mean 'sin'?");
  expect("sin 1", 5, "expected '(' after sin");
  expect("sin()", 5, "expected a number");
  expect("sin(1,2)", 6, "sin takes 1 argument");
  expect("atan2(1)", 8, "atan2 takes 2 arguments");
  expect("min(1)", 6, "min takes 2 arguments or more");
  expect("hypot(1,2,3)", 10, "hypot takes 2 arguments");
  expect("1e999", 1, "number out of range");
  expect(".", 1, "expected a number");
  expect("1 $ 2", 3, "expected an operator or the end");
  expect(std::string("1\0", 2), 2, "expected an operator or the end");
  expect("inf", 1, "unknown name 'inf'");
}

TEST(Expression, BoundsNestingAndLength) {
  const auto repeat = [](const std::string& part, int n) {
    std::string all;
    for (int i = 0; i < n; ++i) all += part;
    return all;
  };
  for (const char* part : {"(", "-", "2^", "sin(", "min(1,", "(-"}) {
    const Failure failure = failure_of(repeat(part, 1000));
    EXPECT_NE(failure.message.find("nested deeper than 200 levels"), std::string::npos)
        << part << failure.message;
  }
  EXPECT_EQ(value_of(repeat("(", 150) + "7" + repeat(")", 150)), 7);
  EXPECT_EQ(value_of("0" + repeat("+1", 8000)), 8000);
  EXPECT_NE(failure_of(repeat("1", 70000)).message.find("longer than 65536 bytes"), std::string::npos);
}

/// Any text either parses or throws an Error with a column inside it or just behind it.
TEST(Expression, SurvivesAnyText) {
  const bool passed = rc::check("parse or report", [] {
    const auto text = *rc::gen::container<std::string>(rc::gen::element(
        '1', '2', '.', 'e', 'x', 'p', 'i', '+', '-', '*', '/', '^', '(', ')', ',', ' ', 's', 'n'));
    try {
      const std::string_view names[] = {"x"};
      const double values[] = {1.5};
      evaluate(parse_expression(text, names), values);
    } catch (const Error& error) {
      RC_ASSERT(error.where().column >= 1);
      RC_ASSERT(error.where().column <= static_cast<int>(text.size()) + 1);
    }
  });
  EXPECT_TRUE(passed);
}

}  // namespace
}  // namespace oktett::expression_test
