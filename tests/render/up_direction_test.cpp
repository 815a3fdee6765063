/// \file Which way is up in a mesh whose file does not say it.

#include "render/look/up_direction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/render/look_meshes.h"

namespace oktett::up_direction_test {
namespace {

using look_meshes::add_box;
using look_meshes::add_triangle;
using look_meshes::ball;

TriangleMesh box(float x, float y, float z) {
  TriangleMesh mesh;
  add_box(mesh, {0, 0, 0}, {x, y, z});
  return mesh;
}

/// The same mesh with z up instead of y.
TriangleMesh laid(TriangleMesh mesh) {
  for (Vec3f& p : mesh.positions) p = {p.x, -p.z, p.y};
  return mesh;
}

/// What turns about y: rings of these radii and heights, each joined to the next one; ends are closed.
TriangleMesh turned(const std::vector<std::pair<float, float>>& profile, int sides = 32) {
  TriangleMesh mesh;
  const auto point = [&](std::size_t ring, int side) {
    const double a = 2 * std::numbers::pi * side / sides;
    const auto [radius, height] = profile[ring];
    return Vec3f(Vec3d{radius * std::cos(a), height, -radius * std::sin(a)});
  };
  for (int side = 0; side < sides; ++side) {
    for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
      add_triangle(mesh, point(ring, side), point(ring, side + 1), point(ring + 1, side + 1));
      add_triangle(mesh, point(ring, side), point(ring + 1, side + 1), point(ring + 1, side));
    }
    const std::size_t last = profile.size() - 1;
    add_triangle(mesh, {0, profile[0].second, 0}, point(0, side + 1), point(0, side));
    add_triangle(mesh, {0, profile[last].second, 0}, point(last, side), point(last, side + 1));
  }
  return mesh;
}

/// An open height field over the square from 0 to 10, its heights between 0 and `height`.
TriangleMesh terrain(double height, bool downwards = false) {
  constexpr int kCells = 30;
  TriangleMesh mesh;
  const auto point = [&](int i, int j) {
    const double x = 10.0 * i / kCells, z = 10.0 * j / kCells;
    return Vec3f(Vec3d{x, height * (0.5 + 0.25 * std::sin(1.3 * x) + 0.25 * std::cos(1.7 * z + 0.4 * x)), z});
  };
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const Vec3f a = point(i, j), b = point(i, j + 1), c = point(i + 1, j + 1), d = point(i + 1, j);
      add_triangle(mesh, a, downwards ? c : b, downwards ? b : c);
      add_triangle(mesh, a, downwards ? d : c, downwards ? c : d);
    }
  return mesh;
}

/// A seat or plate on four legs, with a back at the low end of z if it has a height.
TriangleMesh chair(float inset, float back) {
  TriangleMesh mesh;
  add_box(mesh, {0, 0.45f, 0}, {0.5f, 0.5f, 0.5f});
  for (const float x : {inset, 0.46f - inset})
    for (const float z : {inset, 0.46f - inset}) add_box(mesh, {x, 0, z}, {x + 0.04f, 0.45f, z + 0.04f});
  if (back > 0) add_box(mesh, {0, 0.5f, 0}, {0.5f, 0.5f + back, 0.03f});
  return mesh;
}

/// A figure on a plate: no side of it but the lower one is flat.
TriangleMesh statue() {
  return turned({{1, 0}, {1, 0.2f}, {0.3f, 0.4f}, {0.5f, 2}, {0.2f, 2.8f}, {0.4f, 3.2f}, {0, 3.6f}});
}

/// The scan of a statue: open below, uneven at its edge.
TriangleMesh scan() {
  TriangleMesh mesh = statue();
  mesh.indices.clear();
  for (std::uint32_t i = 0; i < mesh.positions.size(); i += 3) {
    const bool bottom =
        mesh.positions[i].y == 0 && mesh.positions[i + 1].y == 0 && mesh.positions[i + 2].y == 0;
    for (std::uint32_t k = 0; !bottom && k < 3; ++k) mesh.indices.push_back(i + k);
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (mesh.positions[i].y == 0) mesh.positions[i].y = 0.01f * std::sin(static_cast<float>(i));
  return mesh;
}

TriangleMesh merged(TriangleMesh mesh, const Vec3f& lo, const Vec3f& hi) {
  add_box(mesh, lo, hi);
  return mesh;
}

TEST(GuessUp, ThingsStandAsTheyWereModelled) {
  TriangleMesh flat_back = box(1, 2, 0.04f);
  add_box(flat_back, {0.8f, 1, 0.04f}, {0.95f, 1.05f, 0.1f});
  TriangleMesh screen = merged(box(16, 9, 0.5f), {5, -3, -2}, {11, -2.8f, 3});
  add_box(screen, {7, -3, 0}, {9, 0, 0.3f});

  struct Case {
    const char* name;
    TriangleMesh mesh;
    char up;
  };
  const std::vector<Case> cases = {
      // Boxes stand along all axes, so nothing speaks against y.
      {"a cube", box(1, 1, 1), 'y'},
      {"a door", box(1, 2, 0.05f), 'y'},
      {"a thin wall", box(20, 3, 0.01f), 'y'},
      {"a monitor", box(16, 9, 0.5f), 'y'},
      {"a short tower", box(1, 3.9f, 1), 'y'},
      {"a tower", box(1, 5, 1), 'y'},
      {"a high tower", box(1, 20, 1), 'y'},
      {"a corridor along z", box(2, 2.5f, 30), 'y'},
      {"a slab", box(5, 0.1f, 4), 'y'},
      {"a door with a handle at its front", flat_back, 'y'},
      {"a monitor on a foot", screen, 'y'},
      // Round things lie on a line only.
      {"a column", turned({{0.5f, 0}, {0.5f, 5}}), 'y'},
      {"a column along z", laid(turned({{0.5f, 0}, {0.5f, 5}})), 'z'},
      {"a needle", turned({{0.01f, 0}, {0, 100}}), 'y'},
      {"a cone along z", laid(turned({{1, 0}, {0, 3}})), 'z'},
      {"a ball", ball(24), 'y'},
      {"a statue", statue(), 'y'},
      {"a statue with z up", laid(statue()), 'z'},
      {"a scan", scan(), 'y'},
      {"a scan with z up", laid(scan()), 'z'},
      {"a bust on a block with z up", laid(merged(statue(), {-1, -1, -1}, {1, 0, 1})), 'z'},
      // Feet count by what they span.
      {"a table", chair(0.1f, 0), 'y'},
      {"a table with z up", laid(chair(0.1f, 0)), 'z'},
      {"a chair with a flat back", chair(0, 0.6f), 'y'},
      {"a chair with a flat back and feet further in", chair(0.1f, 0.6f), 'y'},
      // Sheets.
      {"terrain", terrain(2), 'y'},
      {"low terrain", terrain(0.1), 'y'},
      {"terrain with z up", laid(terrain(2)), 'z'},
      {"low terrain with z up", laid(terrain(0.1)), 'z'},
      {"terrain with z up that faces down", laid(terrain(2, true)), 'z'},
      {"the scan of a face", laid(terrain(6)), 'y'},
      {"a floor", terrain(0), 'y'},
      {"a picture", laid(terrain(0)), 'y'},
      {"nothing", TriangleMesh{}, 'y'},
  };
  for (const Case& c : cases) {
    const Vec3d up = guess_up(c.mesh);
    EXPECT_EQ(up, c.up == 'z' ? (Vec3d{0, 0, 1}) : (Vec3d{0, 1, 0})) << c.name;
  }
}

TEST(GuessUp, SizePlaceAndStrayVerticesChangeNothing) {
  for (const double size : {1e-12, 1e-3, 1e6, 1e18})
    for (const bool z : {false, true}) {
      TriangleMesh mesh = z ? laid(statue()) : statue();
      for (Vec3f& p : mesh.positions) p = Vec3f((Vec3d(p) + Vec3d{7, -30, 11}) * size);
      for (const Vec3f& p : {Vec3f{-3e5f, -2e5f, -1e5f}, {1e5f, 2e5f, 4e5f}}) mesh.positions.push_back(p);
      EXPECT_EQ(guess_up(mesh), (z ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0})) << size;
    }
}

}  // namespace
}  // namespace oktett::up_direction_test
