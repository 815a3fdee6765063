#include "verify/oracles/along_ray.h"

#include <gtest/gtest.h>

namespace oktett::along_ray_test {
namespace {

using enum AlongRay::Crossing;

/// A ray at a slant of 1 to 100 to a wall, which stands at x = 10^-6 in the space of a shape that is placed
/// at `x`.
AlongRay at_a_slant(const ExactOracle& oracle, float x) {
  return AlongRay(oracle, Affine::translation({-static_cast<double>(x), 0, 0}),
                  {{x, 0, 0}, 0, {0.01f, 1, 0}});
}

ExactOracle wall() {
  return {{}, [](const Vec3l& p) { return p.x < 1e-6L ? -1.0L : 1.0L; }, {-1, -1, -1}, {1, 1, 1}};
}

// Doubles near 2 * 10^5 are 3 * 10^-11 apart, which is 3 * 10^-9 along the ray.
TEST(AlongRay, FarAwayRoundingOfTheOriginDecides) {
  const ExactOracle oracle = wall();
  const AlongRay near = at_a_slant(oracle, 0), far = at_a_slant(oracle, 2e5f);
  const long double t = near.crossings().at(0);
  EXPECT_EQ(near.crosses(t), yes);
  EXPECT_EQ(near.crosses(t + 2e-9L), no);
  EXPECT_EQ(far.crosses(t + 2e-9L), nearly);
  EXPECT_EQ(far.crosses(t + 1e-6L), no);
  EXPECT_LT(near.room(t), 1e-10L);
  EXPECT_GT(far.room(t), 2e-9L);
  EXPECT_LT(far.room(t), 1e-6L);
}

}  // namespace
}  // namespace oktett::along_ray_test
