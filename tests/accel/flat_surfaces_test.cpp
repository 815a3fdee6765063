#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "accel/accel.h"
#include "tests/support/flat_map.h"
#include "tests/support/limits.h"

namespace oktett::flat_surfaces_test {
namespace {

/// Shapes, and functions that are negative on one side of the surface and positive on the other.
struct FormulaCase {
  decltype(Geometry::shape) shape;
  double (*value)(const Vec3d& p);
};

std::vector<FormulaCase> formula_cases() {
  ConeShape cone;
  cone.open = true;
  CylinderShape cylinder;
  cylinder.open = true;
  return {{ExactShape{cone}, [](const Vec3d& p) { return std::hypot(p.x, p.z) - (1 - p.y) / 2; }},
          {ExactShape{cylinder}, [](const Vec3d& p) { return std::hypot(p.x, p.z) - 1; }},
          {ExactShape{QuadricShape{}}, [](const Vec3d& p) { return length(p) - 1; }},
          {ExactShape{TorusShape{}},
           [](const Vec3d& p) { return std::hypot(0.7 - std::hypot(p.x, p.y), p.z) - 0.3; }},
          {BoxShape{{-1, -1, -1}, {1, 1, 1}}, [](const Vec3d& p) { return max_component(abs(p)) - 1; }}};
}

/// Guarantee 4 of docs/numerics.md. Under a flat map the way back to the surface is short in the world only
/// if it leads along the normal that the surface has there.
TEST(SurfaceInteraction, IsWithinItsErrorOnFlattenedSurfaces) {
  Dice<float> dice(5);
  int hits = 0;
  for (int i = 0; i < 400; ++i) {
    const FormulaCase c = formula_cases()[static_cast<std::size_t>(i) % 5];
    const Affine to_world = random_flat_map(dice, 10), to_own = to_world.inverse();
    const auto accel = build_accel({{c.shape, to_world, kNoId}});
    for (int k = 0; k < 200; ++k) {
      const Vec3f target(to_world.point(Vec3d(dice.vec(0.8f))));
      const Vec3f origin = target + dice.vec(6);
      const Ray ray{origin, 0, target - origin, kInf};
      const Hit hit = closest_hit(*accel, ray);
      if (!hit.valid()) continue;
      ++hits;
      const SurfaceInteraction s = surface_interaction(*accel, ray, hit);
      for (int axis = 0; axis < 3; ++axis) {
        const double o = double(ray.origin[axis]), along = double(hit.t) * double(ray.direction[axis]);
        const double reach = double(hit.t) * double(max_component(abs(ray.direction)));
        ASSERT_NEAR(double(s.position[axis]), o + along,
                    double(s.position_error[axis]) + 0x1p-22 * (std::abs(o) + reach))
            << i << " " << k;
      }
      const Vec3d n(s.geometric_normal), off = n * double(dot(abs(s.geometric_normal), s.position_error));
      const double in = c.value(to_own.point(Vec3d(s.position) - off));
      const double out = c.value(to_own.point(Vec3d(s.position) + off));
      ASSERT_LE(in * out, 0) << i << " " << k;
    }
  }
  EXPECT_GT(hits, 10000);
}

}  // namespace
}  // namespace oktett::flat_surfaces_test
