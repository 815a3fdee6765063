#include "core/simd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/limits.h"

namespace oktett::simd_floats_test {
namespace {

constexpr float kMax = std::numeric_limits<float>::max(), kMin = std::numeric_limits<float>::denorm_min();

/// Random bits, mixed with numbers at the ends of ranges.
float any_float(std::mt19937& random) {
  const float ends[] = {0.0f, -0.0f, kInf, -kInf, kMax, -kMax, kMin, -kMin, 0x1p-126f, -0x1p-126f, NAN};
  return random() % 4 == 0 ? ends[random() % 11] : std::bit_cast<float>(static_cast<std::uint32_t>(random()));
}

/// next_float is std::nextafter towards the infinity that the direction's sign names.
TEST(SimdFloats, NextFloatIsTheNeighbourInTheDirectionOfTheSign) {
  using F = Simd<float, 8, ScalarIsa>;
  std::mt19937 random(1);
  for (int n = 0; n < 20000; ++n) {
    float a[8], direction[8], next[8];
    for (int i = 0; i < 8; ++i) a[i] = any_float(random), direction[i] = any_float(random);
    next_float(F::load(a), F::load(direction)).store(next);
    for (int i = 0; i < 8; ++i) {
      const float d = direction[i];
      if (std::isnan(d)) continue;
      const float expected = d > 0 ? std::nextafter(a[i], kInf) : d < 0 ? std::nextafter(a[i], -kInf) : a[i];
      if (std::isnan(a[i]))
        ASSERT_TRUE(std::isnan(next[i]));
      else if (expected == 0)
        ASSERT_EQ(next[i], 0.0f) << a[i] << " towards " << d;
      else
        ASSERT_EQ(std::bit_cast<std::uint32_t>(next[i]), std::bit_cast<std::uint32_t>(expected))
            << a[i] << " towards " << d;
    }
  }
}

/// has_bits tells the lanes in which a number has any of the bits asked for.
// Undefined for plain numbers, so the sanitizer complains if a lane computes in their type.
TEST(SimdFloats, WholeNumbersOfOneLaneWrapAround) {
  using I = Simd<std::int32_t, 1, ScalarIsa>;
  const std::int32_t least = std::numeric_limits<std::int32_t>::min();
  const auto value = [](const I& lane) {
    std::int32_t v;
    lane.store(&v);
    return v;
  };
  EXPECT_EQ(value(I(least) - I(1)), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(value(I(std::numeric_limits<std::int32_t>::max()) + I(1)), least);
  EXPECT_EQ(value(I(least) * I(-1)), least);
}

TEST(SimdFloats, HasBitsComparesEachLane) {
  using I = Simd<std::int32_t, 8, ScalarIsa>;
  const std::int32_t numbers[8] = {0, 1, 2, 3, 4, -1, INT32_MIN, 6};
  EXPECT_EQ(bits(has_bits(I::load(numbers), 2)), 0b10101100u);
  EXPECT_EQ(bits(has_bits(I::load(numbers), INT32_MIN)), 0b01100000u);
  EXPECT_EQ(bits(has_bits(I::load(numbers), 0)), 0u);
}

}  // namespace
}  // namespace oktett::simd_floats_test
