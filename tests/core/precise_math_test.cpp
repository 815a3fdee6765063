// The functions of core/precise_math.h against those of the C library for long double, which has 64 bits on
// x86-64 and 113 on 64-bit ARM, and on arguments whose results are known exactly.

#include "core/precise_math.h"

#include <gtest/gtest.h>
#include <math.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "tests/support/limits.h"

namespace oktett::precise_math_test {
namespace {

using Wide = long double;

/// How far `got` is from `exact`, in units of the last place of the nearest double.
double off_by(double got, Wide exact) {
  const auto nearest = static_cast<double>(exact);
  if (got == nearest || (std::isnan(got) && std::isnan(nearest))) return 0.5;
  const Wide unit =
      std::abs(static_cast<Wide>(std::nextafter(nearest, std::numeric_limits<double>::infinity())) -
               static_cast<Wide>(nearest));
  return static_cast<double>(std::abs(static_cast<Wide>(got) - exact) / unit);
}

/// Numbers between the ends, and with `bits` any finite ones.
class Arguments {
 public:
  explicit Arguments(std::uint64_t seed) : random_(seed) {}
  double between(double a, double b) { return a + (b - a) * static_cast<double>(random_() >> 11) * 0x1p-53; }
  double bits() {
    while (true)
      if (const auto x = std::bit_cast<double>(std::uint64_t{random_()}); std::isfinite(x)) return x;
  }

 private:
  std::mt19937_64 random_;
};

// Half a unit, and a little more where the oracle itself is not sure: its own error is about 2^-11 units.
constexpr double kNearest = 0.502;

struct Case {
  const char* name;
  double (*ours)(double);
  Wide (*oracle)(Wide);
  double from, to;  ///< both 0: any bits
};

TEST(PreciseMath, ResultsAreTheNearestDoubles) {
  const Case cases[] = {
      {"exp", precise::exp, expl, -700, 709},    {"exp", precise::exp, expl, -1, 1},
      {"log", precise::log, logl, 0, 0},         {"log", precise::log, logl, 0.9, 1.1},
      {"log2", precise::log2, log2l, 0, 0},      {"log10", precise::log10, log10l, 0.1, 1e6},
      {"sin", precise::sin, sinl, -10, 10},      {"sin", precise::sin, sinl, 0, 0},
      {"cos", precise::cos, cosl, -1e5, 1e5},    {"cos", precise::cos, cosl, 0, 0},
      {"tan", precise::tan, tanl, -10, 10},      {"tan", precise::tan, tanl, 1e6, 1e12},
      {"asin", precise::asin, asinl, -1, 1},     {"acos", precise::acos, acosl, -1, 1},
      {"acos", precise::acos, acosl, 0.9999, 1}, {"atan", precise::atan, atanl, 0, 0},
      {"atan", precise::atan, atanl, -3, 3},
  };
  for (const Case& c : cases) {
    Arguments arguments(11);
    for (int i = 0; i < 4000; ++i) {
      const double x = c.from == c.to ? arguments.bits() : arguments.between(c.from, c.to);
      ASSERT_LE(off_by(c.ours(x), c.oracle(static_cast<Wide>(x))), kNearest) << c.name << "(" << x << ")";
    }
  }
}

TEST(PreciseMath, ResultsOfTwoArgumentsAreTheNearestDoubles) {
  Arguments arguments(12);
  for (int i = 0; i < 4000; ++i) {
    const double x = arguments.between(0, 10), y = arguments.between(-300, 300),
                 z = arguments.between(-10, 10);
    const Wide power = powl(static_cast<Wide>(x), static_cast<Wide>(y));
    if (power > 1e-300L && power < 1e300L) {
      ASSERT_LE(off_by(precise::pow(x, y), power), kNearest) << x << " ^ " << y;
    }
    ASSERT_LE(off_by(precise::atan2(z, y), atan2l(static_cast<Wide>(z), static_cast<Wide>(y))), kNearest);
    ASSERT_LE(off_by(precise::hypot(x, y), hypotl(static_cast<Wide>(x), static_cast<Wide>(y))), kNearest);
    // Far apart, and near the ends of the range.
    const double far = arguments.bits();
    ASSERT_LE(off_by(precise::atan2(z, far), atan2l(static_cast<Wide>(z), static_cast<Wide>(far))), 1) << far;
    ASSERT_LE(off_by(precise::hypot(z, far), hypotl(static_cast<Wide>(z), static_cast<Wide>(far))), 1) << far;
  }
}

TEST(PreciseMath, ExactResultsAreExact) {
  for (int n = -300; n <= 300; ++n) {
    EXPECT_EQ(precise::pow(2, n), std::ldexp(1.0, n));
    EXPECT_EQ(precise::log2(std::ldexp(1.0, n)), n);
    if (0 <= n && n <= 22) {
      EXPECT_EQ(precise::log10(precise::pow(10, n)), n);
    }
  }
  EXPECT_EQ(precise::pow(9, 0.5), 3);
  EXPECT_EQ(precise::pow(-3, 3), -27);
  EXPECT_EQ(precise::hypot(3, 4), 5);
  EXPECT_EQ(precise::hypot(3e300, 4e300), 5e300);
  EXPECT_EQ(precise::hypot(5e-324, 0), 5e-324);
  EXPECT_EQ(precise::exp(0), 1);
}

TEST(PreciseMath, DenormalResultsAreRoundedOnce) {
  Arguments arguments(13);
  for (int i = 0; i < 2000; ++i) {
    const double x = arguments.between(-746, -708);
    ASSERT_EQ(precise::exp(x), static_cast<double>(expl(static_cast<Wide>(x)))) << x;
  }
}

TEST(PreciseMath, SpecialArgumentsAreThoseOfTheStandard) {
  const double special[] = {0.0, -0.0, 1,     -1,     0.5,    -0.5, 2,     -2,
                            3,   -3,   1e300, -1e300, 5e-324, kInf, -kInf, kNan};
  const auto same = [](double a, double b) {
    return std::isnan(b) ? std::isnan(a)
                         : off_by(a, static_cast<Wide>(b)) <= 1 && std::signbit(a) == std::signbit(b);
  };
  for (const double x : special) {
    EXPECT_TRUE(same(precise::exp(x), std::exp(x))) << x;
    EXPECT_TRUE(same(precise::log(x), std::log(x))) << x;
    EXPECT_TRUE(same(precise::log2(x), std::log2(x))) << x;
    EXPECT_TRUE(same(precise::log10(x), std::log10(x))) << x;
    EXPECT_TRUE(same(precise::sin(x), std::sin(x))) << x;
    EXPECT_TRUE(same(precise::cos(x), std::cos(x))) << x;
    EXPECT_TRUE(same(precise::tan(x), std::tan(x))) << x;
    EXPECT_TRUE(same(precise::asin(x), std::asin(x))) << x;
    EXPECT_TRUE(same(precise::acos(x), std::acos(x))) << x;
    EXPECT_TRUE(same(precise::atan(x), std::atan(x))) << x;
    for (const double y : special) {
      EXPECT_TRUE(same(precise::pow(x, y), std::pow(x, y))) << x << " ^ " << y;
      EXPECT_TRUE(same(precise::atan2(x, y), std::atan2(x, y))) << x << ", " << y;
      EXPECT_TRUE(same(precise::hypot(x, y), std::hypot(x, y))) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace oktett::precise_math_test
