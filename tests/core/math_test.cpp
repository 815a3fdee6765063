#include "core/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/limits.h"

namespace oktett::math_test {
namespace {

/// |a - b| relative to |b|, or absolute where b is small.
double error(double a, double b, double smallest = 0) {
  return std::abs(a - b) / std::max(std::abs(b), smallest);
}

// The C library serves as the oracle: it is exact to about one unit in the last place.
TEST(PortableMath, PowersOfTwoFollowTheLibrary) {
  for (double x = -1021.9; x < 1024; x += 0.37) EXPECT_LT(error(portable::exp2(x), std::exp2(x)), 1e-14) << x;
  for (double x = -700; x < 700; x += 0.61) EXPECT_LT(error(portable::exp(x), std::exp(x)), 3e-13) << x;
  for (int n = -1022; n < 1024; ++n) EXPECT_EQ(portable::exp2(n), std::ldexp(1.0, n)) << n;
  EXPECT_EQ(portable::exp2(-1074), std::ldexp(1.0, -1074));
  EXPECT_EQ(portable::exp2(2000), kInfinity);
  EXPECT_EQ(portable::exp2(-2000), 0);
  EXPECT_TRUE(std::isnan(portable::exp2(kNanDouble)));
}

TEST(PortableMath, LogarithmsFollowTheLibrary) {
  for (double x = 1e-320; x < 1e308; x *= 1.37) {
    EXPECT_LT(error(portable::log2(x), std::log2(x), 1e-3), 1e-14) << x;
    EXPECT_LT(error(portable::log(x), std::log(x), 1e-3), 1e-14) << x;
  }
  // Near one the result is small: the error must stay relative to it.
  for (double d = 1e-12; d < 0.5; d *= 2) {
    EXPECT_LT(error(portable::log(1 + d), std::log(1 + d)), 1e-14) << d;
    EXPECT_LT(error(portable::log(1 - d), std::log(1 - d)), 1e-14) << d;
  }
  EXPECT_EQ(portable::log2(8), 3);
  EXPECT_EQ(portable::log2(0), -kInfinity);
  EXPECT_EQ(portable::log(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(portable::log(-1)));
}

TEST(PortableMath, PowerFollowsTheLibrary) {
  for (double x = 1e-6; x < 1e6; x *= 1.9)
    for (double y = -40; y < 40; y += 0.73)
      EXPECT_LT(error(portable::pow(x, y), std::pow(x, y)), 1e-12) << x << ' ' << y;
  for (double exponent = 1; exponent < 2000; exponent *= 1.5)
    for (double cosine = 0.01; cosine < 1; cosine += 0.03)
      EXPECT_LT(error(portable::pow(cosine, exponent), std::pow(cosine, exponent), 1e-300), 2e-12);
  const double special[] = {0, 1, -1, 2, -2, 3, -3, 0.5, -0.5, kInfinity, -kInfinity, kNanDouble};
  for (const double x : special)
    for (const double y : special) {
      const double want = std::abs(std::pow(x, y)), got = std::abs(portable::pow(x, y));
      if (std::isnan(want)) {
        EXPECT_TRUE(std::isnan(got)) << x << ' ' << y;
      } else {
        EXPECT_NEAR(got == want ? 0 : got - want, 0, 1e-13) << x << ' ' << y;
      }
    }
  EXPECT_NEAR(portable::pow(-2, 3), -8, 1e-14);
  EXPECT_NEAR(portable::pow(-2, 2), 4, 1e-14);
}

TEST(PortableMath, TrigonometryFollowsTheLibrary) {
  for (double x = -50; x < 50; x += 0.0137) {
    EXPECT_NEAR(portable::sin(x), std::sin(x), 1e-15);
    EXPECT_NEAR(portable::cos(x), std::cos(x), 1e-15);
    EXPECT_LT(error(portable::tan(x), std::tan(x), 1e-3), 1e-12) << x;
  }
  for (double x = 1e3; x < 1e6; x *= 1.7) EXPECT_NEAR(portable::sin(x), std::sin(x), 1e-15) << x;
  EXPECT_NEAR(portable::cos(1e9), std::cos(1e9), 1e-6);
  EXPECT_TRUE(std::isnan(portable::sin(kInfinity)));
  for (double x = 1e-12; x < 1; x *= 3) EXPECT_LT(error(portable::sin(x), std::sin(x)), 1e-15) << x;
}

TEST(PortableMath, InverseTrigonometryFollowsTheLibrary) {
  for (double x = -1; x <= 1; x += 0x1p-10) {
    EXPECT_NEAR(portable::acos(x), std::acos(x), 1e-15 * 4) << x;
    EXPECT_NEAR(portable::asin(x), std::asin(x), 1e-15 * 4) << x;
  }
  for (double d = 1e-15; d < 1e-3; d *= 4)
    EXPECT_LT(error(portable::acos(1 - d), std::acos(1 - d)), 1e-14) << d;
  for (double x = 1e-10; x < 1e10; x *= 1.7) EXPECT_LT(error(portable::atan(-x), std::atan(-x)), 1e-15) << x;
  EXPECT_TRUE(std::isnan(portable::acos(1.0000001)));
  const double values[] = {0.0, -0.0, 1, -1, 2.5, -2.5, 1e-300, kInfinity, -kInfinity};
  for (const double y : values)
    for (const double x : values) {
      EXPECT_NEAR(portable::atan2(y, x), std::atan2(y, x), 1e-15) << y << ' ' << x;
      EXPECT_EQ(std::signbit(portable::atan2(y, x)), std::signbit(std::atan2(y, x))) << y << ' ' << x;
    }
}

TEST(PortableMath, WholePowersAreThoseOfTheLibrary) {
  for (const double x : {0.0, 1e-30, 0.01, 0.3, 0.77, 0.999, 1.0, 1.3, -0.5})
    for (const unsigned n : {0u, 1u, 2u, 3u, 7u, 32u, 80u, 300u, 511u, 1024u}) {
      const double expected = std::pow(x, n), power = portable::whole_power(x, n);
      EXPECT_NEAR(power, expected, 1e-12 * std::abs(expected)) << x << "^" << n;
    }
  EXPECT_TRUE(std::isnan(portable::whole_power(std::nan(""), 3)));
}

}  // namespace
}  // namespace oktett::math_test
