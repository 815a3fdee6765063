#include "core/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

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

/// From -1 to 1.
double sign(std::uint64_t key) { return static_cast<double>(mix_bits(key) >> 10) * 0x1p-53 - 1; }

/// How far off `lane` is, in halves of the last place of a number of its size.
double off(const D& lane, long double truth) {
  const double x = only_lane(lane);
  return static_cast<double>(std::abs(x - truth) / std::ldexp(1.0L, std::ilogb(x) - 53));
}

// The oracle is the library in long double. The bound is 2^-49 of the size of the angle.
TEST(LaneMath, AnglesFollowTheLibrary) {
  double worst = 0;
  for (std::uint64_t i = 0; i < 100000; ++i) {
    const double y = std::ldexp(sign(3 * i), static_cast<int>(mix_bits(i) % 121) - 60), x = sign(3 * i + 1);
    worst = std::max(worst, off(atan2_lanes(D(y), D(x)), std::atan2(static_cast<long double>(y), x)));
    worst = std::max(worst, off(asin_lanes(D(x)), std::asin(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 16);
}

TEST(LaneMath, TurnsFollowTheLibrary) {
  const auto expect_near = [](double turn) {
    D sine, cosine;
    sin_cos_of_turn(D(turn), sine, cosine);
    const long double angle = 2 * std::numbers::pi_v<long double> * turn;
    EXPECT_LT(std::abs(only_lane(sine) - std::sin(angle)), 1e-15) << turn;
    EXPECT_LT(std::abs(only_lane(cosine) - std::cos(angle)), 1e-15) << turn;
  };
  for (int i = 0; i <= 1024; ++i) expect_near(i * 0x1p-10);
  for (std::uint64_t i = 0; i < 100000; ++i) expect_near(std::abs(sign(i)));
}

void expect_same(double y, double x) {
  EXPECT_TRUE(same(atan2_lanes(D(y), D(x)), portable::atan2(y, x))) << y << ", " << x;
}

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
