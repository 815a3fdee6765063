// Meshes that lie far from the origin keep their details.

#include "core/far_mesh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "accel/accel.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/mesh_output.h"
#include "io/mesh/save/convert_mesh.h"
#include "io/scene/scene_file.h"
#include "render/geometry.h"
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

// In single precision all corners would fall together.
TEST(Recentre, ThingsOfCentimetresKeepMicrometres) {
  const TempDir dir;
  std::vector<Vec3d> points = ground();
  for (Vec3d& p : points) p = Vec3d{432100, 5411000, 310} + (p - Vec3d{432100, 5411000, 310}) * 0.0005;
  for (const auto& [name, text] :
       {std::pair{"a.obj", obj_of(points)}, std::pair{"a.off", off_of(points)},
        std::pair{"a.stl", stl_of(points, false)}, std::pair{"a.ply", ply_of(points, "ascii")},
        std::pair{"b.ply", ply_of(points, "binary_little_endian")}}) {
    SCOPED_TRACE(name);
    const MeshFile file = load_mesh(dir.write(name, text));
    EXPECT_FALSE(file.mesh.origin == Vec3d{});
    expect_near(corners_of(file.mesh), points, 1e-7);
    EXPECT_TRUE(file.warnings.empty());
  }
}

/// Warnings of a file that say that rounding changed triangles.
std::size_t count_rounded(const std::vector<Warning>& warnings) {
  return static_cast<std::size_t>(std::ranges::count_if(
      warnings, [](const Warning& w) { return w.message.find("lie so far apart") != std::string::npos; }));
}

// A corner that no face has, or a second part, at (0, 0, 0) keeps a centre from being taken off.
TEST(Recentre, PartsTooFarApartAreAWarning) {
  const TempDir dir;
  std::vector<Vec3d> points = ground();
  for (int i = 0; i < 3; ++i) points.push_back({i % 2 * 1.0, i / 2 * 1.0, 0});
  const std::pair<std::string, std::string> files[] = {
      {"a.obj", obj_of(points)},          {"a.off", off_of(points)},
      {"a.stl", stl_of(points, false)},   {"b.stl", stl_of(points, true)},
      {"a.ply", ply_of(points, "ascii")}, {"b.ply", ply_of(points, "binary_big_endian")}};
  // Steps of half a metre are 1 in 200 of the extent of this ground, and a tenth of the extent of the next.
  for (const auto& [name, text] : files)
    EXPECT_EQ(count_rounded(load_mesh(dir.write(name, text)).warnings), 0u) << name;
  std::vector<Vec3d> small;
  for (const Vec3d& p : points)
    small.push_back(p.x < 2 ? p : Vec3d{432100, 5411000, 310} + (p - Vec3d{432100, 5411000, 310}) * 0.05);
  const std::pair<std::string, std::string> lossy[] = {
      {"c.obj", obj_of(small)},          {"c.off", off_of(small)},
      {"c.stl", stl_of(small, false)},   {"d.stl", stl_of(small, true)},
      {"c.ply", ply_of(small, "ascii")}, {"d.ply", ply_of(small, "binary_big_endian")}};
  for (const auto& [name, text] : lossy) {
    SCOPED_TRACE(name);
    const MeshFile file = load_mesh(dir.write(name, text));
    EXPECT_TRUE(file.mesh.origin == Vec3d{});
    EXPECT_EQ(count_rounded(file.warnings), 1u);
    // Its positions are those that are nearest, all the same.
    for (std::size_t i = 0; i < small.size(); ++i)
      EXPECT_EQ(file.mesh.positions[file.mesh.indices[i]], Vec3f(small[i]));
  }
}

// Digits that the file does not have are not lost by reading it.
TEST(Recentre, CollapsedFilesAreNoWarning) {
  const TempDir dir;
  std::vector<Vec3d> points;
  for (int i = 0; i < 300; ++i)
    points.push_back({i < 30 ? i * 1.0 : 432100.0, i < 30 ? i % 7 : 5411000.0, i % 2 * 0.5});
  EXPECT_EQ(count_rounded(load_mesh(dir.write("a.obj", obj_of(points))).warnings), 0u);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  points.clear();
  // A million of such triangles would cover a metre.
  for (int i = 0; i < 300; ++i) {
    const Vec3d middle{unit(random), unit(random), unit(random)};
    for (int k = 0; k < 3; ++k)
      points.push_back(middle + Vec3d{unit(random), unit(random), unit(random)} * 1e-3);
  }
  EXPECT_TRUE(load_mesh(dir.write("b.obj", obj_of(points))).warnings.empty());
}

/// What rays from above find of a scene whose camera looks straight down at `middle`: t, or infinity.
std::vector<float> depths(const Scene& scene, const Vec3d& middle) {
  const World world = build_world(scene);
  std::vector<float> found;
  for (int y = -8; y <= 8; ++y)
    for (int x = -8; x <= 8; ++x) {
      const Vec3d from = middle - scene.origin + Vec3d{x * 0.21 + 0.013, y * 0.19 + 0.007, 9};
      found.push_back(closest_hit(*world.accel, Ray{Vec3f(from), 0, {0, 0, -1}, 100}).t);
    }
  return found;
}

/// How many are alike to 1e-5; the others, seen at edges, are not counted.
std::size_t count_alike(const std::vector<float>& a, const std::vector<float>& b) {
  std::size_t alike = 0;
  for (std::size_t i = 0; i < a.size(); ++i) alike += a[i] == b[i] || std::abs(a[i] - b[i]) < 1e-5f;
  return alike;
}

const char* const kMap = "[432100.25, 5411000.5, 300.125]";
const Vec3d kMiddle{432100.25, 5411000.5, 300.125};

/// A closed box from -1 to 1, or a part of the map.
std::string cube(const Vec3d& at) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += "v " + text_of(at.x + (i & 1 ? 1 : -1)) + " " + text_of(at.y + (i & 2 ? 1 : -1)) + " " +
            text_of(at.z + (i & 4 ? 1 : -1)) + "\n";
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

// Combinations and prototypes have spaces of their own, in which rays are floats, too; and transforms alone
// can lead far away.
TEST(Recentre, InnerSpacesAndTransformsKeepDigits) {
  const TempDir dir;
  dir.write("far.obj", cube(kMiddle)), dir.write("near.obj", cube({}));
  const auto scene_of = [](const std::string& file, const std::string& at, int kind) {
    const std::string mesh = "{mesh: {file: " + file + "}}",
                      ball = "{sphere: {center: " + at + ", radius: 1.3}}", back = kind == 3 ? "far" : "";
    const std::string there = "transform: {translate: " + at + "}";
    switch (kind) {
      case 0:
        return "objects: [{difference: [" + mesh + ", " + ball + "]}]\n";
      case 1:
        return "define: {a: {group: [" + mesh + ", " + ball + "]}}\nobjects: [{instance: a}]\n";
      case 2:
        return "objects: [" + ball + "]\n";
      case 3:
        return "objects: [{mesh: {file: near.obj}, " + there +
               "}, {difference: [{box: {}}, {sphere: {radius: "
               "1.3}}], " +
               there + "}]\n";
      default:
        return "define: {a: {torus: {major: 1, minor: 0.3}}}\nobjects: [{instance: a, " + there + "}]\n";
    }
  };
  for (int kind = 0; kind < 5; ++kind) {
    SCOPED_TRACE(kind);
    const Scene near =
        load_scene(dir.write("near.yaml", "oktett: 1\n" + scene_of("near.obj", "[0, 0, 0]", kind)));
    const Scene far = load_scene(dir.write("far.yaml", "oktett: 1\n" + scene_of("far.obj", kMap, kind)));
    EXPECT_TRUE(near.origin == Vec3d{});
    EXPECT_FALSE(far.origin == Vec3d{});
    EXPECT_LT(length(far.origin - kMiddle), 8);
    EXPECT_TRUE(far.warnings.empty());
    const std::vector<float> wanted = depths(near, {}), found = depths(far, kMiddle);
    EXPECT_GE(count_alike(wanted, found), wanted.size() - 4);
    EXPECT_GT(std::ranges::count_if(wanted, [](float t) { return t < 100; }), 20);
  }
  // An instance may bring its prototype back.
  const Scene home = load_scene(
      dir.write("home.yaml",
                "oktett: 1\ndefine: {a: {mesh: {file: far.obj}}}\nobjects: [{instance: a, transform: "
                "{translate: [-432100.25, -5411000.5, -300.125]}}]\n"));
  EXPECT_TRUE(home.origin == Vec3d{});
  EXPECT_EQ(count_alike(depths(home, {}), depths(load_scene(dir.file("near.obj")), {})), 17u * 17);
}

/// A glTF file of nodes that show a triangle with corners at (0, 0, 0), (1, 0, 0) and (0, 1, 0), or a camera.
std::string gltf_of(const std::string& nodes, const std::string& which) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + which + R"(]}],"nodes":[)" + nodes +
         R"(],"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}],)" +
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)" +
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)" +
         R"("min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[)" +
         R"({"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
         R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

TEST(Recentre, NodesOfGltfFilesKeepDigits) {
  const TempDir dir;
  const std::string far = R"({"mesh":0,"translation":[432100.3,5411000.7,300.1],"scale":[0.3,0.3,0.3]})";
  const Vec3d at{432100.3, 5411000.7, 300.1};
  const std::vector<Vec3d> wanted{at, at + Vec3d{0.3, 0, 0}, at + Vec3d{0, 0.3, 0}};
  const MeshFile file = load_mesh(dir.write("a.gltf", gltf_of(far, "0")));
  expect_near(corners_of(file.mesh), wanted, 1e-7);
  EXPECT_TRUE(file.warnings.empty());
  // Written and read again.
  convert_mesh(dir.file("a.gltf"), dir.file("b.glb"), {});
  expect_near(corners_of(load_mesh(dir.file("b.glb")).mesh), wanted, 2e-7);
  // A scene of its own, for its camera.
  const Scene scene = load_scene(
      dir.write("c.gltf", gltf_of(far + R"(,{"camera":0,"translation":[432100.4,5411000.8,302]})", "0,1")));
  EXPECT_LT(length(scene.origin - at), 4);
  EXPECT_LT(length(scene.origin + scene.camera.from - Vec3d{432100.4, 5411000.8, 302}), 1e-8);
  EXPECT_LT(length(scene.origin + scene.objects.at(0).transform.point({0, 0, 0}) - at), 1e-8);
  EXPECT_LT(length(scene.objects.at(0).transform.point({0, 0, 0})), 4);
  // One mesh of a node here and one there cannot keep them.
  EXPECT_EQ(count_rounded(load_mesh(dir.write("d.gltf", gltf_of(far + R"(,{"mesh":0})", "0,1"))).warnings),
            1u);
}

/// Of points and lines alone two vertices are too few to tell that they are far.
TEST(Recentre, StrokesCountFromWhereTrianglesDo) {
  const TempDir dir;
  std::string text = gltf_of(R"({"mesh":0,"translation":[432100,5411000,300]})", "0");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace(R"({"attributes":{"POSITION":0}})",
          R"({"attributes":{"POSITION":0}},{"mode":1,"attributes":{"POSITION":1}})");
  replace(
      R"("max":[1,1,0]})",
      R"("max":[1,1,0]},{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3","min":[0,0,0],"max":[1,0,0]})");
  const std::string path = dir.write("a.gltf", text);
  const MeshFile file = load_mesh(path);
  ASSERT_EQ(file.strokes.triangle_count(), 1u);
  EXPECT_FALSE(file.mesh.origin == Vec3d{});
  EXPECT_EQ(file.strokes.origin, file.mesh.origin);
  expect_near(corners_of(file.mesh), {{432100, 5411000, 300}, {432101, 5411000, 300}, {432100, 5411001, 300}},
              1e-7);
  // So the line is as wide as a part of what is seen.
  for (const Object& object : scene_from_mesh(path).objects)
    EXPECT_LT(std::get<MeshShape>(object.shape).stroke_width, 0.01);
}

TEST(Recentre, ObjectsTooFarFromOthersAreAWarning) {
  const TempDir dir;
  dir.write("far.obj", cube(kMiddle));
  const auto lost = [](const Scene& scene) {
    return std::ranges::count_if(scene.warnings, [](const Warning& w) {
      return w.message.find("details are lost") != std::string::npos;
    });
  };
  const Scene scene = load_scene(dir.write("a.yaml",
                                           "oktett: 1\nobjects: [{sphere: {radius: 1}, name: ball}, {mesh: "
                                           "{file: far.obj}}, {sphere: {radius: 2}}]\n"));
  EXPECT_LT(length(scene.origin - kMiddle), 4);
  ASSERT_EQ(lost(scene), 1);
  EXPECT_EQ(scene.warnings.at(0).where.line, 2);
  EXPECT_TRUE(
      scene.warnings.at(0).message.starts_with("'ball' (and one more) of the extent 2 lies 5.41e+06 away"))
      << scene.warnings.at(0).message;
  // A town with a bolt, and one in kilometres around a scan.
  for (const char* text :
       {"objects: [{box: {min: [-5000, -5000, 0], max: [5000, 5000, 1]}}, {sphere: {radius: 0.1, center: "
        "[4000, 3000, 2]}}]\n",
        "objects: [{mesh: {file: far.obj}}, {sphere: {radius: 1, center: [440000, 5411000, 300]}}]\n"})
    EXPECT_EQ(lost(load_scene(dir.write("b.yaml", std::string("oktett: 1\n") + text))), 0) << text;
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
