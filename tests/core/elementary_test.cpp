#include "core/elementary.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/math.h"
#include "core/random.h"

namespace oktett::elementary_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;

/// Equal bits, or both NaN.
bool same(const D& lane, double one) {
  const double x = only_lane(lane);
  return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(one) ||
         (std::isnan(x) && std::isnan(one));
}

void expect_same(double y, double x) {
  EXPECT_TRUE(same(atan2_lanes(D(y), D(x)), portable::atan2(y, x))) << y << ", " << x;
}

/// From -1 to 1.
double sign(std::uint64_t key) { return static_cast<double>(mix_bits(key) >> 10) * 0x1p-53 - 1; }

TEST(LaneMath, ArcSinesHaveTheBitsOfSingleOnes) {
  for (const double x : {0.0, -0.0, 1.0, -1.0, 0x1p-1060})
    EXPECT_TRUE(same(asin_lanes(D(x)), portable::asin(x))) << x;
  for (std::uint64_t i = 0; i < 20000; ++i)
    EXPECT_TRUE(same(asin_lanes(D(sign(i))), portable::asin(sign(i)))) << sign(i);
}

TEST(LaneMath, AnglesHaveTheBitsOfSingleOnes) {
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
}  // namespace oktett::elementary_test
