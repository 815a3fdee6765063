#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "kernels/exact/implicit.h"
#include "tests/support/random_expression.h"

namespace oktett::implicit_strides_test {
namespace {

constexpr int kWidth = 4;
using One = Simd<double, 1, ScalarIsa>;
using Lanes = Simd<double, kWidth, ScalarIsa>;

double unit(std::mt19937& random) { return (random() + 0.5) / 4294967296.0; }
Vec3d in_box(std::mt19937& random, double size) {
  return {size * (2 * unit(random) - 1), size * (2 * unit(random) - 1), size * (2 * unit(random) - 1)};
}

/// A sum of waves, or tubes joined by `min` or `max`.
std::string repeated(const std::string& join, int count) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    const std::string a = std::to_string(0.3 + 0.17 * k), b = std::to_string(1.1 + 0.31 * k);
    const std::string part = join == "+" ? "sin(" + a + "*x + " + b + ")*cos(" + b + "*y - z)"
                                         : "hypot(x - sin(" + a + "), hypot(y - cos(" + b + "), z)) - 0.2";
    text = k == 0 ? part : join == "+" ? text + " + " + part : join + "(" + text + ", " + part + ")";
  }
  return text;
}

/// Functions of every temper: smooth, with kinks, steps and poles, almost zero, with crossings close
/// together.
std::vector<std::string> functions() {
  std::vector<std::string> list = {
      "sin(4*x)*cos(4*y) + sin(4*y)*cos(4*z) + sin(4*z)*cos(4*x) - 0.1",
      "max(abs(sin(5*x)*cos(5*y) + sin(5*y)*cos(5*z) + sin(5*z)*cos(5*x)) - 0.25, x^2 + y^2 + z^2 - 1)",
      "x^4 - x^2 + y^4 - y^2 + z^4 - z^2 + 0.46",
      "(x^2 + 9/4*y^2 + z^2 - 0.5)^3 - x^2*z^3 - 9/80*y^2*z^3",
      "sqrt((hypot(x, y) - 0.7)^2 + z^2) - 0.2 - 0.05*sin(9*atan2(y, x) + 3*atan2(z, hypot(x, y) - 0.7))",
      "x^2 + y^2 + z^2 - 0.64",
      "(x^2 + y^2 + z^2 - 0.64)^2",
      "(x^2 + y^2 + z^2 - 0.64)^2 - 1e-4",
      "(x^2 + y^2 + z^2 - 0.64)^2 - 1e-9",
      "(x^2 + y^2 + z^2 - 0.64)^2 - 1e-13",
      "(x^2 + y^2 + z^2 - 0.64)^3",
      "(x^2 + y^2 + z^2)^8 - 0.01",
      "x*y*z",
      "x*y*z - 1e-7",
      "abs(x) - 1e-6",
      "abs(x + y*z) - 1e-8",
      "x - 0.25",
      "y - 0.5*x",
      "z + 1e-9*sin(1000*x)",
      "1e-13*(x + y + z)",
      "1e-300*(x^2 + y^2 - z)",
      "1e9*(x^2 + y^2 - 0.3) + 1e-6",
      "1/x + y",
      "1/(x^2 + y^2) - 3",
      "sqrt(x) - 0.4*y",
      "log(x + 0.3) + z^2",
      "tan(3*x) - y",
      "floor(3*x) + y",
      "round(4*x)/4 - z",
      "asin(x*y*1.2) - 0.2",
      "exp(-20*(x^2 + y^2)) - 0.5 + z^2",
      "abs(x)^1.5 + abs(y)^0.7 + abs(z)^3 - 0.4",
      "min(x^2 + y^2 - 0.1, z^2 + y^2 - 0.1)",
      "max(x^2 + y^2 - 0.3, -(z^2 + y^2 - 0.1))",
      "sin(40*x) + sin(40*y) + sin(40*z)",
      "x^3 - 0.01*x",
      "x^5 - 0.3*x^3 + 0.0001*x + 1e-5*y",
      "x^-2 + y^-2 + z - 9",
      "y - x^z*0.5",
      "y - tan(3*x)*z"};
  // Branches that matter in some cells only, also at the faces of the box and next to what is not defined.
  for (const char* text :
       {"max(max(max(abs(x), abs(y)), abs(z)) - 0.8, 0.2 - hypot(x, y))",
        "min(hypot(x - 0.5, hypot(y, z)) - 0.3, hypot(x + 0.5, hypot(y, z)) - 0.3)"
        " - max(0.5 - abs(hypot(x - 0.5, hypot(y, z)) - hypot(x + 0.5, hypot(y, z))), 0)^2*0.5",
        "max(min(x, min(y, z)) - 0.6, -hypot(x, hypot(y, z)) + 0.5)",
        "min(sqrt(x) - 0.4, max(log(y + 0.5), z - 0.3))", "max(min(floor(4*x)/4 - y, z - 0.7), 1/(x - 0.1))",
        "min(max(x, 0)*y, max(z, 0.5)*min(x, -0.5))", "max(x^2 + y^2 + z^2 - 9, min(-1, x - 0.9))",
        "min(abs(x) - 1e-6, max(abs(y) - 1e-6, abs(z) - 0.5))"})
    list.push_back(text);
  list.push_back(repeated("+", 20));
  list.push_back(repeated("min", 12));
  list.push_back(repeated("max", 12));
  return list;
}

/// A function as it is traced, in cells and by strides; and in one cell without a grid, where intervals find
/// all crossings.
struct Pair {
  Implicit::Pool strides, intervals;

  Pair(const std::string& text, bool open) {
    ImplicitShape s;
    s.function = compile_function(text);
    s.open = open;
    Implicit::add(strides, s, {});
    Implicit::add(intervals, s, {});
    intervals.cells.clear();
    for (ImplicitElement& e : intervals.elements) {
      e.grid = std::make_shared<const VariationGrid>(), e.cells = nullptr;
      add_cell(intervals, e.lo, e.hi);
    }
  }
};

struct Way {
  Vec3d o, d;
  double from;  ///< the least t
};

struct Found {
  double t, turn, part;
};

/// First crossings with the cells of a pool, in lanes.
template <class D>
void first_crossings(const Implicit::Pool& pool, const Way* ways, Found* found) {
  constexpr int W = D::kWidth;
  double column[W];
  const auto lanes = [&](const auto& part) {
    for (int i = 0; i < W; ++i) column[i] = part(ways[i]);
    return D::load(column);
  };
  const Line<D> line{{lanes([](const Way& w) { return w.o.x; }), lanes([](const Way& w) { return w.o.y; }),
                      lanes([](const Way& w) { return w.o.z; })},
                     {lanes([](const Way& w) { return w.d.x; }), lanes([](const Way& w) { return w.d.y; }),
                      lanes([](const Way& w) { return w.d.z; })}};
  const D from = lanes([](const Way& w) { return w.from; });
  for (int i = 0; i < W; ++i) found[i] = {-1, 0, 0};
  for (const ExactCell& cell : pool.cells) {
    LineRange<D> range;
    auto active = clip_line(line, cell.lo, cell.hi, range);
    range.enter_face = select(from > range.a, D(0.0), range.enter_face);
    range.a = max(from, range.a);
    active = active & (range.a <= range.b);
    if (none(active)) continue;
    Crossings<1, D> c;
    Implicit::crossings<1>(pool, cell, line, range, active, c);
    double t[W], turn[W], part[W];
    c.t[0].store(t), c.turn[0].store(turn), c.part[0].store(part);
    const unsigned met = bits(active & (c.t[0] < D(roots::kNoRoot)));
    for (int i = 0; i < W; ++i)
      if ((met >> i & 1) != 0 && (found[i].t < 0 || t[i] < found[i].t)) found[i] = {t[i], turn[i], part[i]};
  }
}

/// Any rays through the box of half-size 1, along its axes and through the borders of cells, far and long
/// ones.
Way any_way(std::mt19937& random) {
  Vec3d from = in_box(random, random() % 3 == 0 ? 1 : 4), to = in_box(random, 1);
  const auto kind = random() % 5;
  if (kind == 0)
    for (int k = 0; k < 3; ++k) {
      from[k] = std::round(from[k] * 4) / 4;
      if (random() % 2) to[k] = from[k];
    }
  Vec3d d = to - from;
  if (kind == 1) d = d * std::exp(20 * (unit(random) - 0.5));
  if (kind == 2) from = from - d * std::exp(20 * unit(random));
  // What tracing makes of rays in float.
  return {Vec3d(Vec3f(from)), Vec3d(Vec3f(d)), 0x1p-151};
}

/// Checks any rays, rays that begin at their hits, and rays almost tangent to the surface there.
void expect_the_same(const Pair& pair, int rays, std::mt19937& random, int& hits) {
  if (pair.strides.elements.empty()) return;
  std::vector<Way> ways;
  std::vector<Found> expected;
  const auto add = [&](const Way& way) {
    const std::uint64_t given_up = interval::uncertified_count();
    Found found;
    first_crossings<One>(pair.intervals, &way, &found);
    // Nothing is expected where intervals have given up.
    if (interval::uncertified_count() == given_up) ways.push_back(way), expected.push_back(found);
    return found;
  };
  while (rays-- > 0) {
    const Way way = any_way(random);
    const Found hit = add(way);
    if (hit.t < 0) continue;
    const Vec3d at(Vec3f(way.o + way.d * hit.t));
    const Slope slope = slope_at<Implicit>(pair.strides, 0, static_cast<int>(hit.part), at);
    if (!std::isfinite(dot(slope.gradient, slope.gradient))) continue;
    const Vec3d n = slope.gradient * (1 / (length(slope.gradient) + 1e-300)), out = in_box(random, 1);
    add({at, out, 0x1p-151});
    add({Vec3d(Vec3f(at + n * 1e-6)), out, 1e-4 * unit(random)});
    const double off = std::exp(-30 * unit(random));
    const Vec3d flat = out - n * dot(out, n) + n * (random() % 2 ? off : -off);
    add({Vec3d(Vec3f(at - flat)), Vec3d(Vec3f(flat)), 0x1p-151});
  }
  while (ways.size() % kWidth != 0) add(any_way(random));
  for (std::size_t i = 0; i < ways.size(); i += kWidth) {
    Found found[kWidth];
    first_crossings<Lanes>(pair.strides, &ways[i], found);
    for (int k = 0; k < kWidth; ++k) {
      const Found& e = expected[i + k];
      const Way& w = ways[i + k];
      hits += e.t >= 0;
      // In a cell the way is shorter, and so is the march's tolerance. A float near 0 tells the two apart.
      const double tolerance = pair.strides.elements[0].cells != nullptr ? 0x1p-40 / length(w.d) : 0;
      ASSERT_TRUE(static_cast<float>(found[k].t) == static_cast<float>(e.t) ||
                  std::abs(found[k].t - e.t) <= tolerance)
          << found[k].t - e.t << " from " << w.o.x << " " << w.o.y << " " << w.o.z << " along " << w.d.x
          << " " << w.d.y << " " << w.d.z << ", t > " << w.from;
      ASSERT_EQ(found[k].turn, e.turn);
      ASSERT_EQ(found[k].part, e.part);
    }
  }
}

/// Crossings found by strides round to the same float as those that intervals find alone.
TEST(ImplicitStrides, FindWhatIntervalsFind) {
  std::mt19937 random(5);
  int hits = 0;
  for (const std::string& text : functions())
    for (const bool open : {false, true}) {
      SCOPED_TRACE(text);
      expect_the_same(Pair(text, open), 100, random, hits);
      if (HasFatalFailure()) return;
    }
  EXPECT_GT(hits, 4000);
}

/// Elements of the same function and box that follow each other have one grid.
TEST(ImplicitStrides, GridsAreShared) {
  Implicit::Pool pool;
  ImplicitShape s;
  s.function = compile_function("(x^2 + y^2 + z^2)^4 - 0.1");
  Implicit::add(pool, s, {});
  const std::size_t one = pool.bytes();
  Implicit::add(pool, s, {});
  EXPECT_EQ(pool.elements[0].grid, pool.elements[1].grid);
  EXPECT_GE(one, pool.elements[0].grid->cells.size() * sizeof(ImplicitGridCell));
  EXPECT_LT(pool.bytes(), 2 * one);
  s.hi.x = 2;
  Implicit::add(pool, s, {});
  EXPECT_NE(pool.elements[1].grid, pool.elements[2].grid);
}

TEST(ImplicitStrides, FindWhatIntervalsFindInRandomFunctions) {
  std::mt19937 random(6);
  int hits = 0;
  for (int k = 0; k < 100; ++k) {
    const std::string text = random_expression(random, 5);
    SCOPED_TRACE(text);
    try {
      expect_the_same(Pair(text, random() % 2), 10, random, hits);
    } catch (const Error&) {
      // Constants without a value.
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(hits, 100);
}

}  // namespace
}  // namespace oktett::implicit_strides_test
