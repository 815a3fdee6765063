// mesh_of_scene: one mesh of a whole scene. Vertices are compared with the equations of the shapes, volumes
// with their formulas, and the mesh is counted: vertices, edges, and how triangles meet in them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/mesh_geometry.h"
#include "io/mesh/load/load_mesh.h"
#include "io/scene/scene_file.h"
#include "io/scene/scene_mesh.h"
#include "tests/support/temp_dir.h"

namespace oktett::test::whole_scene_mesh_test {
namespace {

MeshFile file_of(const std::string& objects, const SceneMeshOptions& options = {}) {
  const TempDir dir;
  dir.write("a.yaml", "oktett: 1\n" + objects);
  return mesh_of_scene(load_scene(dir.file("a.yaml")), options);
}

TriangleMesh mesh_of(const std::string& objects, std::uint32_t resolution = 24) {
  return file_of(objects, {.resolution = resolution}).mesh;
}

struct Counts {
  std::size_t open = 0;    ///< edges that do not belong to two triangles in opposite directions
  std::int64_t euler = 0;  ///< vertices - edges + triangles
};

Counts count(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<int, 2>> edges;
  std::map<std::uint32_t, int> used;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::uint32_t a = mesh.indices[i], b = mesh.indices[i % 3 == 2 ? i - 2 : i + 1];
    ++edges[std::minmax(a, b)][a < b ? 0 : 1];
    ++used[a];
  }
  Counts counts;
  for (const auto& [edge, ways] : edges)
    if (ways != std::array{1, 1}) ++counts.open;
  counts.euler = static_cast<std::int64_t>(used.size()) - static_cast<std::int64_t>(edges.size()) +
                 static_cast<std::int64_t>(mesh.triangle_count());
  return counts;
}

/// By the divergence theorem; positive if the front is outside.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    sum += dot(corner(mesh, t, 0), cross(corner(mesh, t, 1), corner(mesh, t, 2)));
  return sum / 6;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) sum += length(area_normal(mesh, t)) / 2;
  return sum;
}

/// The greatest of distance(p) for all vertices.
double farthest(const TriangleMesh& mesh, const std::function<double(const Vec3d&)>& distance) {
  double most = 0;
  for (const Vec3f& p : mesh.positions) most = std::max(most, std::abs(distance(Vec3d(p))));
  return most;
}

double radius(const Vec3d& p) { return std::hypot(p.x, p.z); }

TEST(WholeSceneMesh, ASphereIsClosedRoundAndHasItsVolume) {
  const TriangleMesh mesh = mesh_of("objects: [{sphere: {center: [1, 2, 3], radius: 2}}]");
  const Vec3d center{1, 2, 3};
  EXPECT_LT(farthest(mesh, [&](const Vec3d& p) { return length(p - center) - 2; }), 2e-6);
  EXPECT_EQ(count(mesh).open, 0u);
  EXPECT_EQ(count(mesh).euler, 2);
  const double exact = 4.0 / 3 * std::numbers::pi * 8;
  EXPECT_LT(volume(mesh), exact);
  EXPECT_GT(volume(mesh), exact * 0.997);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const Vec3d n(mesh.normals[mesh.normal_indices[i]]), p(mesh.positions[mesh.indices[i]]);
    EXPECT_GT(dot(n, normalize(p - center)), 0.99999);
  }
}

TEST(WholeSceneMesh, ATorusHasAHole) {
  const TriangleMesh mesh = mesh_of("objects: [{torus: {major: 1, minor: 0.3}}]", 40);
  EXPECT_LT(farthest(mesh, [](const Vec3d& p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.3; }),
            1e-6);
  EXPECT_EQ(count(mesh).open, 0u);
  EXPECT_EQ(count(mesh).euler, 0);
  EXPECT_NEAR(volume(mesh), 2 * std::numbers::pi * std::numbers::pi * 0.09, 0.01);
}

constexpr const char* kDrilled =
    "  - difference:\n"
    "      - box: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
    "      - cylinder: {from: [0, -2, 0], to: [0, 2, 0], radius: 0.5}\n";

TEST(WholeSceneMesh, CombinationsKeepTheirEdgesAndCorners) {
  const TriangleMesh mesh = mesh_of(std::string("objects:\n") + kDrilled, 32);
  EXPECT_EQ(count(mesh).open, 0u);
  EXPECT_EQ(count(mesh).euler, 0);
  EXPECT_NEAR(volume(mesh), 8 - 2 * std::numbers::pi / 4, 0.006);
  const auto off_rim = [](const Vec3d& p) {
    return std::max(std::abs(radius(p) - 0.5), std::abs(std::abs(p.y) - 1));
  };
  EXPECT_LT(farthest(mesh,
                     [&](const Vec3d& p) {
                       const double face = max_component(abs(p)) - 1;
                       return std::min(std::abs(radius(p) - 0.5), std::abs(face));
                     }),
            1e-5);
  // All around both rims there is a vertex in each cell, and those near a rim are on it.
  std::vector<double> angles[2];
  for (const Vec3f& f : mesh.positions) {
    const Vec3d p(f);
    if (off_rim(p) < 1e-4) angles[p.y > 0].push_back(std::atan2(p.z, p.x));
    EXPECT_FALSE(off_rim(p) > 1e-4 && off_rim(p) < 0.003);
  }
  for (std::vector<double>& around : angles) {
    std::ranges::sort(around);
    ASSERT_GT(around.size(), 20u);
    around.push_back(around.front() + 2 * std::numbers::pi);
    for (std::size_t i = 1; i < around.size(); ++i) EXPECT_LT(around[i] - around[i - 1], 0.3);
  }
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        EXPECT_TRUE(std::ranges::any_of(mesh.positions, [&](const Vec3f& p) {
          return length(Vec3d(p) - Vec3d{x, y, z}) < 1e-5;
        }));
}

TEST(WholeSceneMesh, SolidsInsideOfEachOtherAndSolidsThatTouch) {
  const TriangleMesh nested = mesh_of(
      "objects:\n  - difference: [{sphere: {radius: 1}}, {sphere: {radius: 0.5}}]\n  - sphere: {radius: "
      "0.2}\n");
  EXPECT_EQ(count(nested).open, 0u);
  EXPECT_EQ(count(nested).euler, 6);
  EXPECT_NEAR(volume(nested), 4.0 / 3 * std::numbers::pi * (1 - 0.125 + 0.008), 0.02);
  const TriangleMesh touching =
      mesh_of("objects:\n  - union: [{sphere: {center: [-1, 0, 0]}}, {sphere: {center: [1, 0, 0]}}]\n", 32);
  EXPECT_EQ(count(touching).open, 0u);
  EXPECT_NEAR(volume(touching), 8.0 / 3 * std::numbers::pi, 0.1);
}

TEST(WholeSceneMesh, PlatesThinnerThanACellStay) {
  const TriangleMesh mesh = mesh_of(
      "objects:\n  - intersection:\n      - box: {min: [-1, -0.001, -1], max: [1, 0.001, 1]}\n"
      "      - sphere: {radius: 3}\n    transform: {rotate: [20, 30, 0]}\n",
      16);
  EXPECT_EQ(count(mesh).open, 0u);
  EXPECT_EQ(count(mesh).euler, 2);
  // Beside its edges the plate gets thinner over a cell; its corners are cut.
  EXPECT_GT(volume(mesh), 0.0065);
  EXPECT_LT(volume(mesh), 0.00801);
  EXPECT_NEAR(area(mesh), 8, 0.1);
}

TEST(WholeSceneMesh, OpenSurfacesReachTheirRims) {
  // A part of a sphere without a floor.
  const TriangleMesh half = mesh_of(
      "objects:\n  - quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -1], open: true, "
      "clip: {min: [-1.5, -1.5, 0.1], max: [1.5, 1.5, 1.5]}}\n");
  EXPECT_LT(farthest(half, [](const Vec3d& p) { return length(p) - 1; }), 2e-3);
  EXPECT_NEAR(area(half), 2 * std::numbers::pi * 0.9, 0.05);
  double lowest = 1;
  for (const Vec3f& p : half.positions) lowest = std::min(lowest, static_cast<double>(p.z));
  EXPECT_NEAR(lowest, 0.1, 1e-3);
  EXPECT_EQ(count(half).euler, 1);
}

TEST(WholeSceneMesh, ImplicitSurfacesAndFractals) {
  const TriangleMesh gyroid = mesh_of(
      "objects:\n  - implicit: {function: \"sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)\", "
      "bounds: {min: [-3, -3, -3], max: [3, 3, 3]}}\n",
      48);
  EXPECT_EQ(count(gyroid).open, 0u);
  const auto off = [](const Vec3f& f) {
    const Vec3d p(f);
    const double value =
        std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) + std::sin(p.z) * std::cos(p.x);
    return std::min(std::abs(value), std::abs(max_component(abs(p)) - 3));
  };
  // Where a cell holds two corners, its one vertex may be on neither.
  EXPECT_LT(std::ranges::count_if(gyroid.positions, [&](const Vec3f& p) { return off(p) > 1e-4; }), 20);
  for (const Vec3f& p : gyroid.positions) EXPECT_LT(off(p), 0.125);
  // Half of the box is inside, by the symmetry of the function.
  EXPECT_NEAR(volume(gyroid), 108, 2);
  for (const char* shape : {"menger: {depth: 6}", "sphereflake: {depth: 5}", "terrain: {depth: 8}"}) {
    const TriangleMesh fractal = mesh_of(std::string("objects: [{") + shape + "}]", 20);
    EXPECT_GT(fractal.triangle_count(), 100u) << shape;
    EXPECT_EQ(count(fractal).open, 0u) << shape;
    EXPECT_GT(volume(fractal), 0) << shape;
  }
}

TEST(WholeSceneMesh, MirroredInstancesKeepTheirOutside) {
  const TriangleMesh mesh = mesh_of(
      "define:\n  ball:\n    sphere: {radius: 1}\nobjects:\n"
      "  - {instance: ball, transform: {translate: [3, 0, 0]}}\n"
      "  - {instance: ball, transform: [{scale: [-1, 1, 1]}, {translate: [-3, 0, 0]}]}\n"
      "  - {instance: ball, transform: [{scale: [2, -1, 1]}, {translate: [0, 6, 0]}]}\n");
  EXPECT_EQ(count(mesh).open, 0u);
  EXPECT_EQ(count(mesh).euler, 6);
  EXPECT_NEAR(volume(mesh), 4 * 4.0 / 3 * std::numbers::pi, 0.06);
}

TEST(WholeSceneMesh, MeshesPassThroughBitByBit) {
  const TempDir dir;
  dir.write("a.obj", "v 0.1 0.2 0.3\nv 1.7 0 0\nv 0 1.3 0.7\nv 5 6 7\nf 1 2 3\nf 2 1 4\n");
  dir.write("a.yaml", "oktett: 1\nobjects: [{mesh: {file: a.obj}}]\n");
  dir.write("b.yaml",
            "oktett: 1\nobjects:\n  - mesh: {file: a.obj}\n  - box: {min: [0, 0, 0], max: [1, 2, 3]}\n"
            "  - triangle: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}\n");
  const TriangleMesh read = load_mesh(dir.file("a.obj")).mesh;
  for (const char* name : {"a.yaml", "b.yaml"}) {
    const TriangleMesh made = mesh_of_scene(load_scene(dir.file(name))).mesh;
    for (std::size_t i = 0; i < read.positions.size(); ++i) EXPECT_EQ(made.positions[i], read.positions[i]);
    for (std::size_t i = 0; i < read.indices.size(); ++i) EXPECT_EQ(made.indices[i], read.indices[i]);
  }
  const TriangleMesh both = mesh_of_scene(load_scene(dir.file("b.yaml"))).mesh;
  EXPECT_EQ(both.triangle_count(), 2u + 12u + 1u);
}

TEST(WholeSceneMesh, ToleranceRefinesAndSelectChooses) {
  const std::string objects =
      "objects:\n  - {sphere: {radius: 1}, name: big}\n  - {sphere: {center: [9, 0, 0]}}\n";
  const auto off = [](const TriangleMesh& mesh) {
    double most = 0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      const Vec3d middle = (corner(mesh, t, 0) + corner(mesh, t, 1) + corner(mesh, t, 2)) / 3;
      most = std::max(most, 1 - length(middle));
    }
    return most;
  };
  const TriangleMesh coarse = file_of(objects, {.tolerance = 0.01, .select = "big"}).mesh,
                     fine = file_of(objects, {.tolerance = 0.0005, .select = "big"}).mesh;
  EXPECT_LT(off(coarse), 0.015);
  EXPECT_LT(off(fine), 0.00075);
  EXPECT_LT(coarse.triangle_count(), fine.triangle_count());
  EXPECT_THROW(file_of(objects, {.select = "none"}), Error);
}

TEST(WholeSceneMesh, WhatHasNoEndIsLeftOutWithAWarning) {
  const MeshFile file =
      file_of("objects:\n  - {plane: {normal: [0, 1, 0]}, name: ground}\n  - sphere:\n", {.resolution = 8});
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_TRUE(to_string(file.warnings[0])
                  .ends_with("a.yaml:3:5: warning: the plane 'ground' has no end and is left out"))
      << to_string(file.warnings[0]);
  EXPECT_GT(file.mesh.triangle_count(), 100u);
}

TEST(WholeSceneMesh, WhatIsNoSurfaceIsLeftOut) {
  const MeshFile file = file_of(
      "media: {dust: {scattering: [0.1, 0.1, 0.1]}}\nmaterials: {air: {surface: false, interior: dust}}\n"
      "objects:\n  - {box: {min: [-9, -9, -9], max: [9, 9, 9]}, material: air}\n  - sphere:\n",
      {.resolution = 8});
  EXPECT_LT(farthest(file.mesh, [](const Vec3d& p) { return length(p) - 1; }), 1e-6);
  EXPECT_EQ(file.warnings.size(), 1u);
}

TEST(WholeSceneMesh, WhatCombinationsAreSeenThroughHidesNothing) {
  const std::string solid = "objects: [{difference: [{box: }, {sphere: {radius: 0.75}}]";
  const TriangleMesh plain = mesh_of(solid + "}]\n");
  const TriangleMesh seen = mesh_of(solid + ", seen_through: [{sphere: {center: [0, 9, 0]}}]}]\n");
  EXPECT_GT(plain.triangle_count(), 0u);
  EXPECT_TRUE(std::ranges::equal(plain.positions, seen.positions));
  EXPECT_TRUE(std::ranges::equal(plain.indices, seen.indices));
}

TEST(WholeSceneMesh, CombinationsHaveTheMaterialsOfTheirOperands) {
  const MeshFile file = file_of(
      "materials: {red: {color: [1, 0, 0]}, blue: {color: [0, 0, 1]}}\nobjects:\n  - difference:\n"
      "      - {box: {}, material: red}\n      - {sphere: {center: [0, 1, 0], radius: 0.5}, material: "
      "blue}\n",
      {.resolution = 24});
  ASSERT_EQ(file.materials.size(), 2u);
  for (std::size_t t = 0; t < file.mesh.triangle_count(); ++t) {
    const Vec3d middle = (corner(file.mesh, t, 0) + corner(file.mesh, t, 1) + corner(file.mesh, t, 2)) / 3;
    if (length(middle - Vec3d{0, 1, 0}) > 0.45 && length(middle - Vec3d{0, 1, 0}) < 0.55) continue;
    EXPECT_EQ(file.materials[file.mesh.material_slots[t]].name, "red");
  }
}

}  // namespace
}  // namespace oktett::test::whole_scene_mesh_test
