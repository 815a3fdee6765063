#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "kernels/exact/implicit.h"
#include "kernels/functions/function_tape.h"
#include "tests/support/random_expression.h"

namespace oktett::implicit_cells_test {
namespace {

double unit(std::mt19937& random) { return (random() + 0.5) / 4294967296.0; }
double between(std::mt19937& random, double lo, double hi) { return lo + (hi - lo) * unit(random); }

std::string ball(double x, double y, double z, double r) {
  const auto square = [](const char* axis, double at) {
    return "(" + std::string(axis) + " - (" + std::to_string(at) + "))^2";
  };
  return "sqrt(" + square("x", x) + " + " + square("y", y) + " + " + square("z", z) + ") - " +
         std::to_string(r);
}

/// Balls joined by `min`, or smoothly.
std::string balls(int count, bool smooth) {
  std::mt19937 random(7);
  std::string text;
  for (int k = 0; k < count; ++k) {
    const auto at = [&] { return between(random, -0.8, 0.8); };
    const double x = at(), y = at(), z = at();
    const std::string next = ball(x, y, z, 0.2);
    if (k == 0)
      text = next;
    else if (smooth)
      text = "min(" + text + ", " + next + ") - max(0.1 - abs(" + text + " - (" + next + ")), 0)^2*2.5";
    else
      text = "min(" + text + ", " + next + ")";
  }
  return text;
}

Implicit::Pool pool_of(const std::string& text, bool open = true) {
  Implicit::Pool pool;
  ImplicitShape s;
  s.function = compile_function(text);
  s.open = open;
  Implicit::add(pool, s, {});
  return pool;
}

bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

TEST(TapeValues, MakeTheSameTapeAgain) {
  std::mt19937 random(3);
  int tapes = 0;
  for (int k = 0; k < 400; ++k) {
    FunctionTape tape;
    try {
      tape = compile_function(random_expression(random, 6));
    } catch (const Error&) {
      continue;  // constants without a value
    }
    ++tapes;
    const TapeValues values = values_of(tape);
    const FunctionTape again = write_tape(values.list, values.root);
    EXPECT_EQ(again.steps.size(), tape.steps.size());
    EXPECT_LE(again.registers, tape.registers);
    EXPECT_EQ(again.varies, tape.varies);
    for (int i = 0; i < 10; ++i) {
      const double x = between(random, -2, 2), y = between(random, -2, 2), z = between(random, -2, 2);
      EXPECT_TRUE(is_same(value_at(again, x, y, z), value_at(tape, x, y, z)));
    }
  }
  EXPECT_GT(tapes, 200);
}

/// In each cell the short tape has the function's values, and the cells hold all zeros.
void expect_cells_hold_the_function(const std::string& text, std::mt19937& random) {
  const Implicit::Pool pool = pool_of(text);
  ASSERT_EQ(pool.elements.size(), 1u);
  const ImplicitElement& e = pool.elements[0];
  if (e.cells == nullptr) return;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p{between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)};
    const double value = value_at(e.function, p.x, p.y, p.z);
    const CellNode& node = e.cells->tree.leaf_at(e.cells->root, p * (1 / e.size));
    if (node.kind == CellNode::Kind::leaf) {
      const double part = value_at(e.cells->tapes[node.first], p.x, p.y, p.z);
      EXPECT_TRUE(is_same(part, value) || std::abs(part - value) <= 1e-14) << part << " for " << value;
    } else if (node.kind == CellNode::Kind::inside) {
      EXPECT_LT(value, 0);
    } else {
      EXPECT_FALSE(value <= 0) << value;
    }
  }
}

TEST(ImplicitCells, ShortTapesHaveTheValuesOfTheFunction) {
  std::mt19937 random(11);
  for (const std::string& text :
       {balls(16, false), balls(6, true), std::string("max(max(abs(x), abs(y)) - 0.5, min(z, 0.3))"),
        std::string("min(sqrt(x) - 0.4, max(log(y + 0.5), z - 0.3))"),
        std::string("min(max(x, 0)*y, max(z, 0.5)*min(x, -0.5))"),
        std::string("max(min(-1, x - 3)*y, min(1, x + 3)^3*z)")}) {
    SCOPED_TRACE(text);
    expect_cells_hold_the_function(text, random);
  }
  for (int k = 0; k < 100; ++k) {
    const std::string text = random_expression(random, 6);
    SCOPED_TRACE(text);
    try {
      if (compile_function(text).varies) expect_cells_hold_the_function(text, random);
    } catch (const Error&) {
      // Constants without a value.
    }
  }
}

/// A part that is certainly zero, one or left out takes no steps.
TEST(ImplicitCells, WhatDoesNotMatterIsLeftOut) {
  for (const bool smooth : {false, true}) {
    const Implicit::Pool pool = pool_of(balls(smooth ? 6 : 16, smooth));
    const ImplicitElement& e = pool.elements[0];
    ASSERT_NE(e.cells, nullptr);
    std::size_t least = e.function.steps.size();
    for (const FunctionTape& tape : e.cells->tapes) least = std::min(least, tape.steps.size());
    // What one ball takes alone.
    EXPECT_EQ(least, compile_function(ball(0.1, 0.2, 0.3, 0.2)).steps.size());
    EXPECT_GT(pool.cells.size(), 20u);
  }
}

/// A function whose branches matter everywhere, and one without branches, have one cell.
TEST(ImplicitCells, NoneWhereTheyWouldNotPay) {
  for (const char* text : {"x^2 + y^2 + z^2 - 0.5", "max(sin(30*x)*sin(30*y), sin(30*z)*sin(31*x))"}) {
    const Implicit::Pool pool = pool_of(text);
    EXPECT_EQ(pool.elements[0].cells, nullptr);
    EXPECT_EQ(pool.cells.size(), 1u);
  }
}

TEST(ImplicitCells, AreSharedByTheSameFunctionInTheSameBox) {
  Implicit::Pool pool = pool_of(balls(16, false));
  const std::size_t cells = pool.cells.size(), bytes = pool.bytes();
  ImplicitShape s;
  s.function = compile_function(balls(16, false));
  s.open = true;
  Implicit::add(pool, s, {});
  EXPECT_EQ(pool.elements[0].cells, pool.elements[1].cells);
  ASSERT_EQ(pool.cells.size(), 2 * cells);
  for (std::size_t k = 0; k < cells; ++k) {
    EXPECT_EQ(pool.cells[cells + k].element, 1u);
    EXPECT_EQ(pool.cells[cells + k].begin, pool.cells[k].begin);
    EXPECT_EQ(pool.cells[cells + k].lo, pool.cells[k].lo);
  }
  EXPECT_LT(pool.bytes(), 2 * bytes);
  s.open = false;
  Implicit::add(pool, s, {});
  EXPECT_NE(pool.elements[1].cells, pool.elements[2].cells);
}

}  // namespace
}  // namespace oktett::implicit_cells_test
