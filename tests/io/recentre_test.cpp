// Meshes that lie far from the origin keep their details.

#include "io/mesh/recentre.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "io/mesh/load/load_mesh.h"
#include "io/mesh/save/convert_mesh.h"
#include "io/scene/scene_file.h"
#include "tests/support/temp_dir.h"

namespace oktett::test::recentre_test {
namespace {

/// A patch of ground in coordinates of a map, in centimetres.
std::vector<Vec3d> ground() {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> up_to(0, 9999);
  std::vector<Vec3d> points;
  for (int i = 0; i < 60; ++i)
    points.push_back(
        {432100 + up_to(random) * 0.01, 5411000 + up_to(random) * 0.01, 310 + up_to(random) * 0.001});
  return points;
}

std::string text_of(double x) { return fmt::format("{}", x); }

std::string obj_of(const std::vector<Vec3d>& points) {
  std::string text;
  for (const Vec3d& p : points) text += "v " + text_of(p.x) + " " + text_of(p.y) + " " + text_of(p.z) + "\n";
  for (std::size_t i = 3; i <= points.size(); i += 3) text += fmt::format("f {} {} {}\n", i - 2, i - 1, i);
  return text;
}

std::string off_of(const std::vector<Vec3d>& points) {
  std::string text = fmt::format("OFF\n{} {} 0\n", points.size(), points.size() / 3);
  for (const Vec3d& p : points) text += text_of(p.x) + " " + text_of(p.y) + " " + text_of(p.z) + "\n";
  for (std::size_t i = 0; i < points.size(); i += 3) text += fmt::format("3 {} {} {}\n", i, i + 1, i + 2);
  return text;
}

std::string stl_of(const std::vector<Vec3d>& points, bool loose) {
  std::string text = "solid a\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 3 == 0) text += loose ? "facet\nouter loop\n" : "facet normal 0 0 1\nouter loop\n";
    const Vec3d& p = points[i];
    text += "vertex " + text_of(p.x) + " " + text_of(p.y) + " " + text_of(p.z) + "\n";
    if (i % 3 == 2) text += "endloop\nendfacet\n";
  }
  return text + "endsolid a\n";
}

std::string ply_of(const std::vector<Vec3d>& points, const char* format) {
  const std::string form = format;
  std::string text = "ply\nformat " + form + " 1.0\nelement vertex " + std::to_string(points.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(points.size() / 3) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](const auto& value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (form == "binary_big_endian") bytes.assign(bytes.rbegin(), bytes.rend());
    text += bytes;
  };
  for (const Vec3d& p : points)
    if (form == "ascii")
      text += text_of(p.x) + " " + text_of(p.y) + " " + text_of(p.z) + "\n";
    else
      put(p.x), put(p.y), put(p.z);
  for (std::size_t i = 0; i < points.size(); i += 3)
    if (form == "ascii")
      text += fmt::format("3 {} {} {}\n", i, i + 1, i + 2);
    else
      put(std::uint8_t{3}), put(static_cast<std::int32_t>(i)), put(static_cast<std::int32_t>(i + 1)),
          put(static_cast<std::int32_t>(i + 2));
  return text;
}

/// Corners of the triangles in turn, where they are in double.
std::vector<Vec3d> corners_of(const TriangleMesh& mesh) {
  std::vector<Vec3d> corners;
  for (const std::uint32_t i : mesh.indices) corners.push_back(mesh.origin + Vec3d(mesh.positions[i]));
  return corners;
}

/// Floats of up to 128 are this near.
constexpr double kNear = 4e-6;

void expect_near(const std::vector<Vec3d>& found, const std::vector<Vec3d>& wanted, double most) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[i][k], wanted[i][k], most) << i << ' ' << k;
}

TEST(Recentre, AllFormatsKeepCentimetresOfMaps) {
  const TempDir dir;
  const std::vector<Vec3d> points = ground();
  const std::pair<std::string, std::string> files[] = {{"a.obj", obj_of(points)},
                                                       {"a.off", off_of(points)},
                                                       {"a.stl", stl_of(points, false)},
                                                       {"b.stl", stl_of(points, true)},
                                                       {"a.ply", ply_of(points, "ascii")},
                                                       {"b.ply", ply_of(points, "binary_little_endian")},
                                                       {"c.ply", ply_of(points, "binary_big_endian")}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const MeshFile file = load_mesh(dir.write(name, text));
    EXPECT_FALSE(file.mesh.origin == Vec3d{});
    expect_near(corners_of(file.mesh), points, kNear);
  }
}

TEST(Recentre, ConversionsKeepThemToo) {
  const TempDir dir;
  const std::vector<Vec3d> points = ground();
  const std::string input = dir.write("a.obj", obj_of(points));
  for (const char* name : {"b.obj", "b.ply", "t.ply", "t.stl"}) {
    SCOPED_TRACE(name);
    const std::string output = dir.file(name);
    const MeshLosses losses = convert_mesh(input, output, {.ascii = name[0] == 't'}).losses;
    EXPECT_TRUE(
        std::ranges::none_of(losses, [](const std::string& s) { return s.find("digits") != s.npos; }));
    expect_near(corners_of(load_mesh(output).mesh), points, 2 * kNear);
  }
  const MeshLosses losses = convert_mesh(input, dir.file("b.stl"), {}).losses;
  EXPECT_EQ(std::ranges::count(losses, "lost: digits of coordinates beyond single precision"), 1);
}

TEST(Recentre, NearMeshesStayAsTheyAre) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const float distance : {0.0f, 1.0f, 50.0f, 120.0f}) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 100; ++i)
      points.push_back({distance + unit(random) / 2, unit(random) / 2, unit(random) / 2});
    points.push_back({distance + 0.5f, 0, 0}), points.push_back({distance - 0.5f, 0, 0});
    EXPECT_FALSE(far_centre(points, true)) << distance;
  }
  EXPECT_FALSE(far_centre(std::vector<Vec3f>(9, Vec3f{1e6f, 0, 0}), true));  // a point has no extent
  EXPECT_FALSE(far_centre({}, true));
}

TEST(Recentre, CentresAreExactFloats) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    const float far = std::exp2(unit(random) * 40 - 10);
    std::vector<Vec3f> points;
    for (int k = 0; k < 20; ++k)
      points.push_back(
          {far * (1 + unit(random) / 400), -far * (1 + unit(random) / 400), unit(random) * far / 400});
    const std::optional<Vec3d> centre = far_centre(points, true);
    ASSERT_TRUE(centre);
    EXPECT_EQ(Vec3d(Vec3f(*centre)), *centre);
    TriangleMesh mesh;
    mesh.positions.resize_uninitialized(points.size());
    std::ranges::copy(points, mesh.positions.data());
    take_off(*centre, mesh);
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_EQ(mesh.origin + Vec3d(mesh.positions[k]), Vec3d(points[k]));
  }
}

// The same ground near the origin and far from it, with camera, light and motion, is the same scene.
TEST(Recentre, ScenesCountFromTheMesh) {
  const TempDir dir;
  std::vector<Vec3d> points = ground();
  dir.write("far.obj", obj_of(points));
  const Scene scene =
      load_scene(dir.write("far.yaml",
                           "oktett: 1\ncamera: {from: [432150, 5411050, 400], at: [432150, 5411051, 310]}\n"
                           "lights: [{point: {position: [432100, 5411000, 500]}}]\n"
                           "objects: [{mesh: {file: far.obj}}, {sphere: {radius: 1}, transform: {translate: "
                           "[432101, 5411002, 303]}}]\n"));
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_FALSE(scene.origin == Vec3d{});
  EXPECT_EQ(scene.origin + scene.camera.from, (Vec3d{432150, 5411050, 400}));
  EXPECT_LT(length(scene.camera.from), 300);
  EXPECT_EQ(scene.origin + std::get<PointLight>(scene.lights.at(0)).position, (Vec3d{432100, 5411000, 500}));
  EXPECT_EQ(scene.origin + scene.objects[1].transform.point({0, 0, 0}), (Vec3d{432101, 5411002, 303}));
  EXPECT_TRUE(scene.objects[0].transform.is_identity());
  const Scene alone = load_scene(dir.file("far.obj"));
  EXPECT_EQ(alone.origin, std::get<MeshShape>(alone.objects.at(0).shape).mesh->origin);
}

}  // namespace
}  // namespace oktett::test::recentre_test
