/// \file Sweeps of spheres against values that are known.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/accel/all_crossings.h"

namespace oktett::sphere_sweeps_test {
namespace {

using Curve = SphereSweepShape::Curve;

constexpr float kInf = std::numeric_limits<float>::infinity();

std::vector<Hit> crossings(const SphereSweepShape& s, const Vec3f& o, const Vec3f& d) {
  return all_crossings(s, {o, 0, d, kInf});
}

void expect_at(const std::vector<Hit>& hits, const std::vector<float>& t) {
  ASSERT_EQ(hits.size(), t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(hits[i].t, t[i], 1e-6f * std::abs(t[i]));
    EXPECT_EQ(hits[i].v, i % 2 == 0 ? -1 : 1);
  }
}

/// A capsule has the crossings of its balls and its cylinder; pieces that meet make no walls.
TEST(SphereSweeps, Capsules) {
  SphereSweepShape s;
  s.spheres = {{{-1, 0, 0}, 0.5}, {{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.5}, {{1, 0, 0}, 0.5}};
  expect_at(crossings(s, {-4, 0, 0}, {1, 0, 0}), {2.5f, 5.5f});
  expect_at(crossings(s, {0.25f, 4, 0}, {0, -1, 0}), {3.5f, 4.5f});
  expect_at(crossings(s, {0, 4, 0.3f}, {0, -2, 0}), {1.8f, 2.2f});
  expect_at(crossings(s, {1.3f, 4, 0}, {0, -1, 0}), {3.6f, 4.4f});
  EXPECT_TRUE(crossings(s, {0, 4, 0.5001f}, {0, -1, 0}).empty());
}

/// A cone from a tip: along its axis, across it, and through the tip.
TEST(SphereSweeps, Tips) {
  SphereSweepShape s;
  s.spheres = {{{0, 0, 0}, 0}, {{2, 0, 0}, 1}};
  expect_at(crossings(s, {-1, 0, 0}, {1, 0, 0}), {1, 4});
  // Half the angle at the tip is 30 degrees.
  const float r = std::tan(std::asin(0.5f));
  expect_at(crossings(s, {1, 2, 0}, {0, -1, 0}), {2 - r, 2 + r});
  // A sphere inside of the next one adds nothing.
  s.spheres = {{{0, 0, 0}, 0.2}, {{0.1, 0, 0}, 1}};
  expect_at(crossings(s, {-2, 0, 0}, {1, 0, 0}), {1.1f, 3.1f});
  expect_at(crossings(s, {0.1f, 2, 0}, {0, -1, 0}), {1, 3});
}

/// Heights measured with another ray tracer, whose splines these are.
TEST(SphereSweeps, CurvesGoThroughTheirSpheres) {
  SphereSweepShape s;
  s.spheres = {{{0, 0, 0}, 0.1}, {{1, 0, 0}, 0.2}, {{2, 1, 0}, 0.3}, {{3, 0.5, 1}, 0.2}, {{4, 0, 0}, 0.1}};
  const struct {
    Curve curve;
    std::vector<double> heights;
  } kCases[] = {
      {Curve::cubic,
       {0.165869497430, 0.444335427640, 0.802873655362, 1.113410669994, 1.278409622127, 1.304190318700,
        1.174349770261}},
      {Curve::b_spline,
       {0.332521924596, 0.517803284815, 0.721687055997, 0.889121487700, 0.980447890422, 0.966340103870}}};
  for (const auto& c : kCases) {
    s.curve = c.curve;
    for (std::size_t i = 0; i < c.heights.size(); ++i) {
      const auto hits = crossings(s, {0.9f + 0.25f * static_cast<float>(i), 5, 0.05f}, {0, -1, 0});
      ASSERT_FALSE(hits.empty());
      EXPECT_NEAR(5 - hits[0].t, c.heights[i], 1e-6);
    }
  }
  s.curve = Curve::linear;
  const double linear[][2] = {{-0.05, 0.070710678119}, {0.2, 0.109751786070},  {0.45, 0.136884527020},
                              {0.7, 0.163376617641},   {0.95, 0.238362002606}, {1.2, 0.527584879423},
                              {1.95, 1.291547594742}};
  for (const auto& [x, y] : linear) {
    const auto hits = crossings(s, {static_cast<float>(x), 5, 0.05f}, {0, -1, 0});
    ASSERT_FALSE(hits.empty());
    EXPECT_NEAR(5 - hits[0].t, y, 1e-6);
  }
}

}  // namespace
}  // namespace oktett::sphere_sweeps_test
