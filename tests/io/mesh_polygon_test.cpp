#include "io/mesh/polygon.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/io/obj_test_support.h"

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
  // A square with a square hole, joined by a bridge that is walked in both directions.
  expect_covered_in_all_poses({{0, 0, 0},
                               {6, 0, 0},
                               {6, 6, 0},
                               {0, 6, 0},
                               {0, 0, 0},
                               {2, 2, 0},
                               {2, 4, 0},
                               {4, 4, 0},
                               {4, 2, 0},
                               {2, 2, 0}});
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
TEST(Polygon, RepeatedCornersTakeLinearTime) {
  // Time of this process, which other programs do not lengthen. Linear time is below a second, quadratic
  // hours.
  const std::clock_t start = std::clock();
  Polygon turns, ways, flower;
  constexpr int n = 300000;
  for (int i = 0; i < n; ++i) {
    turns.push_back({i % 3 == 1 ? 1.0f : 0.0f, i % 3 == 2 ? 1.0f : 0.0f, 0});
    ways.push_back({static_cast<float>(i % 2), static_cast<float>(i % 5), 0});
    const double angle = 2 * std::numbers::pi * (i + i % 3 * 0.3) / n;
    flower.push_back(
        i % 3 == 0 ? Vec3f{0, 0, 0}
                   : Vec3f{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
  }
  for (const Polygon& polygon : {turns, ways, flower}) triangulate(polygon);
  EXPECT_LT((std::clock() - start) / CLOCKS_PER_SEC, 20);
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
