#include "render/scene_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "tests/render/light_checks.h"

namespace oktett::rectangle_pair_test {
namespace {

using namespace light_checks;

constexpr Color kLight{3, 2, 1};

struct Corners {
  Vec3f a, b, c;
};

TriangleEmitter triangle(const Corners& corners, bool both_sides = false) {
  return {corners.a, corners.b, corners.c, kLight, both_sides};
}

/// The same triangle, named from another corner on.
Corners turned(const Corners& c, int turn) { return turn == 0 ? c : turned({c.b, c.c, c.a}, turn - 1); }

struct Quad {
  Vec3f a, b, c, d;  ///< counter-clockwise
};

// Both diagonals and all orders of the corners: the rectangle has the corners, the front and the light of the
// triangles.
TEST(RectanglePair, JoinsHalvesInEveryOrder) {
  const Quad quads[] = {{{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}},
                        {{1, 2, 3}, {1.5f, 2.5f, 3}, {0.5f, 3.5f, 3}, {0, 3, 3}},
                        {{5, 1.7f, -7}, {5, 1.7f, -6.97f}, {5.03f, 1.7f, -6.97f}, {5.03f, 1.7f, -7}}};
  for (const Quad& q : quads)
    for (const bool other : {false, true})
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (const bool swapped : {false, true}) {
            Corners first = {q.a, q.b, q.c}, second = {q.a, q.c, q.d};
            if (other) first = {q.a, q.b, q.d}, second = {q.b, q.c, q.d};
            TriangleEmitter a = triangle(turned(first, i)), b = triangle(turned(second, j));
            if (swapped) std::swap(a, b);
            const auto found = rectangle_of(a, b);
            ASSERT_TRUE(found);
            EXPECT_EQ(found->radiance, kLight);
            EXPECT_FALSE(found->both_sides);
            const Vec3f normal = cross(found->edge_u, found->edge_v), expected = cross(q.b - q.a, q.d - q.a);
            EXPECT_LT(length(normal - expected), 1e-5f * length(expected));
            const Vec3f middle = found->corner + (found->edge_u + found->edge_v) * 0.5f;
            EXPECT_LT(length(middle - (q.a + q.c) * 0.5f), 1e-6f);
          }
}

TEST(RectanglePair, LeavesAllElseAlone) {
  const Quad q{{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
  const TriangleEmitter a = triangle({q.a, q.b, q.c}), b = triangle({q.a, q.c, q.d});
  ASSERT_TRUE(rectangle_of(a, b));
  TriangleEmitter other = b;
  other.radiance.x = 3.5f;
  EXPECT_FALSE(rectangle_of(a, other)) << "another light";
  other = b, other.both_sides = true;
  EXPECT_FALSE(rectangle_of(a, other)) << "another number of sides";
  EXPECT_FALSE(rectangle_of(a, a)) << "the same triangle twice";
  EXPECT_FALSE(rectangle_of(a, triangle({q.a, q.d, q.c}))) << "the front on the other side";
  EXPECT_TRUE(rectangle_of(triangle({q.a, q.b, q.c}, true), triangle({q.a, q.d, q.c}, true)));
  EXPECT_FALSE(rectangle_of(a, triangle({q.a, q.c, {0, 3.001f, 0}}))) << "not quite a rectangle";
  EXPECT_FALSE(rectangle_of(a, triangle({q.a, q.c, {0, 3, 0.001f}}))) << "folded";
  EXPECT_FALSE(rectangle_of(a, triangle({q.c, q.a, {4, 0, 0}}))) << "joined by another edge";
  EXPECT_FALSE(
      rectangle_of(triangle({{0, 0, 0}, {2, 0, 0}, {3, 1, 0}}), triangle({{0, 0, 0}, {3, 1, 0}, {1, 1, 0}})))
      << "a parallelogram";
  const Vec3f point{1, 1, 1};
  EXPECT_FALSE(rectangle_of(triangle({point, point, point}), triangle({point, point, point})));
  for (const float bad :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), 3e38f}) {
    EXPECT_FALSE(rectangle_of(triangle({q.a, q.b, {2, bad, 0}}), triangle({q.a, {2, bad, 0}, q.d})));
    EXPECT_FALSE(rectangle_of(triangle({q.a, {bad, 0, 0}, q.c}), triangle({q.a, q.c, q.d})));
  }
}

// The light of the rectangle is that of its triangles, by samples of all three.
TEST(RectanglePair, BringsTheLightOfBothTriangles) {
  const Quad q{{5, 1.7f, -7}, {5, 1.7f, -6.5f}, {5.5f, 1.7f, -6.5f}, {5.5f, 1.7f, -7}};
  const TriangleEmitter a = triangle({q.a, q.b, q.c}), b = triangle({q.a, q.c, q.d});
  const auto whole = rectangle_of(a, b);
  ASSERT_TRUE(whole);
  const Vec3f front = normalize(cross(q.b - q.a, q.d - q.a)), middle = (q.a + q.c) * 0.5f;
  for (const float distance : {0.05f, 0.5f, 5.0f}) {
    const LightPoint point{middle + front * distance + Vec3f{0.1f, 0, 0.2f}, {}};
    const auto light = [&](const Emitter& emitter) {
      double sum = 0;
      Random random(7);
      constexpr int kSamples = 20000;
      for (int i = 0; i < kSamples; ++i)
        if (const auto s = sample_emitter(emitter, point, random.square()))
          sum += std::abs(dot(s->direction, front)) / s->pdf / kSamples;
      return sum;
    };
    const double halves = light(a) + light(b);
    EXPECT_NEAR(light(*whole) / halves, 1, 0.01);
  }
}

}  // namespace
}  // namespace oktett::rectangle_pair_test
