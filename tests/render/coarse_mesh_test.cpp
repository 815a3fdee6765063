/// \file Coarse copies of meshes, and what they look like from inside.

#include "render/look/coarse_mesh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "core/mesh_geometry.h"
#include "render/look/mesh_view.h"
#include "tests/render/look_meshes.h"

namespace oktett::coarse_mesh_test {
namespace {

using look_meshes::add_box;
using look_meshes::ball;

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) area += length(area_normal(mesh, i));
  return area;
}

/// Each triangle as n x n, with vertices of their own.
TriangleMesh divided(const TriangleMesh& mesh, int n) {
  TriangleMesh fine;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    Vec3d v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = Vec3d(mesh.positions[mesh.indices[3 * t + k]]);
    const auto at = [&](int i, int j) {
      return Vec3f((v[0] * (n - i - j) + v[1] * i + v[2] * j) / static_cast<double>(n));
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n - i; ++j) {
        look_meshes::add_triangle(fine, at(i, j), at(i + 1, j), at(i, j + 1));
        if (j < n - i - 1) look_meshes::add_triangle(fine, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return fine;
}

TEST(CoarseMesh, KeepsTheShapeWithFewerTriangles) {
  const TriangleMesh fine = ball(200), coarse = coarse_copy(fine, 32);
  EXPECT_LT(coarse.triangle_count(), fine.triangle_count() / 4);
  EXPECT_NEAR(area_of(coarse) / area_of(fine), 1, 0.05);
  for (const Vec3f& p : coarse.positions)
    EXPECT_NE(std::ranges::find(fine.positions, p), fine.positions.end());
  for (const std::uint32_t index : coarse.indices) ASSERT_LT(index, coarse.positions.size());
}

TEST(CoarseMesh, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh fine = ball(300), expected = coarse_copy(fine, 50);
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const TriangleMesh again = coarse_copy(fine, 50);
    EXPECT_TRUE(std::ranges::equal(again.positions, expected.positions));
    EXPECT_TRUE(std::ranges::equal(again.indices, expected.indices));
  }
}

TEST(CoarseMesh, TakesWhatIsFinite) {
  TriangleMesh mesh = ball(20);
  const std::size_t whole = coarse_copy(mesh, 1000).triangle_count();
  mesh.positions[50].x = std::numeric_limits<float>::infinity();
  mesh.positions[90].y = std::numeric_limits<float>::quiet_NaN();
  const TriangleMesh coarse = coarse_copy(mesh, 1000);
  EXPECT_LT(coarse.triangle_count(), whole);
  EXPECT_GT(coarse.triangle_count(), whole - 16);
  EXPECT_EQ(coarse_copy({}, 10).triangle_count(), 0u);
  TriangleMesh point;
  look_meshes::add_triangle(point, {1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(coarse_copy(point, 10).triangle_count(), 0u);
}

// A room is one, and a ball and a cupboard are none, as before.
TEST(CoarseMesh, IsSeenFromInsideOrNotAsTheMeshIs) {
  Film film;
  film.width = 160, film.height = 90;
  TriangleMesh room, cupboard;
  add_box(room, {-5, 0, -4}, {5, 3, 4}, true);
  add_box(cupboard, {-1, 0, -1}, {1, 2, 1});
  for (int i = 0; i < 4; ++i) {
    const float x = 2 * static_cast<float>(i) - 3.5f;
    add_box(room, {x, 0, 0}, {x + 0.8f, 1.2f, 0.5f});
  }
  add_box(cupboard, {-0.5f, 0.5f, -0.5f}, {0.5f, 1, 0.5f});
  const TriangleMesh meshes[] = {divided(room, 40), divided(cupboard, 40), ball(150)};
  for (const TriangleMesh& mesh : meshes) {
    const bool inside = &mesh == &meshes[0];
    const TriangleMesh coarse = coarse_copy(mesh, 64);
    EXPECT_LT(coarse.triangle_count(), mesh.triangle_count());
    EXPECT_EQ(interior_view(mesh, {0, 1, 0}, film).has_value(), inside);
    EXPECT_EQ(interior_view(coarse, {0, 1, 0}, film).has_value(), inside);
  }
}

}  // namespace
}  // namespace oktett::coarse_mesh_test
