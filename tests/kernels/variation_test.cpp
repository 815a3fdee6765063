#include "kernels/functions/variation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "kernels/exact/implicit_grid.h"
#include "kernels/functions/expression.h"
#include "kernels/functions/function_tape.h"
#include "tests/support/random_expression.h"
#include "verify/oracles/exact_noise.h"

namespace oktett::variation_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;
using I = Interval<D>;
constexpr std::string_view kNames[] = {"x", "y", "z"};

/// The expression in extended precision, by the C library.
long double exact_value(const Expression& e, const long double (&p)[3]) {
  std::vector<long double> v;
  for (const ExpressionNode& n : e.nodes) {
    const int operands = operand_count(n.op);
    const long double a = operands > 0 ? v[n.a] : 0, b = operands > 1 ? v[n.b] : 0;
    const long double c = operands > 2 ? v[n.c] : 0;
    const auto value = [&]() -> long double {
      switch (n.op) {
        case ExpressionOp::constant:
          return n.value;
        case ExpressionOp::variable:
          return p[n.a];
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
        case ExpressionOp::power:
          return std::pow(a, b);
        case ExpressionOp::sqrt:
          return std::sqrt(a);
        case ExpressionOp::abs:
          return std::abs(a);
        case ExpressionOp::sin:
          return std::sin(a);
        case ExpressionOp::cos:
          return std::cos(a);
        case ExpressionOp::tan:
          return std::tan(a);
        case ExpressionOp::asin:
          return std::asin(a);
        case ExpressionOp::acos:
          return std::acos(a);
        case ExpressionOp::atan:
          return std::atan(a);
        case ExpressionOp::atan2:
          return std::atan2(a, b);
        case ExpressionOp::exp:
          return std::exp(a);
        case ExpressionOp::log:
          return std::log(a);
        case ExpressionOp::log2:
          return std::log2(a);
        case ExpressionOp::log10:
          return std::log10(a);
        case ExpressionOp::min:
          return std::min(a, b);
        case ExpressionOp::max:
          return std::max(a, b);
        case ExpressionOp::floor:
          return std::floor(a);
        case ExpressionOp::ceil:
          return std::ceil(a);
        case ExpressionOp::round:
          return std::round(a);
        case ExpressionOp::sign:
          return static_cast<long double>((a > 0) - (a < 0));
        case ExpressionOp::hypot:
          return std::hypot(a, b);
        case ExpressionOp::noise:
          return exact_noise(a, b, c);
        case ExpressionOp::povray_noise:
          return exact_povray_noise(a, b, c);
      }
      return 0;
    };
    v.push_back(value());
  }
  return v.back();
}

/// Whether a part of it has no variables but an operation: its value is rounded when the text is compiled.
bool has_constant_parts(const Expression& e) {
  std::vector<bool> constant;
  for (const ExpressionNode& n : e.nodes) {
    const int operands = operand_count(n.op);
    constant.push_back(n.op != ExpressionOp::variable && (operands < 1 || constant[n.a]) &&
                       (operands < 2 || constant[n.b]) && (operands < 3 || constant[n.c]));
    if (constant.back() && operands > 0) return true;
  }
  return false;
}

/// A random function over a random box, and what is known of it there.
struct Trial {
  std::string text;
  Expression expression;
  FunctionTape tape;
  double lo[3], hi[3];
  Variation<D> over;

  double slope() const { return length(only_lane(over.g)); }
  double bend() const {
    double h[6];
    for (int k = 0; k < 6; ++k) h[k] = only_lane(over.h[k]);
    return std::max({h[0] + h[3] + h[4], h[3] + h[1] + h[5], h[4] + h[5] + h[2]});
  }
  bool known() const {
    return only_lane(over.doubt) == 0 && std::isfinite(only_lane(over.v.lo)) &&
           std::isfinite(only_lane(over.v.hi)) && std::isfinite(slope()) && std::isfinite(bend()) &&
           std::isfinite(only_lane(over.error)) && std::isfinite(only_lane(over.slope_error));
  }
};

double unit(std::mt19937& random) { return (random() + 0.5) / 4294967296.0; }

/// Calls `check` for trials of which something is known; returns how many there were.
template <class F>
int each_known(int seed, int count, const F& check) {
  std::mt19937 random(seed);
  int known = 0;
  for (int k = 0; k < count; ++k) {
    Trial t;
    t.text = random_expression(random, 4);
    try {
      t.tape = compile_function(t.text);
    } catch (const Error&) {
      continue;
    }
    t.expression = parse_expression(t.text, kNames);
    if (has_constant_parts(t.expression)) continue;
    const double size = random() % 2 ? 0.03 : 1;
    Variation<D> axis[3];
    for (int i = 0; i < 3; ++i) {
      t.lo[i] = 4 * unit(random) - 2, t.hi[i] = t.lo[i] + size * unit(random);
      axis[i] = variation::constant(D(0.0));
      axis[i].v = {D(t.lo[i]), D(t.hi[i])}, axis[i].error = D(3 * 0x1p-47);
      (i == 0 ? axis[i].g.x : i == 1 ? axis[i].g.y : axis[i].g.z) = D(1.0);
    }
    t.over = run_tape(t.tape, axis[0], axis[1], axis[2]);
    if (!t.known()) continue;
    ++known;
    check(t, random);
    if (testing::Test::HasFatalFailure()) return known;
  }
  return known;
}

/// Values in plain arithmetic are off by at most the error, and the enclosure of a value is no wider.
TEST(Variation, ErrorsHold) {
  const int known = each_known(11, 40000, [](const Trial& t, std::mt19937& random) {
    const double error = only_lane(t.over.error) * (1 + 0x1p-20) + 0x1p-900;
    for (int i = 0; i < 20; ++i) {
      double p[3];
      long double exact[3];
      for (int j = 0; j < 3; ++j) exact[j] = p[j] = t.lo[j] + (t.hi[j] - t.lo[j]) * unit(random);
      const long double truth = exact_value(t.expression, exact);
      ASSERT_LE(std::abs(value_at(t.tape, p[0], p[1], p[2]) - truth), error) << t.text;
      const I at = run_tape(t.tape, I(D(p[0])), I(D(p[1])), I(D(p[2])));
      ASSERT_LE(only_lane(at.hi) - only_lane(at.lo), 2 * error) << t.text;
      ASSERT_LE(only_lane(t.over.v.lo), truth) << t.text;
      ASSERT_GE(only_lane(t.over.v.hi), truth) << t.text;
    }
  });
  EXPECT_GT(known, 2000);
}

/// From any point the function stays between the parabolas, and between the lines, that the bounds allow.
TEST(Variation, ParabolasHold) {
  int kinks = 0, tight = 0;
  const int known = each_known(12, 40000, [&](const Trial& t, std::mt19937& random) {
    kinks += only_lane(t.over.falls) > 0 || only_lane(t.over.rises) > 0;
    for (int i = 0; i < 20; ++i) {
      double p[3], d[3], length = 0;
      long double to[3];
      // Half of the pairs are close.
      const double reach = i % 2 ? 1 : 0x1p-8;
      for (int j = 0; j < 3; ++j) {
        p[j] = t.lo[j] + (t.hi[j] - t.lo[j]) * unit(random);
        const double q = t.lo[j] + (t.hi[j] - t.lo[j]) * unit(random);
        d[j] = (q - p[j]) * reach, to[j] = static_cast<long double>(p[j]) + d[j], length += d[j] * d[j];
      }
      length = std::sqrt(length);
      using G = Gradient<D, Walls::flat, D>;
      const G f = run_tape(t.tape, G{D(p[0]), D(d[0])}, G{D(p[1]), D(d[1])}, G{D(p[2]), D(d[2])});
      const long double v = only_lane(f.v), rate = only_lane(f.d), there = exact_value(t.expression, to);
      const long double slack = only_lane(t.over.error) * 4 + only_lane(t.over.slope_error) * length * 2;
      ASSERT_LE(std::abs(there - v), t.slope() * length * (1 + 0x1p-20) + slack) << t.text;
      const long double bend = t.bend() * length * length / 2 * (1 + 0x1p-20), off = there - (v + rate);
      ASSERT_GE(off, -bend - slack - only_lane(t.over.falls)) << t.text;
      ASSERT_LE(off, bend + slack + only_lane(t.over.rises)) << t.text;
      tight += i % 2 && std::abs(off) > 0.1L * bend && bend > slack;
    }
  });
  EXPECT_GT(known, 2000);
  EXPECT_GT(kinks, 60);
  EXPECT_GT(tight, 1000);
}

/// A cell of one sign says so; grids refine where that pays, and never beyond their limit.
TEST(Variation, Grids) {
  const auto grid = [](const std::string& text, double size) {
    return make_variation_grid(compile_function(text), {-size, -size, -size}, {size, size, size});
  };
  EXPECT_EQ(grid("x^2 + y^2 + z^2 - 1", 2).side, 1);
  const VariationGrid steep = grid("(x^2 + y^2 + z^2)^4 - 1", 2);
  EXPECT_GT(steep.side, 1);
  EXPECT_LE(steep.side, kMostGridSide);
  ASSERT_EQ(steep.cells.size(), static_cast<std::size_t>(steep.side * steep.side * steep.side));
  EXPECT_EQ(steep.cells.front().slope, 0);
  EXPECT_TRUE(std::ranges::any_of(steep.cells, [](const ImplicitGridCell& c) { return c.slope > 0; }));
  EXPECT_TRUE(grid("z + 1/x + 1/y", 1).cells.empty());
  EXPECT_FALSE(grid("x + 0.01/(y + 1.2)", 1).cells.empty());
  std::string heavy = "sin(x)";
  for (int k = 0; k < 70; ++k) heavy += "+ abs(x*" + std::to_string(k) + " - y)";
  EXPECT_LE(grid(heavy, 1).side, kMostGridSide / 2);
  EXPECT_TRUE(grid("x", 1e-310).cells.empty());
}

}  // namespace
}  // namespace oktett::variation_test
