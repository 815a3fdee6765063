/// \file Grids of densities: interpolation, blocks along rays, noise.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/medium/density_noise.h"
#include "render/medium/medium_tracker.h"
#include "tests/render/medium_support.h"

namespace oktett::medium_grid_test {
namespace {

using namespace test;

TEST(DensityGrid, InterpolatesBetweenItsValues) {
  // x + 10 y + 100 z is linear, so interpolation gives it back.
  Column<float> values(3 * 4 * 5);
  for (std::uint32_t i = 0; i < 60; ++i)
    values[i] = static_cast<float>(i % 3 + 10 * (i / 3 % 4) + 100 * (i / 12));
  const DensityGrid grid(3, 4, 5, std::move(values));
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Vec3d p{2 * random(i, 0), 3 * random(i, 1), 4 * random(i, 2)};
    EXPECT_NEAR(grid.at(p), p.x + 10 * p.y + 100 * p.z, 1e-10);
  }
  EXPECT_EQ(grid.at({2, 3, 4}), 432);
  for (const Vec3d& outside : {Vec3d{-1e-9, 1, 1}, {1, 3.001, 1}, {1, 1, 5}, {NAN, 1, 1}, {1e300, 0, 0}})
    EXPECT_EQ(grid.at(outside), 0);
  EXPECT_EQ(grid.most(), 432);
}

TEST(DensityGrid, BadValuesCountAsNothing) {
  Column<float> values(8, 1.0f);
  values[0] = NAN, values[1] = -3, values[2] = INFINITY;
  const DensityGrid grid(2, 2, 2, std::move(values));
  EXPECT_EQ(grid.at({0, 0, 0}), 0);
  EXPECT_EQ(grid.at({1, 0, 0}), 0);
  EXPECT_EQ(grid.at({0, 1, 0}), 0);
  EXPECT_EQ(grid.at({1, 1, 1}), 1);
  EXPECT_EQ(DensityGrid(9, 9, 9, Column<float>(8, 1.0f)).most(), 0) << "too few values";
}

// The spans of blocks follow each other without gaps from where the ray enters the grid to where it leaves
// it, and no density in a span exceeds its bound.
TEST(BlockWalk, CoversTheRayWithBounds) {
  const auto grid = random_grid(40, 9, 23);
  const Vec3d size{39, 8, 22};
  for (std::uint32_t i = 0; i < 3000; ++i) {
    Vec3d origin, direction;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::uint32_t>(axis);
      origin[axis] = size[axis] * (2 * random(i, k) - 0.5), direction[axis] = random(i, 3 + k) - 0.5;
      // Along axes, and from whole numbers, where blocks meet.
      if (random(i, 6 + k) < 0.3) direction[axis] = 0;
      if (random(i, 9 + k) < 0.3) origin[axis] = 8 * std::floor(origin[axis] / 8);
    }
    const double length = 60 * random(i, 20);
    BlockWalk walk(*grid, origin, direction, length);
    double first = -1, last = 0;
    BlockSpan span;
    int count = 0;
    while (walk.next(span)) {
      ASSERT_LT(++count, 30);
      if (first < 0)
        first = span.begin;
      else
        EXPECT_EQ(span.begin, last);
      last = span.end;
      for (int n = 0; n <= 8; ++n) {
        const double t = span.begin + (span.end - span.begin) * n / 8;
        EXPECT_LE(grid->at(origin + direction * t), span.most);
      }
    }
    // Nothing is left out.
    for (int n = 0; n < 200; ++n) {
      const double t = length * (n + 0.5) / 200;
      const bool outside = first < 0 || t < first - 1e-9 || t > last + 1e-9;
      EXPECT_TRUE(!outside || grid->at(origin + direction * t) == 0);
    }
  }
}

// A dense plane on the border of two blocks belongs to both.
TEST(BlockWalk, BordersCountOnBothSides) {
  Column<float> values(17 * 2 * 2, 0.0f);
  for (std::size_t row = 0; row < 4; ++row) values[17 * row + 8] = 1;
  const DensityGrid grid(17, 2, 2, std::move(values));
  BlockWalk walk(grid, {0, 0.5, 0.5}, {1, 0, 0}, 16);
  BlockSpan span;
  for (int block = 0; block < 2; ++block) {
    ASSERT_TRUE(walk.next(span));
    EXPECT_EQ(span.end, 8 * (block + 1));
    EXPECT_EQ(span.most, 1);
  }
  EXPECT_FALSE(walk.next(span));
}

TEST(BlockWalk, EndsForAnyRay) {
  const auto grid = random_grid(20, 20, 20);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double a : {0.0, 1.0, -1e300, 1e-300, static_cast<double>(NAN), inf, 19.0})
    for (const double b : {0.0, -1.0, 1e300, -1e-300, static_cast<double>(NAN), -inf})
      for (const double length : {0.0, 1.0, inf, static_cast<double>(NAN)}) {
        BlockWalk walk(*grid, {a, 5, 5}, {b, 0.5, 0}, length);
        BlockSpan span;
        int count = 0;
        while (walk.next(span)) ASSERT_LT(++count, 20);
      }
}

TEST(DensityNoise, LooksTheSameAlwaysAndStaysInRange) {
  DensityNoise noise;
  noise.size = 24, noise.falloff = 0.5;
  const auto a = density_of(noise), b = density_of(noise);
  noise.seed = 1;
  const auto other = density_of(noise);
  double sum = 0, difference = 0;
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        const Vec3d p{x + 0.0, y + 0.0, z + 0.0};
        const double value = a->at(p);
        EXPECT_TRUE(value >= 0 && value <= 1);
        EXPECT_EQ(value, b->at(p));
        sum += value, difference += std::abs(value - other->at(p));
      }
  EXPECT_GT(sum, 100);
  EXPECT_GT(difference, 0.1 * sum);
  EXPECT_EQ(a->at({0, 0, 0}), 0) << "the corners are faded out";
}

}  // namespace
}  // namespace oktett::medium_grid_test
