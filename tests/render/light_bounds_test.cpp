#include "render/light/light_tree.h"

#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <cmath>

#include "render/light/emitter.h"
#include "tests/render/light_checks.h"

namespace oktett::light_bounds_test {
namespace {

using namespace light_checks;

TEST(LightBounds, OfDisksAreTight) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    DiskEmitter disk{random.direction() * 2.0f, random.direction(), 0.7f, {1, 1, 1}, false};
    if (i < 3) disk.normal = {i == 0 ? 1.0f : 0, i == 1 ? 1.0f : 0, i == 2 ? 1.0f : 0};
    const Box box = light_bounds(disk)->box;
    Vec3d across, along;
    make_basis(Vec3d(disk.normal), across, along);
    Vec3d lo{9, 9, 9}, hi{-9, -9, -9};
    for (int k = 0; k < 4000; ++k) {
      const double angle = 2 * std::numbers::pi * k / 4000;
      const Vec3d rim =
          Vec3d(disk.center) + across * (0.7 * std::cos(angle)) + along * (0.7 * std::sin(angle));
      lo = min(lo, rim), hi = max(hi, rim);
    }
    EXPECT_LT(length(Vec3d(box.lo) - lo), 1e-5) << i;
    EXPECT_LT(length(Vec3d(box.hi) - hi), 1e-5) << i;
  }
}

TEST(LightBounds, JoinedConesHoldBoth) {
  Random random(6);
  for (int i = 0; i < 20000; ++i) {
    LightBounds a, b;
    a.axis = random.direction();
    b.axis = i % 5 == 0   ? a.axis
             : i % 5 == 1 ? -a.axis
             : i % 5 == 2 ? normalize(a.axis + random.direction() * 1e-4f)
                          : random.direction();
    a.spread = static_cast<float>(random() < 0.3 ? 0 : random.between(0, std::numbers::pi));
    b.spread = static_cast<float>(random() < 0.3 ? 0 : random.between(0, std::numbers::pi));
    a.both_sides = random() < 0.3, b.both_sides = random() < 0.3;
    a.box.grow(random.direction()), b.box.grow(random.direction());
    const LightBounds sum = join(a, b);
    EXPECT_TRUE(sum.box.contains(a.box) && sum.box.contains(b.box));
    ASSERT_NEAR(length(sum.axis), 1, 1e-5f);
    for (const LightBounds& part : {a, b}) {
      // The normal of the part that is farthest from the axis of the sum.
      const Vec3d p(part.axis), s(sum.axis);
      double between = std::atan2(length(cross(p, s)), dot(p, s));
      if (sum.both_sides && part.both_sides) between = std::min(between, std::numbers::pi - between);
      ASSERT_LE(std::min(between + part.spread, std::numbers::pi), sum.spread + 1e-6) << i;
    }
  }
}

}  // namespace
}  // namespace oktett::light_bounds_test
