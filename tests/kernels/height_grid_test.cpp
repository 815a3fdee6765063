#include "kernels/heights/height_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "kernels/heights/height_cell.h"

namespace oktett::height_grid_test {
namespace {

std::shared_ptr<const HeightGrid> random_grid(std::uint32_t columns, std::uint32_t rows, bool words,
                                              HeightInterpolation interpolation) {
  const std::size_t count = std::size_t{columns} * rows;
  const auto value = [&](std::size_t i) { return random_float(3, columns + 1000 * rows, i); };
  if (words) {
    Column<std::uint16_t> w(count);
    for (std::size_t i = 0; i < count; ++i) w[i] = static_cast<std::uint16_t>(value(i) * 65535);
    return HeightGrid::from_words(columns, rows, std::move(w), interpolation);
  }
  Column<float> f(count);
  for (std::size_t i = 0; i < count; ++i) f[i] = 1e-3f * value(i) - 7;
  return HeightGrid::from_floats(columns, rows, std::move(f), interpolation);
}

constexpr std::uint32_t kSizes[][2] = {{2, 2}, {5, 5}, {6, 3}, {17, 17}, {18, 33}, {2, 100}, {67, 41}};

/// No block of any level leaves out a sample on which the surface over its cells depends, and words are
/// bounded exactly.
TEST(HeightGrid, PyramidBoundsEverySample) {
  for (const auto& size : kSizes)
    for (const bool words : {false, true})
      for (const auto interpolation : {HeightInterpolation::nearest, HeightInterpolation::bilinear}) {
        const auto grid = random_grid(size[0], size[1], words, interpolation);
        const int ring = interpolation == HeightInterpolation::nearest ? 1 : 0;
        for (int k = 0; k < grid->levels(); ++k) {
          const HeightGrid::Level& level = grid->level(k);
          const int side = static_cast<int>(level.side);
          const std::uint32_t split = level.split;
          for (std::uint32_t j = 0; j < level.block_rows; ++j)
            for (std::uint32_t i = 0; i < level.block_columns; ++i) {
              const HeightNode& node = grid->node(k, i / split, j / split);
              const std::size_t block = i % split + 4 * (j % split);
              double lo = HUGE_VAL, hi = -HUGE_VAL;
              const int x0 = static_cast<int>(i) * side, z0 = static_cast<int>(j) * side;
              for (int z = std::max(z0 - ring, 0); z <= std::min<int>(z0 + side + ring, size[1] - 1); ++z)
                for (int x = std::max(x0 - ring, 0); x <= std::min<int>(x0 + side + ring, size[0] - 1); ++x) {
                  const double h = grid->at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(z));
                  lo = std::min(lo, h), hi = std::max(hi, h);
                }
              const double below = grid->least() + grid->step() * node.least[block];
              const double above = grid->least() + grid->step() * node.greatest[block];
              EXPECT_LE(below, lo + 1e-12);
              EXPECT_GE(above, hi - 1e-12);
              // Tight: a step at most, and a level's own share for rounding.
              EXPECT_GE(below, lo - 1.01 * grid->step() * (words ? 0 : 1));
              EXPECT_LE(above, hi + 1.01 * grid->step() * (words ? 0 : 1));
            }
          // Beyond the field there are no blocks.
          for (std::uint32_t j = 0; j < level.rows; ++j)
            for (std::uint32_t i = 0; i < level.columns; ++i)
              for (std::uint32_t b = 0; b < 16; ++b) {
                const bool in_node = b % 4 < split && b / 4 < split;
                const bool in_field =
                    in_node && level.has_block(level.block_column(i, b), level.block_row(j, b));
                const HeightNode& node = grid->node(k, i, j);
                if (!in_field) {
                  EXPECT_GT(node.least[b], node.greatest[b]);
                }
              }
        }
        EXPECT_EQ(grid->level(grid->levels() - 1).columns, 1u);
        EXPECT_EQ(grid->level(grid->levels() - 1).rows, 1u);
      }
}

/// Tiles hold 81 samples for each 64 of the field.
TEST(HeightGrid, TilesAndPyramidAddLittle) {
  const auto words = random_grid(1025, 1025, true, HeightInterpolation::bilinear);
  const auto floats = random_grid(1025, 1025, false, HeightInterpolation::bilinear);
  const double samples = 1025.0 * 1025;
  EXPECT_LT(static_cast<double>(words->bytes()), samples * 2 * (81.0 / 64 + 2.0 / 15) * 1.001);
  EXPECT_LT(static_cast<double>(floats->bytes()), samples * 4 * (81.0 / 64 + 1.0 / 15) * 1.001);
}

/// Samples on the borders of tiles stand in several of them.
TEST(HeightGrid, KeepsEverySample) {
  std::vector<std::array<std::uint32_t, 2>> sizes = {{1, 1}, {1, 9}, {9, 1}, {8, 8}, {9, 9}, {10, 8}};
  for (const auto& size : kSizes) sizes.push_back({size[0], size[1]});
  for (const auto& [columns, rows] : sizes) {
    Column<std::uint16_t> samples(std::size_t{columns} * rows);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::uint16_t>(3 * i + 1);
    const auto grid = HeightGrid::from_words(columns, rows, samples, HeightInterpolation::triangles);
    for (std::uint32_t j = 0; j < rows; ++j)
      for (std::uint32_t i = 0; i < columns; ++i) {
        ASSERT_EQ(grid->at(i, j), samples[i + std::size_t{j} * columns]) << i << " " << j;
        if (i + 1 == columns || j + 1 == rows) continue;
        const CellCorners<double> c(*grid, i, j);
        const double row = 3.0 * columns;
        ASSERT_EQ(c.h10 - c.h00, 3) << i << " " << j;
        ASSERT_EQ(c.h01 - c.h00, row) << i << " " << j;
        ASSERT_EQ(c.h11 - c.h00, row + 3) << i << " " << j;
        using D = Simd<double, 4, ScalarIsa>;
        const CellCorners<D> lanes(*grid, D(static_cast<double>(i)), D(static_cast<double>(j)));
        for (int k = 0; k < 4; ++k) {
          ASSERT_EQ(only_lane(lane_of(lanes.h00, k)), c.h00);
          ASSERT_EQ(only_lane(lane_of(lanes.h10, k)), c.h10);
          ASSERT_EQ(only_lane(lane_of(lanes.h01, k)), c.h01);
          ASSERT_EQ(only_lane(lane_of(lanes.h11, k)), c.h11);
        }
      }
  }
}

TEST(HeightGrid, LevelFieldsHaveOneHeight) {
  const auto grid = HeightGrid::from_floats(9, 3, Column<float>(27, -2.5f), HeightInterpolation::triangles);
  EXPECT_EQ(grid->least(), -2.5);
  EXPECT_EQ(grid->greatest(), -2.5);
  for (int k = 0; k < grid->levels(); ++k) {
    EXPECT_EQ(grid->node(k, 0, 0).least[0], 0);
    EXPECT_EQ(grid->node(k, 0, 0).greatest[0], 0);
  }
}

}  // namespace
}  // namespace oktett::height_grid_test
