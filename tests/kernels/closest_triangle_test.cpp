#include "kernels/closed/closest_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/quad_triangle.h"
#include "tests/support/triangle_cases.h"

namespace oktett::closest_triangle_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;

struct Answer {
  double d2, u, v;
};

Answer ask(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  const auto c =
      closest_on_triangle(broadcast<D>(p), broadcast<D>(t[0]), broadcast<D>(t[1]), broadcast<D>(t[2]));
  return {only_lane(c.d2), only_lane(c.u), only_lane(c.v)};
}

/// The answer against the distance in quadruple precision: d may be off by a few roundings of the greatest
/// coordinate, and the weights must name a point of the triangle at that distance.
void expect_closest(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  const Answer a = ask(p, t);
  const double truth = std::sqrt(static_cast<double>(quad_distance2(p, t)));
  double size = max_component(abs(p));
  for (const Vec3d& v : t) size = std::max(size, max_component(abs(v)));
  const double tolerance = size * 0x1p-48 + truth * 0x1p-50;
  ASSERT_NEAR(std::sqrt(a.d2), truth, tolerance);
  ASSERT_GE(a.u, 0);
  ASSERT_GE(a.v, 0);
  ASSERT_LE(a.u + a.v, 1 + 0x1p-52);
  const Vec3d at = t[0] + (t[1] - t[0]) * a.u + (t[2] - t[0]) * a.v;
  ASSERT_NEAR(length(p - at), truth, tolerance);
}

// Needles, slivers and triangles that are nearly lines or points, seen from near and far, from their own
// planes, and from points on their corners and edges.
TEST(ClosestOnTriangle, AgreesWithQuadruplePrecision) {
  for (const float scale : {1.0f, 1e-30f, 1e-12f, 1e10f, 1e30f}) {
    TriangleRandom r(static_cast<std::uint64_t>(std::log2(scale) + 500));
    for (int i = 0; i < 40000; ++i) {
      const TriangleCase c = adversarial_case(r, scale);
      const std::array<Vec3d, 3> t{Vec3d(c.corner[0]), Vec3d(c.corner[1]), Vec3d(c.corner[2])};
      Vec3d p(c.ray.origin);
      const std::uint64_t choice = r.bits();
      if (choice % 8 == 0) p = t[choice >> 8 & 1];
      if (choice % 8 == 1) p = Vec3d(Vec3f((t[0] + t[1]) * 0.5));
      if (choice % 8 == 2) p = Vec3d(Vec3f((t[0] + t[1] + t[2]) / 3.0));
      if (choice % 8 == 3) p *= 1e6;
      expect_closest(p, t);
      if (HasFatalFailure()) FAIL() << "scale " << scale << ", case " << i;
    }
  }
}

// Three corners in a line, or all in one place.
TEST(ClosestOnTriangle, WithoutArea) {
  const Vec3d a{0, 0, 0}, b{1, 2, 3};
  for (const auto& t : {std::array{a, b, b * 2.0}, std::array{b, a, b * 2.0}, std::array{a, b, b},
                        std::array{a, a, b}, std::array{b, b, b}})
    for (const Vec3d& p :
         {Vec3d{0, 0, 0}, Vec3d{1, 2, 3}, Vec3d{3, -1, 2}, Vec3d{-5, -5, -5}, Vec3d{9, 9, 9}})
      expect_closest(p, t);
}

// Triangles that share an edge or a corner find the same distance to the last bit, whatever the order of
// their corners.
TEST(ClosestOnTriangle, NeighboursAgree) {
  TriangleRandom r(3);
  int on_edge = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto point = [&] { return Vec3d(r.vector()); };
    const Vec3d a = point(), b = point(), p = point() * 2.0;
    const Answer one = ask(p, {a, b, point()}), other = ask(p, {point(), b, a});
    // The nearest point of both is on the common edge.
    if (one.v == 0 && other.u + other.v == 1 && one.u > 0 && one.u < 1) {
      ASSERT_EQ(one.d2, other.d2);
      ++on_edge;
    }
  }
  EXPECT_GT(on_edge, 500);
}

}  // namespace
}  // namespace oktett::closest_triangle_test
