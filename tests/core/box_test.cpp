#include "core/box.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace oktett::box_test {
namespace {

TEST(Box, IsEmptyUntilItGrows) {
  Box b;
  EXPECT_TRUE(b.empty());
  EXPECT_EQ(b.half_area(), 0);
  EXPECT_EQ(b.extent(), (Vec3f{0, 0, 0}));
  b.grow(Vec3f{1, 2, 3});
  EXPECT_FALSE(b.empty());
  EXPECT_TRUE(b.contains(Vec3f{1, 2, 3}));
  b.grow(Box{});
  EXPECT_EQ(b, (Box{{1, 2, 3}, {1, 2, 3}}));
}

TEST(Box, IgnoresNanWhenItGrows) {
  Box b{{0, 0, 0}, {1, 1, 1}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  b.grow(Vec3f{nan, 2, nan});
  EXPECT_EQ(b, (Box{{0, 0, 0}, {1, 2, 1}}));
}

TEST(Box, KnowsItsSurfaceAndCenter) {
  const Box b{{-1, 0, 2}, {1, 3, 6}};
  EXPECT_EQ(b.half_area(), 2 * 3 + 3 * 4 + 4 * 2);
  EXPECT_EQ(b.center(), (Vec3f{0, 1.5f, 4}));
  const Box huge{{-3e38f, -3e38f, -3e38f}, {3e38f, 3e38f, 3e38f}};
  EXPECT_EQ(huge.center(), (Vec3f{0, 0, 0}));
}

// No float lies between the rounded value and the value.
TEST(Round, BracketsTightly) {
  EXPECT_TRUE(rc::check([](double v) {
    if (std::abs(v) > 3e38) return;
    const float up = round_up(v), down = round_down(v);
    RC_ASSERT(static_cast<double>(up) >= v);
    RC_ASSERT(static_cast<double>(down) <= v);
    RC_ASSERT(up == down || std::nextafter(down, up) == up);
  }));
}

TEST(Round, HandlesTheEndsOfTheRange) {
  EXPECT_GT(round_up(1e-60), 0);
  EXPECT_EQ(round_down(1e-60), 0);
  EXPECT_EQ(round_up(1e300), std::numeric_limits<float>::infinity());
  EXPECT_EQ(round_up(0.0), 0.0f);
}

TEST(Box, NeighboursAreThoseOfTheLibrary) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  std::uint32_t pattern = 1;
  for (int i = 0; i < 100000; ++i, pattern = pattern * 1664525u + 1013904223u) {
    const auto f = std::bit_cast<float>(pattern);
    if (std::isnan(f)) continue;
    ASSERT_EQ(bits(next_up(f)), bits(std::nextafter(f, inf))) << f;
    ASSERT_EQ(bits(next_down(f)), bits(std::nextafter(f, -inf))) << f;
  }
  for (const float f : {0.0f, -0.0f, 1e-45f, -1e-45f, inf, -inf, 3.40282347e38f, -3.40282347e38f}) {
    ASSERT_EQ(bits(next_up(f)), bits(std::nextafter(f, inf))) << f;
    ASSERT_EQ(bits(next_down(f)), bits(std::nextafter(f, -inf))) << f;
  }
  EXPECT_TRUE(std::isnan(next_up(std::nanf(""))));
}

}  // namespace
}  // namespace oktett::box_test
