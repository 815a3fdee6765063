#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"

namespace oktett::sampling_test {
namespace {

/// The second dimension of Sobol's sequence by its recurrence of direction numbers (Bratley, Fox 1988, whose
/// primitive polynomial is x + 1), as an integer whose top bit is worth 1/2.
std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t sum = 0;
  for (std::uint32_t direction = 1u << 31; index != 0; index >>= 1, direction ^= direction >> 1)
    if (index & 1) sum ^= direction;
  return sum;
}

TEST(OwenSobol, ReversesBits) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto x = static_cast<std::uint32_t>(mix_bits(i));
    std::uint32_t turned = 0;
    for (int k = 0; k < 32; ++k) turned |= (x >> k & 1u) << (31 - k);
    ASSERT_EQ(reversed_bits(x), turned);
  }
}

TEST(OwenSobol, HasTheDirectionNumbersOfSobol) {
  for (std::uint32_t i = 0; i < 5000; ++i) {
    ASSERT_EQ(reversed_bits(pascal_product(i)), sobol_second(i));
    const auto x = static_cast<std::uint32_t>(mix_bits(i));
    ASSERT_EQ(reversed_bits(pascal_product(x)), sobol_second(x));
  }
}

// An Owen scrambling permutes the halves of each interval: two numbers that agree in their first k binary
// digits agree in as many afterwards, and no more.
TEST(OwenSobol, ScramblesIntervalsOfAllSizes) {
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto seed = static_cast<std::uint32_t>(mix_bits(i));
    const auto a = static_cast<std::uint32_t>(mix_bits(i + 77777));
    for (int k = 0; k < 32; ++k) {
      const std::uint32_t b = a ^ 1u << k;
      const std::uint32_t differs = scrambled_upwards(a, seed) ^ scrambled_upwards(b, seed);
      ASSERT_EQ(differs & ((2u << k) - 1), 1u << k);
    }
  }
}

// The definition of a (0, 2)-sequence in base 2: of each block of 2^m points, one stands in every cell of
// every grid of 2^a by 2^(m-a).
TEST(OwenSobol, EachCellOfEveryGridHoldsOnePoint) {
  for (std::uint64_t key = 0; key < 20; ++key)
    for (int m = 0; m <= 10; ++m)
      for (int a = 0; a <= m; ++a)
        for (const std::uint32_t block : {0u, 1u, 5u}) {
          const std::uint32_t n = 1u << m, columns = 1u << a, rows = n / columns;
          std::vector<int> cells(n);
          for (std::uint32_t i = 0; i < n; ++i) {
            const SquareSample s = sobol_point(block * n + i, mix_bits(key));
            ASSERT_TRUE(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1);
            ++cells[static_cast<std::size_t>(s.y * rows) * columns + static_cast<std::size_t>(s.x * columns)];
          }
          for (const int count : cells) ASSERT_EQ(count, 1) << key << ' ' << m << ' ' << a;
        }
}

TEST(OwenSobol, NumbersAreTheFirstCoordinates) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const double x = sobol_point(i, mix_bits(i / 7)).x;
    ASSERT_EQ(static_cast<double>(sobol_number(i, mix_bits(i / 7))), std::floor(x * 0x1p24) * 0x1p-24);
  }
}

// The first point of a sequence is uniform over the keys: 64 equal cells are met equally often within 5
// sigma.
TEST(OwenSobol, FirstPointsAreUniformOverTheKeys) {
  constexpr int kKeys = 64 * 400;
  for (const std::uint32_t sample : {0u, 1u, 37u}) {
    std::vector<int> cells(64);
    for (std::uint64_t key = 0; key < kKeys; ++key) {
      const SquareSample s = sobol_point(sample, mix_bits(key));
      ++cells[static_cast<std::size_t>(s.y * 8) * 8 + static_cast<std::size_t>(s.x * 8)];
    }
    for (const int count : cells) EXPECT_NEAR(count, 400, 100) << sample;
  }
}

// Points of two keys are uncorrelated. Within a block the orders keep neighbours together, so the sum of
// products varies more than that of independent points, but by less than a factor of 2. In a common order it
// would be some 37 times that.
TEST(OwenSobol, SequencesAreIndependent) {
  constexpr std::uint32_t kCount = 64;
  constexpr int kPairs = 2000;
  double sum = 0, square = 0;
  for (std::uint64_t pair = 0; pair < kPairs; ++pair) {
    double product = 0;
    for (std::uint32_t i = 0; i < kCount; ++i)
      product += (sobol_point(i, sequence_key(mix_bits(pair), 1)).x - 0.5) *
                 (sobol_point(i, sequence_key(mix_bits(pair), 2)).x - 0.5);
    sum += product, square += product * product;
  }
  const double mean = sum / kPairs, sigma = std::sqrt(square / kPairs / kPairs);
  EXPECT_LT(std::abs(mean), 5 * sigma);
  const double independent = kCount / 144.0;
  EXPECT_GT(square / kPairs, 0.5 * independent);
  EXPECT_LT(square / kPairs, 2 * independent);
}

// A linear function integrates with an error far below that of independent random points.
TEST(OwenSobol, IntegratesBetterThanChance) {
  double worst = 0;
  for (std::uint64_t key = 0; key < 50; ++key) {
    double sum = 0;
    for (std::uint32_t i = 0; i < 64; ++i) {
      const SquareSample s = sobol_point(i, mix_bits(key));
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
    const Vec3f d = cosine_direction(n, sobol_point(i, 99));
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
}  // namespace oktett::sampling_test
