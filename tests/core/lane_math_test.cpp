#include "core/lane_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/math.h"
#include "core/random.h"

namespace oktett::lane_math_test {
namespace {

/// Equal bits, or both NaN.
void expect_same(double y, double x) {
  using D = Simd<double, 1, ScalarIsa>;
  const double lane = only_lane(atan2_lanes(D(y), D(x))), one = portable::atan2(y, x);
  EXPECT_TRUE(std::bit_cast<std::uint64_t>(lane) == std::bit_cast<std::uint64_t>(one) ||
              (std::isnan(lane) && std::isnan(one)))
      << y << ", " << x << ": " << lane << " instead of " << one;
}

TEST(LaneMath, AnglesHaveTheBitsOfSingleOnes) {
  const auto sign = [](std::uint64_t key) { return static_cast<double>(mix_bits(key) >> 10) * 0x1p-53 - 1; };
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const int scale = static_cast<int>(mix_bits(3 * i) % 121) - 60;
    expect_same(std::ldexp(sign(3 * i + 1), scale), sign(3 * i + 2));
  }
}

TEST(LaneMath, AnglesOfZerosKeepTheirSigns) {
  const double some[] = {0.0, -0.0, 1.0, -1.0, 0x1p-1060, -0x1p-1060, 1e300, -1e300};
  for (const double y : some)
    for (const double x : some) expect_same(y, x);
}

}  // namespace
}  // namespace oktett::lane_math_test
