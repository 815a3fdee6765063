#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/accel/same_hits.h"
#include "tests/support/flat_map.h"
#include "tests/support/limits.h"

namespace oktett::shape_bounds_test {
namespace {

/// Rays that start on the plane of a side of `box`, or up to two floats beside it, and hardly leave that
/// plane: they move at most 1 and often less than 2^-100 along its normal. Half of them are aimed at the
/// middle of the side, which is where a round shape touches it.
RayBatch rays_along_sides(const Box& box, Dice<float>& dice, int count) {
  RayBatch rays;
  const Vec3f extent = box.extent();
  for (int i = 0; i < count; ++i) {
    const int k = dice.below(3), side = dice.below(2), beside = dice.below(5) - 2;
    float plane = side == 0 ? box.lo[k] : box.hi[k];
    for (int step = 0; step < std::abs(beside); ++step)
      plane = beside < 0 ? next_down(plane) : next_up(plane);
    // The middle of the side, where round shapes touch it, or any point of it.
    Vec3f target = box.center();
    if (dice.below(2) == 0)
      for (int j = 0; j < 3; ++j) target[j] = box.lo[j] + dice() * extent[j];
    Vec3f origin = target + dice.vec(2) * (extent + Vec3f{1, 1, 1});
    const float t = std::ldexp(1.0f, dice.below(5) - 2);
    Vec3f direction = (target - origin) * (1 / t);
    origin[k] = plane;
    const float slope = dice.below(4) == 0 ? 0 : std::ldexp(1.0f, -dice.below(140));
    direction[k] = dice.below(2) == 0 ? slope : -slope;
    rays.push_back({origin, 0, direction, kInf});
  }
  return rays;
}

template <class Shape>
Geometry of(Shape shape, const Affine& to_world = {}) {
  return {std::move(shape), to_world, kNoId};
}

/// Expects that every shape of `shapes` has the same hits in a tree, behind the boxes of nodes, as alone,
/// where its kernel sees every ray.
void expect_bounds_hold_hits(std::vector<Geometry> shapes, std::uint32_t seed) {
  Dice<float> dice(seed);
  std::vector<std::shared_ptr<const Accel>> alone;
  for (const Geometry& g : shapes) alone.push_back(build_accel({g}));
  const auto tree = build_accel(shapes);
  int count = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const RayBatch rays = rays_along_sides(bounds(*alone[i]), dice, 200);
    HitBatch expected;
    expected.resize_uninitialized(rays.size());
    const HitSpan reference = expected.span();
    for (std::size_t j = 0; j < rays.size(); ++j) {
      Hit nearest;
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        Hit hit = closest_hit(*alone[k], rays[j], Isa::scalar);
        if (!hit.valid() || (nearest.valid() && hit.t >= nearest.t)) continue;
        hit.item = static_cast<std::uint32_t>(k);
        nearest = hit;
      }
      reference.set(j, nearest);
    }
    count += expect_hits(*tree, rays, expected, {TraceMode::single, TraceMode::automatic});
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(count, 100);
}

/// A tangent of the unit sphere about (0, -2, 0) that leaves the plane x = 1 by 2e-38. The kernel cannot tell
/// the distance from 1, and calls it a hit.
TEST(ShapeBounds, HoldATangentOfASphere) {
  std::vector<Geometry> shapes(20, of(SpheresShape{{{{5, 5, 5}, 1}}}));
  for (const double x : {0.0, 5.2084218906997e-21, -5.2084218906997e-21}) {
    const Ray ray{{1, 1, 1}, 0, {2.34166e-38f, -3, -1}, kInf};
    shapes[0] = of(SpheresShape{{{{x, -2, 0}, 1}}});
    const Hit alone = closest_hit(*build_accel({shapes[0]}), ray);
    const auto tree = build_accel(shapes);
    for (const Isa isa : available_isas()) EXPECT_EQ(closest_hit(*tree, ray, isa), alone) << to_string(isa);
  }
}

TEST(ShapeBounds, HoldSpheres) {
  Dice<float> dice(1);
  std::vector<Geometry> shapes;
  for (int i = 0; i < 100; ++i)
    shapes.push_back(of(SpheresShape{{{random_point(dice), std::abs(random_coordinate(dice)) + 0.25}}}));
  expect_bounds_hold_hits(shapes, 2);
}

TEST(ShapeBounds, HoldDisks) {
  Dice<float> dice(3);
  std::vector<Geometry> shapes;
  for (int i = 0; i < 100; ++i) {
    Vec3d normal{0, 0, 0};
    normal[dice.below(3)] = 1;
    if (dice.below(2) == 0) normal = Vec3d(dice.vec(1));
    shapes.push_back(of(DiskShape{random_point(dice), normal, std::abs(random_coordinate(dice)) + 0.25}));
  }
  expect_bounds_hold_hits(shapes, 4);
}

TEST(ShapeBounds, HoldPolygons) {
  Dice<float> dice(5);
  std::vector<Geometry> shapes;
  for (int i = 0; i < 100; ++i) {
    const Vec3d at = random_point(dice), u = Vec3d(dice.vec(1)), v = Vec3d(dice.vec(1));
    shapes.push_back(of(PolygonShape{{at, at + u, at + u + v, at + v}}));
  }
  expect_bounds_hold_hits(shapes, 6);
}

TEST(ShapeBounds, HoldBoxes) {
  Dice<float> dice(7);
  std::vector<Geometry> shapes;
  for (int i = 0; i < 100; ++i) {
    const Vec3d at = random_point(dice);
    shapes.push_back(of(BoxShape{at, at + Vec3d{1, 1, 1} + Vec3d(dice.vec(0.75f))},
                        i % 4 == 0 ? Affine{} : random_flat_map(dice, i % 4 == 1 ? 4 : 41)));
  }
  expect_bounds_hold_hits(shapes, 8);
}

TEST(ShapeBounds, HoldExactSurfaces) {
  Dice<float> dice(9);
  std::vector<Geometry> shapes;
  for (int i = 0; i < 100; ++i) {
    const Affine m = random_flat_map(dice, 41);
    switch (i % 4) {
      case 0:
        shapes.push_back(of(ExactShape{TorusShape{}}, m));
        break;
      case 1:
        shapes.push_back(of(ExactShape{CylinderShape{}}, m));
        break;
      case 2:
        shapes.push_back(of(ExactShape{SuperquadricShape{}}, m));
        break;
      default:
        shapes.push_back(of(ExactShape{QuadricShape{}}, m));
    }
  }
  expect_bounds_hold_hits(shapes, 10);
}

}  // namespace
}  // namespace oktett::shape_bounds_test
