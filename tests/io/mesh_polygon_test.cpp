#include "io/mesh/polygon.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/io/obj_test_support.h"
#include "tests/io/simple_polygons.h"

namespace oktett::test::mesh_polygon_test {
namespace {

using Polygon = std::vector<Vec3f>;

Vec3d triangle_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)) * 0.5;
}

Vec3d polygon_area(const Polygon& p) {
  Vec3d sum;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += triangle_area(p[0], p[i], p[i + 1]);
  return sum;
}

/// A square with a square hole, joined by a bridge that is walked in both directions.
Polygon square_with_hole() {
  return {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {0, 0, 0},
          {2, 2, 0}, {2, 4, 0}, {4, 4, 0}, {4, 2, 0}, {2, 2, 0}};
}

/// n - 2 triangles with corners of the polygon.
std::vector<std::uint32_t> triangulate(const Polygon& polygon) {
  PolygonTriangulator triangulator;
  const auto triangles = triangulator.run(polygon);
  EXPECT_EQ(triangles.size(), 3 * (polygon.size() - 2));
  for (const std::uint32_t i : triangles) EXPECT_LT(i, polygon.size());
  return {triangles.begin(), triangles.end()};
}

/// The polygon is covered exactly: the triangles' areas, each in the polygon's winding, sum up to its own. If
/// two overlapped or one lay outside, the sum of magnitudes would exceed it.
void expect_covered(const Polygon& polygon) {
  const std::vector<std::uint32_t> t = triangulate(polygon);
  const Vec3d whole = polygon_area(polygon);
  const double size = length(whole);
  double sum = 0;
  for (std::size_t i = 0; i + 2 < t.size(); i += 3) {
    const Vec3d area = triangle_area(polygon[t[i]], polygon[t[i + 1]], polygon[t[i + 2]]);
    EXPECT_GE(dot(area, whole), -1e-9 * size * size);
    sum += length(area);
  }
  EXPECT_NEAR(sum, size, 1e-6 * size);
}

/// Shifts the first corner, turns the winding, and stands the polygon up in space.
void expect_covered_in_all_poses(const Polygon& polygon) {
  Polygon p = polygon;
  for (int turn = 0; turn < 2; ++turn) {
    for (std::size_t shift = 0; shift < p.size(); ++shift) {
      expect_covered(p);
      std::rotate(p.begin(), p.begin() + 1, p.end());
    }
    Polygon tilted, upright;
    for (const Vec3f& v : p)
      tilted.push_back({v.x, v.y, 0.5f * v.x - 0.25f * v.y}), upright.push_back({v.y, 7, v.x});
    expect_covered(tilted);
    expect_covered(upright);
    std::reverse(p.begin(), p.end());
  }
}

TEST(Polygon, ConvexOnes) {
  for (const int n : {3, 4, 5, 6, 7, 50, 1000}) {
    Polygon p;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      p.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
    }
    if (n < 10) expect_covered_in_all_poses(p);
    expect_covered(p);
  }
}

TEST(Polygon, ConcaveQuads) {
  expect_covered_in_all_poses({{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5f, 1, 0}});
  expect_covered_in_all_poses({{0, 0, 0}, {4, 0, 0}, {0.1f, 0.1f, 0}, {0, 4, 0}});
}

TEST(Polygon, ConcaveOnes) {
  // an L, an arrow, a comb, a spiral
  expect_covered_in_all_poses({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}});
  expect_covered_in_all_poses({{0, 0, 0}, {3, 2, 0}, {0, 4, 0}, {1, 2.5f, 0}, {1, 1.5f, 0}});
  expect_covered_in_all_poses(
      {{0, 0, 0}, {7, 0, 0}, {7, 3, 0}, {6, 1, 0}, {5, 3, 0}, {4, 1, 0}, {3, 3, 0}, {2, 1, 0}, {1, 3, 0}});
  expect_covered_in_all_poses({{0, 0, 0},
                               {6, 0, 0},
                               {6, 6, 0},
                               {1, 6, 0},
                               {1, 2, 0},
                               {4, 2, 0},
                               {4, 4, 0},
                               {3, 4, 0},
                               {3, 3, 0},
                               {2, 3, 0},
                               {2, 5, 0},
                               {5, 5, 0},
                               {5, 1, 0},
                               {0, 1, 0}});
}

TEST(Polygon, CollinearCorners) {
  expect_covered_in_all_poses({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
  expect_covered_in_all_poses({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}});
  expect_covered_in_all_poses(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 3, 0}, {0, 2, 0}, {0, 1, 0}});
}

// No triangle is wasted on a corner in the middle of a straight edge: neighbours would not meet without
// cracks.
TEST(Polygon, CollinearCornersMakeNoDegenerateTriangles) {
  const Polygon p{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {1, 3, 0}, {0, 3, 0}};
  const std::vector<std::uint32_t> t = triangulate(p);
  for (std::size_t i = 0; i < t.size(); i += 3)
    EXPECT_GT(triangle_area(p[t[i]], p[t[i + 1]], p[t[i + 2]]).z, 0);
}

TEST(Polygon, CoincidentCorners) {
  expect_covered_in_all_poses({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
  expect_covered_in_all_poses({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 2, 0}});
  expect_covered_in_all_poses(square_with_hole());
  // Two triangles that touch in a corner.
  expect_covered_in_all_poses({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}});
}

TEST(Polygon, DegenerateOnesStillGiveTriangles) {
  triangulate({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  triangulate({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  triangulate({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {2, 0, 0}});
  triangulate({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}});
  triangulate(
      {{3e38f, 3e38f, 0}, {-3e38f, 3e38f, 0}, {-3e38f, -3e38f, 3e38f}, {3e38f, -3e38f, 0}, {3e38f, 0, 0}});
  triangulate({{1e-45f, 0, 0}, {0, 1e-45f, 0}, {1e-45f, 1e-45f, 0}, {0, 0, 1e-45f}, {0, 0, 0}});
  // a pentagram
  triangulate({{0, 3, 0}, {2, -3, 0}, {-3, 1, 0}, {3, 1, 0}, {-2, -3, 0}});
}

// Star-shaped around the origin, hence simple, with spikes of any depth.
RC_GTEST_PROP(Polygon, StarsAreCovered, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  const int n = 5 + static_cast<int>(random() % 60);
  Polygon p;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n,
                 radius = 0.05 + static_cast<double>(random() % 1000) / 1000;
    p.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
  }
  expect_covered(p);
}

// A staircase on whole numbers, full of collinear corners, right angles and narrow corridors.
RC_GTEST_PROP(Polygon, SkylinesAreCovered, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  const int n = 1 + static_cast<int>(random() % 30);
  Polygon p;
  for (int i = 0; i < n; ++i) {
    const auto x = static_cast<float>(i), y = static_cast<float>(1 + random() % 4);
    p.insert(p.end(), {{x, y, 0}, {x + 1, y, 0}});
  }
  for (int i = n; i >= 0; --i) p.push_back({static_cast<float>(i), 0, 0});
  expect_covered(p);
}

RC_GTEST_PROP(Polygon, ArbitraryCornersGiveTwoTrianglesLess,
              (const std::vector<std::tuple<char, char, char>>& points)) {
  Polygon p(4 + points.size() % 3);
  for (const auto& [x, y, z] : points) p.push_back({float(x % 5), float(y % 5), float(z % 2)});
  triangulate(p);
}

/// A corridor that winds inwards and back: only its two ends have ears.
Polygon spiral(int corners, double turns) {
  Polygon p;
  const int half = corners / 2;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < half; ++i) {
      const double s = static_cast<double>(side == 0 ? i : half - 1 - i) / half;
      const double angle = 2 * std::numbers::pi * turns * s, radius = (1 - 0.9 * s) * (side == 0 ? 1 : 0.97);
      p.push_back(
          {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
    }
  return p;
}

/// The way around a random tree whose branches are as wide as the corridors between them. All corners are at
/// right angles or straight.
Polygon maze(int width, int height, std::mt19937& random) {
  Polygon p;
  for (const GridPoint& q : around_tree(width, height, 1, random))
    p.push_back({static_cast<float>(q.x), static_cast<float>(q.y), 0});
  return p;
}

/// Whether p is inside, by the corners of `polygon` that a ray along x passes.
bool holds(const Polygon& polygon, double x, double y) {
  bool odd = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d a(polygon[i]), b(polygon[i + 1 < polygon.size() ? i + 1 : 0]);
    if ((a.y > y) != (b.y > y)) odd ^= x < a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y);
  }
  return odd;
}

/// Each of some random points inside is in one triangle, others in none, and the areas add up. The polygon,
/// in the xy plane, does not cross itself.
void expect_tiled(const Polygon& polygon, std::mt19937& random, int points) {
  PolygonTriangulator triangulator;
  const auto t = triangulator.run(polygon);
  EXPECT_FALSE(triangulator.crosses_itself());
  ASSERT_EQ(t.size(), 3 * (polygon.size() - 2));
  expect_covered(polygon);
  Vec3f lo = polygon[0], hi = polygon[0];
  for (const Vec3f& p : polygon) lo = min(lo, p), hi = max(hi, p);
  for (int k = 0; k < points; ++k) {
    const double x = lo.x + (hi.x - lo.x) * (static_cast<double>(random()) + 0.5) / 4294967296.0,
                 y = lo.y + (hi.y - lo.y) * (static_cast<double>(random()) + 0.5) / 4294967296.0;
    int within = 0;
    for (std::size_t i = 0; i < t.size(); i += 3) {
      const auto side = [&](std::size_t from, std::size_t to) {
        const Vec3d a(polygon[t[i + from]]), b(polygon[t[i + to]]);
        return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) > 0;
      };
      const bool ab = side(0, 1), bc = side(1, 2), ca = side(2, 0);
      within += ab == bc && bc == ca;
    }
    EXPECT_EQ(within, holds(polygon, x, y) ? 1 : 0) << x << " " << y;
  }
}

TEST(Polygon, SpiralsAreTiled) {
  std::mt19937 random(5);
  for (const auto& [corners, turns] : {std::pair{40, 0.7}, {720, 3.0}, {720, 12.5}, {6000, 12.5}})
    expect_tiled(spiral(corners, turns), random, 50);
  expect_covered(spiral(100000, 20));
}

TEST(Polygon, MazesAreTiled) {
  std::mt19937 random(6);
  for (int round = 0; round < 40; ++round) {
    Polygon p = maze(2 + static_cast<int>(random() % 14), 2 + static_cast<int>(random() % 14), random);
    std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(random() % p.size()), p.end());
    expect_tiled(p, random, 30);
    // Slanted and a little crooked: no two edges are parallel.
    for (Vec3f& v : p) {
      const float x = v.x + static_cast<float>(random() % 1024) / 4096,
                  y = v.y + static_cast<float>(random() % 1024) / 4096;
      v = {0.8f * x - 0.6f * y, 0.6f * x + 0.8f * y, 0};
    }
    expect_tiled(p, random, 30);
  }
  expect_covered(maze(130, 130, random));
}

// Corners of a chain that leave a straight line by the rounding of their coordinates alone.
TEST(Polygon, ChainsThatAreAlmostStraight) {
  std::mt19937 random(7);
  for (const float slope : {0.1f, 1e-7f, 3.3333333f, 12345.678f})
    for (const int n : {10, 1000}) {
      Polygon p;
      for (int i = 0; i <= n; ++i) p.push_back({static_cast<float>(i), slope * static_cast<float>(i), 0});
      p.push_back({static_cast<float>(n), slope * static_cast<float>(n) + 0.5f * static_cast<float>(n), 0});
      for (int i = n; i >= 0; i -= 3)
        p.push_back(
            {static_cast<float>(i), slope * static_cast<float>(i) + 0.25f * static_cast<float>(n), 0});
      expect_tiled(p, random, 30);
    }
}

TEST(Polygon, CrossingsAreReported) {
  const auto crosses = [](const Polygon& p) {
    PolygonTriangulator triangulator;
    triangulator.run(p);
    return triangulator.crosses_itself();
  };
  EXPECT_TRUE(crosses({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2.5f, 0}}));
  EXPECT_TRUE(crosses({{0, 3, 0}, {2, -3, 0}, {-3, 1, 0}, {3, 1, 0}, {-2, -3, 0}}));  // a pentagram
  // A limacon, and a strip bent until its ends overlap.
  Polygon limacon, strip;
  for (int i = 0; i < 100; ++i) {
    const double angle = 2 * std::numbers::pi * i / 100, radius = 0.5 + std::cos(angle);
    limacon.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
  }
  for (int i = 0; i < 60; ++i) {
    const double angle = 2.2 * std::numbers::pi * (i < 30 ? i : 59 - i) / 29, radius = i < 30 ? 1 : 0.5;
    strip.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
  }
  EXPECT_TRUE(crosses(limacon));
  EXPECT_TRUE(crosses(strip));
  // These touch themselves, which is allowed: in a corner, along an edge, and by a bridge to a hole.
  EXPECT_FALSE(crosses({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}}));
  EXPECT_FALSE(crosses({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}));
  EXPECT_FALSE(crosses(square_with_hole()));
  EXPECT_FALSE(crosses({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}));
  EXPECT_FALSE(crosses({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));
}

// Against whole numbers of 128 bits.
TEST(Polygon, OrientationsAreExact) {
  std::mt19937_64 random(8);
  __extension__ using Whole = __int128;
  int zeros = 0;
  for (int i = 0; i < 200000; ++i) {
    std::int64_t v[6];
    for (std::int64_t& x : v) x = static_cast<std::int64_t>(random() % (1u << 25)) - (1 << 24);
    if (i % 4 == 1) v[4] = 2 * v[2] - v[0], v[5] = 2 * v[3] - v[1] + static_cast<std::int64_t>(random() % 2);
    // One point may be 2^20 times as far away, and the others as close together.
    const std::int64_t far = i % 3 == 0 ? std::int64_t{1} << 20 : 1;
    v[0] *= far, v[1] *= far;
    const PlanePoint p[3] = {
        {static_cast<double>(static_cast<float>(v[0])), static_cast<double>(static_cast<float>(v[1]))},
        {static_cast<double>(static_cast<float>(v[2])), static_cast<double>(static_cast<float>(v[3]))},
        {static_cast<double>(static_cast<float>(v[4])), static_cast<double>(static_cast<float>(v[5]))}};
    const auto whole = [&](int k, bool y) { return static_cast<Whole>(y ? p[k].y : p[k].x); };
    const Whole area = (whole(1, false) - whole(0, false)) * (whole(2, true) - whole(0, true)) -
                       (whole(1, true) - whole(0, true)) * (whole(2, false) - whole(0, false));
    ASSERT_EQ(orientation(p[0], p[1], p[2]), area > 0 ? 1 : area < 0 ? -1 : 0) << i;
    zeros += area == 0;
  }
  EXPECT_GT(zeros, 1000);
  // From the smallest float to the largest.
  EXPECT_EQ(orientation({0, 0}, {0x1p-149, 0}, {0, 0x1p-149}), 1);
  EXPECT_EQ(orientation({0, 0}, {0x1p127, 0x1p-149}, {0x1p127, 0}), -1);
  EXPECT_EQ(orientation({0x1p127, 0x1p127}, {-0x1p127, -0x1p127}, {0x1p-149, 0x1p-149}), 0);
  EXPECT_EQ(orientation({0x1p127, 0x1p127}, {-0x1p127, -0x1p127}, {0x1p-149, 0}), 1);
}

TEST(Polygon, HugeOnesTakeAboutLinearTime) {
  Polygon gear, tangle;
  std::mt19937 random(3);
  constexpr int n = 60000;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, radius = i % 2 ? 1 : 0.9;
    gear.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
    tangle.push_back({static_cast<float>(random() % 1000), static_cast<float>(random() % 1000), 0});
  }
  expect_covered(gear);
  triangulate(tangle);
}

/// Twice the corner count in at most about twice the time: contrived polygons of 100 000 corners.
TEST(Polygon, ContrivedOnesTakeAboutLinearTime) {
  constexpr int n = 50000;
  std::vector<Polygon> covered;
  Polygon star, comb, lying_comb;
  for (int i = 0; i < 2 * n; ++i) {
    const double angle = std::numbers::pi * i / n, radius = i % 2 ? 1 : 0.05;
    star.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0});
    const auto x = static_cast<float>(i), y = i % 2 ? 10.0f : 0.1f;
    comb.push_back({x, y, 0});
    lying_comb.push_back({y, -x, 0});
  }
  comb.insert(comb.end(), {{2 * n, -1, 0}, {0, -1, 0}});
  lying_comb.insert(lying_comb.end(), {{-1, -2 * n, 0}, {-1, 0, 0}});
  for (const Polygon& polygon : {star, comb, lying_comb}) expect_covered(polygon);
}

// The same three corners again and again, a path there and back, and one place that is visited often.
// Quadratic time would be hours.
TEST(Polygon, RepeatedCornersTakeLinearTime) {
  Polygon turns, ways, flower;
  constexpr int n = 150000;
  for (int i = 0; i < n; ++i) {
    turns.push_back({i % 3 == 1 ? 1.0f : 0.0f, i % 3 == 2 ? 1.0f : 0.0f, 0});
    ways.push_back({static_cast<float>(i % 2), static_cast<float>(i % 5), 0});
    const double angle = 2 * std::numbers::pi * (i + i % 3 * 0.3) / n;
    flower.push_back(
        i % 3 == 0 ? Vec3f{0, 0, 0}
                   : Vec3f{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
  }
  for (const Polygon& polygon : {turns, ways, flower}) triangulate(polygon);
}

// Removing ears by brute force, with every corner compared with every other, cuts the same triangles.
TEST(Polygon, TheTreeOfBlockersMissesNone) {
  std::mt19937 random(11);
  const auto unit = [&] { return static_cast<double>(random() % 64) / 64; };
  for (int round = 0; round < 300; ++round) {
    std::vector<PlanePoint> points(1 + random() % 200);
    for (PlanePoint& p : points) p = {unit(), unit()};
    BlockerTree tree;
    tree.build(points);
    std::vector<bool> blocks(points.size());
    for (int change = 0; change < 300; ++change) {
      const auto i = static_cast<std::uint32_t>(random() % points.size());
      tree.change(i, blocks[i] ? -1 : 1);
      blocks[i] = !blocks[i];
    }
    EXPECT_EQ(tree.blocking(), std::count(blocks.begin(), blocks.end(), true));
    for (int query = 0; query < 20; ++query) {
      PlanePoint a{unit(), unit()}, b{unit(), unit()}, c{unit(), unit()};
      if (cross(a, b, c) < 0) std::swap(b, c);
      std::vector<bool> visited(points.size());
      EXPECT_FALSE(tree.any_in(a, b, c, [&](std::uint32_t i) {
        visited[i] = true;
        return false;
      }));
      for (std::size_t i = 0; i < points.size(); ++i) {
        const PlanePoint& p = points[i];
        const bool within = cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0;
        if (blocks[i] && within && cross(a, b, c) > 0) {
          EXPECT_TRUE(visited[i]);
        }
      }
    }
  }
}

TEST(Polygon, FilesSayWhichFacesCrossThemselves) {
  const std::string vertices = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2.5 0\nv 4 4 0\nv 4 0 0\n";
  const auto warnings_of = [&](const std::string& faces) {
    std::vector<std::string> texts;
    for (const Warning& w : ObjFiles().load(vertices + faces).warnings)
      texts.push_back(std::to_string(w.where.line) + ": " + w.message);
    return texts;
  };
  using Texts = std::vector<std::string>;
  EXPECT_EQ(warnings_of("f 1 3 2 4\nf 1 3 5\n"), Texts{});
  EXPECT_EQ(warnings_of("f 1 3 2 4\nf 1 2 3 4\n"),
            Texts{"8: a face crosses itself: its triangles may overlap"});
  EXPECT_EQ(warnings_of("f 1 3 2 4\nf 1 2 3 4\nf 1 2 3 4 6\nf 4 3 2 1\n"),
            Texts{"8: 3 faces cross themselves: their triangles may overlap"});
}

TEST(Polygon, FacesKeepUvsAndNormalsWithTheirCorners) {
  const ObjFile file = ObjFiles().load(
      "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nv -1 1 0\nvt 0 0\nvt 4 0\nvt 1 1\nvt 0 4\nvt -1 1\n"
      "vn 0 0 1\nvn 0 0 2\nvn 0 0 3\nvn 0 0 4\nvn 0 0 5\nf 1/1/1 2/2/2 3/3/3 4/4/4 5/5/5\nf 4/4/4 1/1/1 "
      "2/2/2 3/3/3\n");
  ASSERT_EQ(file.mesh.triangle_count(), 5u);
  EXPECT_EQ(to_vector(file.mesh.uv_indices), indices_of(file));
  EXPECT_EQ(to_vector(file.mesh.normal_indices), indices_of(file));
  double area = 0;
  for (std::size_t i = 0; i < 15; i += 3) {
    const auto corner = [&](std::size_t k) { return file.mesh.positions[file.mesh.indices[i + k]]; };
    const double z = triangle_area(corner(0), corner(1), corner(2)).z;
    EXPECT_GT(z, 0);
    area += z;
  }
  EXPECT_DOUBLE_EQ(area, 6.0 + 4.0);
}

}  // namespace
}  // namespace oktett::test::mesh_polygon_test
