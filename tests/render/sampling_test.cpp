#include "render/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"

namespace oktett {
namespace {

int cell(double x, std::uint32_t cells) { return static_cast<int>(x * cells); }

TEST(StratifiedSample, OneIsTheCentre) {
  const SquareSample s = stratified_sample(0, 1, 1234);
  EXPECT_EQ(s.x, 0.5);
  EXPECT_EQ(s.y, 0.5);
}

// Any count: every row of `count` holds one point. Counts that fill their grid: every cell, and every column
// of `count` too.
TEST(StratifiedSample, EachStratumHoldsExactlyOnePoint) {
  for (const std::uint32_t n :
       {2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u, 11u, 12u, 13u, 16u, 20u, 25u, 64u, 81u, 1000u})
    for (std::uint64_t key = 0; key < 10; ++key) {
      const auto columns = static_cast<std::uint32_t>(std::sqrt(n)), rows = (n + columns - 1) / columns;
      std::vector<int> fine_x(columns * rows), fine_y(n), cells(columns * rows);
      for (std::uint32_t i = 0; i < n; ++i) {
        const SquareSample s = stratified_sample(i, n, mix_bits(key));
        ASSERT_TRUE(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1);
        ++fine_x[cell(s.x, columns * rows)];
        ++fine_y[cell(s.y, n)];
        ++cells[cell(s.y, rows) * columns + cell(s.x, columns)];
      }
      for (const int count : fine_y) ASSERT_EQ(count, 1) << n;
      for (const int count : fine_x) ASSERT_LE(count, 1) << n;
      if (columns * rows != n) continue;
      for (const int count : cells) ASSERT_EQ(count, 1) << n;
    }
}

TEST(StratifiedSample, PatternsDiffer) {
  int same = 0;
  for (std::uint64_t key = 0; key < 100; ++key)
    if (stratified_sample(0, 16, mix_bits(key)).x == stratified_sample(0, 16, mix_bits(key + 1)).x) ++same;
  EXPECT_EQ(same, 0);
}

// A linear function integrates with an error far below that of independent random points.
TEST(StratifiedSample, IntegratesBetterThanChance) {
  double worst = 0;
  for (std::uint64_t key = 0; key < 50; ++key) {
    double sum = 0;
    for (std::uint32_t i = 0; i < 64; ++i) {
      const SquareSample s = stratified_sample(i, 64, mix_bits(key));
      sum += s.x + s.y;
    }
    worst = std::max(worst, std::abs(sum / 64 - 1));
  }
  EXPECT_LT(worst, 0.01);
}

TEST(CosineDirection, HasTheDensityOfLambertsLaw) {
  const Vec3f n = normalize(Vec3f{1, -2, 0.5f});
  double mean = 0, mean_square = 0;
  Vec3f sum;
  constexpr std::uint32_t kCount = 4096;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Vec3f d = cosine_direction(n, stratified_sample(i, kCount, 99));
    EXPECT_NEAR(length(d), 1, 1e-6f);
    const double c = dot(d, n);
    ASSERT_GE(c, 0);
    mean += c / kCount, mean_square += c * c / kCount;
    sum += d;
  }
  EXPECT_NEAR(mean, 2 / 3.0, 1e-3);
  EXPECT_NEAR(mean_square, 0.5, 1e-3);
  EXPECT_LT(length(sum / static_cast<float>(kCount) - n * (2 / 3.0f)), 0.01f);
}

}  // namespace
}  // namespace oktett
