#include "core/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>
#include <vector>

namespace oktett::random_test {
namespace {

TEST(Random, DependsOnEveryPartOfItsPlace) {
  std::set<std::uint64_t> seen;
  for (std::uint32_t seed = 0; seed < 4; ++seed)
    for (std::uint64_t pixel = 0; pixel < 32; ++pixel)
      for (std::uint32_t sample = 0; sample < 16; ++sample)
        for (std::uint32_t dimension = 0; dimension < 16; ++dimension)
          seen.insert(random_bits(pixel_key(seed, pixel), sample, dimension));
  EXPECT_EQ(seen.size(), 4u * 32 * 16 * 16);
}

TEST(Random, IsTheSameEverywhere) {
  // Frozen: other numbers mean other pictures.
  EXPECT_EQ(mix_bits(0x9e3779b97f4a7c15ull),
            0xe220a8397b1dcdafull);  // first output of SplitMix64 from state 0
  EXPECT_EQ(random_bits(0, 0, 0), 0xe220a8397b1dcdafull);
  EXPECT_EQ(random_bits(0, 0, 1), 0x6e789e6aa1b965f4ull);
}

// Chi-squared over 64 bins in each of several directions of the key space; 63 degrees of freedom, standard
// deviation 11.2.
TEST(Random, IsUniformAlongEachCoordinate) {
  constexpr int kCount = 64000;
  for (int along = 0; along < 4; ++along) {
    int bins[64] = {};
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const float u = along == 0   ? random_float(pixel_key(i, 7), 3, 5)
                      : along == 1 ? random_float(pixel_key(7, i), 3, 5)
                      : along == 2 ? random_float(pixel_key(7, 3), i, 5)
                                   : random_float(pixel_key(7, 3), 5, i);
      ASSERT_GE(u, 0);
      ASSERT_LT(u, 1);
      ++bins[static_cast<int>(u * 64)];
    }
    double chi = 0;
    for (const int n : bins) chi += (n - kCount / 64.0) * (n - kCount / 64.0) / (kCount / 64.0);
    EXPECT_GT(chi, 63 - 4 * 11.2) << along;
    EXPECT_LT(chi, 63 + 5 * 11.2) << along;
  }
}

TEST(Random, NeighboursAreUncorrelated) {
  double sum = 0;
  constexpr int kCount = 100000;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double a = random_float(pixel_key(0, i), 0, 0) - 0.5,
                 b = random_float(pixel_key(0, i + 1), 0, 0) - 0.5;
    sum += a * b;
  }
  EXPECT_LT(std::abs(sum / kCount * 12), 5 / std::sqrt(kCount));
}

}  // namespace
}  // namespace oktett::random_test
