// Points and lines of mesh files, and what is seen of them.

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>

#include "core/mesh_geometry.h"
#include "io/mesh/save/convert_mesh.h"
#include "io/scene/scene_file.h"
#include "render/look/default_look.h"
#include "tests/io/gltf_test_support.h"
#include "tests/io/ply_test_support.h"
#include "tests/io/scene_test_support.h"
#include "tests/render/test_scenes.h"

namespace oktett::test::strokes_test {
namespace {

/// The two ends of each stroke.
using Ends = std::vector<std::array<Vec3f, 2>>;

Ends ends_of(const TriangleMesh& strokes) {
  Ends ends;
  for (std::size_t i = 0; i < strokes.indices.size(); i += 3) {
    EXPECT_EQ(strokes.indices[i + 1], strokes.indices[i + 2]);
    ends.push_back({strokes.positions[strokes.indices[i]], strokes.positions[strokes.indices[i + 1]]});
  }
  return ends;
}

Vec3f at(float x) { return {x, x * x, 1}; }
/// Ends by the numbers that at() makes points of.
Ends between(const std::vector<std::array<int, 2>>& numbers) {
  Ends ends;
  for (const auto& [a, b] : numbers) ends.push_back({at(static_cast<float>(a)), at(static_cast<float>(b))});
  return ends;
}
const std::string kFive = "v 0 0 1\nv 1 1 1\nv 2 4 1\nv 3 9 1\nv 4 16 1\n";

// ---- What files say.

TEST(Strokes, PointsAndLinesOfObjFiles) {
  const ObjFiles files;
  const auto strokes = [&](const std::string& text) { return ends_of(files.load(kFive + text).strokes); };
  EXPECT_EQ(strokes("p 3 1 3\n"), between({{2, 2}, {0, 0}, {2, 2}}));
  EXPECT_EQ(strokes("l 1 2 5\nf 1 2 3\nl -1 -5 # behind\nl 2\\\n 3\n"),
            between({{0, 1}, {1, 4}, {4, 0}, {1, 2}}));
  // Texture coordinates and normals of lines are of no use, and change nothing for faces.
  const ObjFile file = files.load(kFive + "vt 0 0\nvn 0 0 1\nl 1/1 2/1/1\nf 1 2 3\n");
  EXPECT_EQ(ends_of(file.strokes), between({{0, 1}}));
  EXPECT_TRUE(file.mesh.uv_indices.empty());
  EXPECT_TRUE(file.mesh.normal_indices.empty());
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(files.error(kFive + "p 1\nl 1 6\n"),
            "mesh.obj:7:5: vertex index 6 is out of range: the file defines 5");
  EXPECT_EQ(files.error(kFive + "l 1 x\n"),
            "mesh.obj:6:5: expected a corner such as 1, 1/2, 1//3 or 1/2/3, found 'x'");
  EXPECT_EQ(files.warnings(kFive + "l 1\np\nf 1 2 3\n"),
            std::vector<std::string>{
                "mesh.obj:6:1: warning: 2 lines or points without vertices to join are skipped"});
  // However the file is cut.
  for (std::size_t bytes = 1; bytes < 40; bytes += 3)
    EXPECT_EQ(
        ends_of(files.load(kFive + "l 1 2 5\nf 1 2 3\np 4 3\nl -1 -5\n", {.chunk_bytes = bytes}).strokes),
        between({{0, 1}, {1, 4}, {3, 3}, {2, 2}, {4, 0}}));
}

TEST(Strokes, MaterialsOfObjFilesHoldForThem) {
  const ObjFiles files;
  files.write("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  const ObjFile file = files.load("mtllib m.mtl\n" + kFive +
                                  "p 1\nusemtl red\nf 1 2 3\nl 1 2 3\nusemtl blue\np 2\nusemtl red\nl 4 5\n");
  const auto name = [&](std::size_t stroke) {
    return file.materials.at(file.strokes.material_slots[stroke]).name;
  };
  ASSERT_EQ(file.strokes.material_slots.size(), 5u);
  EXPECT_EQ((std::vector{name(1), name(2), name(3), name(4)}),
            (std::vector<std::string>{"red", "red", "blue", "red"}));
  EXPECT_NE(name(0), "red");
  EXPECT_EQ(file.materials.at(file.mesh.material_slots[0]).name, "red");
}

TEST(Strokes, VerticesWithoutFacesArePoints) {
  const ObjFiles files;
  const ObjFile obj = files.load("v 0 0 1 1 0 0\nv 1 1 1 0 1 0\nv 2 4 1 0 0 1\n");
  EXPECT_EQ(ends_of(obj.strokes), between({{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_TRUE(obj.warnings.empty());
  const MeshAttribute* const colors = find_attribute(obj.strokes, "color");
  ASSERT_NE(colors, nullptr);
  for (std::uint32_t i = 0; i < 3; ++i)
    for (std::uint32_t k = 0; k < 3; ++k) EXPECT_EQ(colors->value(i, k), i == k ? 1 : 0);
  const MeshFile off = load_mesh(files.write("a.off", "OFF\n3 0 0\n0 0 1\n1 1 1\n2 4 1\n"));
  EXPECT_EQ(ends_of(off.strokes), between({{0, 0}, {1, 1}, {2, 2}}));
  // Not of files with faces.
  EXPECT_TRUE(files.load(kFive + "f 1 2 3\n").strokes.indices.empty());
}

TEST(Strokes, CloudsAndEdgesOfPlyFiles) {
  const PlyFiles files;
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::little_endian, PlyFormat::big_endian})
    for (const bool with_edges : {false, true})
      for (const PlyType index : {PlyType::uint8, PlyType::int32, PlyType::uint32}) {
        PlyWriter out(format);
        out.element("vertex", 4);
        for (const char* name : {"x", "y", "z"}) out.property(PlyType::float32, name);
        for (const char* name : {"red", "green", "blue"}) out.property(PlyType::uint8, name);
        if (with_edges) {
          out.element("edge", 2);
          out.property(index, "vertex1"), out.property(PlyType::float32, "weight"),
              out.property(index, "vertex2");
        }
        for (int i = 0; i < 4; ++i) {
          const Vec3f p = at(static_cast<float>(i));
          for (int k = 0; k < 3; ++k) out.value(PlyType::float32, static_cast<double>(p[k]));
          for (int k = 0; k < 3; ++k) out.value(PlyType::uint8, k == i ? 255 : 0);
          out.end_record();
        }
        if (with_edges)
          for (const auto& [a, b] : {std::pair{3, 1}, {1, 2}}) {
            out.value(index, a), out.value(PlyType::float32, 0.5), out.value(index, b);
            out.end_record();
          }
        const MeshFile file = files.load(out.bytes());
        EXPECT_EQ(ends_of(file.strokes),
                  with_edges ? between({{3, 1}, {1, 2}}) : between({{0, 0}, {1, 1}, {2, 2}, {3, 3}}));
        const MeshAttribute* const colors = find_attribute(file.strokes, "color");
        ASSERT_NE(colors, nullptr);
        // Only the vertices that are used are there: 1, 2 and 3, with edges.
        const std::size_t green = with_edges ? 0 : 1;
        EXPECT_EQ(colors->value(green, 0), 0);
        EXPECT_EQ(colors->value(green, 1), 1);
        EXPECT_EQ(file.strokes.positions.size(), with_edges ? 3u : 4u);
        EXPECT_EQ(file.warnings.size(), with_edges ? 1u : 0u);
      }
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
      "end_header\n0 0 0\n";
  EXPECT_EQ(files.error(head + "0 1\n"),
            "a.ply:12:3: vertex index 1 is out of range: the file has 1 vertices");
  EXPECT_EQ(files.error(head + "0 -1\n"),
            "a.ply:12:3: vertex index -1 is out of range: the file has 1 vertices");
}

std::string primitive(const std::string& more) { return "{\"attributes\":{\"POSITION\":0}" + more + "}"; }

/// Five points and the indices 4 0 2 3.
GltfWriter five_points() {
  GltfWriter out;
  std::vector<Vec3f> points;
  for (int i = 0; i < 5; ++i) points.push_back(at(static_cast<float>(i)));
  out.vectors(points);
  out.array(std::vector<std::uint8_t>{4, 0, 2, 3}, kUint8, "SCALAR", 1);
  return out;
}

// glTF 2.0, 3.7.2.1.
TEST(Strokes, ModesOfGltfFiles) {
  const GltfFiles files;
  const GltfWriter out = five_points();
  const auto strokes = [&](const std::string& more) {
    const MeshFile file = files.load(out.glb(one_node(primitive(more))));
    EXPECT_EQ(file.mesh.triangle_count(), 0u);
    return ends_of(file.strokes);
  };
  EXPECT_EQ(strokes(",\"mode\":0"), between({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}}));
  EXPECT_EQ(strokes(",\"mode\":1"), between({{0, 1}, {2, 3}}));
  EXPECT_EQ(strokes(",\"mode\":2"), between({{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}}));
  EXPECT_EQ(strokes(",\"mode\":3"), between({{0, 1}, {1, 2}, {2, 3}, {3, 4}}));
  EXPECT_EQ(strokes(",\"mode\":0,\"indices\":1"), between({{4, 4}, {0, 0}, {2, 2}, {3, 3}}));
  EXPECT_EQ(strokes(",\"mode\":1,\"indices\":1"), between({{4, 0}, {2, 3}}));
  EXPECT_EQ(strokes(",\"mode\":2,\"indices\":1"), between({{4, 0}, {0, 2}, {2, 3}, {3, 4}}));
  EXPECT_EQ(strokes(",\"mode\":3,\"indices\":1"), between({{4, 0}, {0, 2}, {2, 3}}));
  EXPECT_EQ(
      files.warnings(out.glb(one_node(primitive(",\"mode\":1")))),
      std::vector<std::string>{"a.glb: warning: meshes[0].primitives[0]: expected two ends for each line, "
                               "found 5 in all; the last one is left out"});
  // Triangles and strokes of one mesh come apart.
  const MeshFile both = files.load(out.glb(one_node(primitive("") + "," + primitive(",\"mode\":3"))));
  EXPECT_EQ(both.mesh.triangle_count(), 1u);
  EXPECT_EQ(both.strokes.triangle_count(), 4u);
}

// ---- What is seen.

/// The scene of a file in this text, without light, its camera `size` pixels wide.
Scene seen(const SceneFiles& files, const std::string& objects, const char* kind = "normal",
           std::uint32_t size = 48) {
  return files.load_v1("camera: {from: [0.3, 0.4, 6], at: [0, 0, 0], fov: 40}\nfilm: {width: " +
                       std::to_string(size) + ", height: " + std::to_string(size) +
                       "}\nintegrator: {kind: " + kind + ", samples: 1}\nlights: []\nobjects:\n" + objects);
}

float greatest_difference(const Picture& a, const Picture& b, const char* plane) {
  const PicturePlane &p = *a.find(plane), &q = *b.find(plane);
  float most = 0;
  for (std::size_t i = 0; i < p.values.size(); ++i)
    if (std::isfinite(p.values[i]) || std::isfinite(q.values[i]))
      most = std::max(most, std::abs(p.values[i] - q.values[i]));
  return most;
}

std::size_t pixels_shown(const Picture& picture) {
  return static_cast<std::size_t>(std::ranges::count(picture.find("A")->values, 1.0f));
}

TEST(Strokes, PointsAreBallsOfTheWidth) {
  const SceneFiles files;
  files.dir.write("a.obj", "v -1 0 0\nv 0.5 1 0\nv 1 -1 0.5\n");
  const Picture cloud = run(seen(files, "  - mesh: {file: a.obj, stroke_width: 0.8}\n")).picture;
  const Picture balls =
      run(seen(files, "  - spheres: {centers: [[-1, 0, 0], [0.5, 1, 0], [1, -1, 0.5]], radius: 0.4}\n"))
          .picture;
  EXPECT_GT(pixels_shown(cloud), 100u);
  for (const char* plane : {"R", "G", "B", "Z"})
    EXPECT_EQ(greatest_difference(cloud, balls, plane), 0) << plane;
}

/// A capsule is a cylinder with a ball at each end.
TEST(Strokes, LinesAreCapsulesOfTheWidth) {
  const SceneFiles files;
  files.dir.write("a.obj", "v -1 -1 0\nv 1 0.5 1\nv 0.5 1.5 -1\nl 1 2 3\np 1\n");
  const std::string stretched = ", transform: [{rotate: [10, 20, 30]}, {scale: [1.3, 0.8, 1]}]";
  for (const std::string& transform : {std::string(), std::string(", transform: {scale: 1.2}"), stretched}) {
    const Picture lines =
        run(seen(files, "  - {mesh: {file: a.obj, stroke_width: 0.5}" + transform + "}\n")).picture;
    std::string objects;
    for (const char* center : {"[-1, -1, 0]", "[1, 0.5, 1]", "[0.5, 1.5, -1]"})
      objects += std::string("  - {sphere: {radius: 0.25, center: ") + center + "}" + transform + "}\n";
    for (const char* line : {"from: [-1, -1, 0], to: [1, 0.5, 1]", "from: [1, 0.5, 1], to: [0.5, 1.5, -1]"})
      objects += std::string("  - {cylinder: {radius: 0.25, open: true, ") + line + "}" + transform + "}\n";
    const Picture parts = run(seen(files, objects)).picture;
    EXPECT_GT(pixels_shown(lines), 150u);
    EXPECT_EQ(pixels_shown(lines), pixels_shown(parts));
    EXPECT_LT(greatest_difference(lines, parts, "Z"), 1e-5f) << transform;
    for (const char* plane : {"R", "G", "B"}) EXPECT_LT(greatest_difference(lines, parts, plane), 2e-3f);
  }
}

/// Colours along a line are those of its ends by the nearest point of its axis.
TEST(Strokes, ColorsOfEndsBlendAlongLines) {
  const SceneFiles files;
  files.dir.write("a.obj", "v -1.5 0 0 1 0 0\nv 1.5 0 0 0 0 1\nl 1 2\n");
  const Picture picture =
      run(seen(files,
               "  - mesh: {file: a.obj, stroke_width: 0.6}\n    material: {color: {attribute: color}}\n",
               "albedo"))
          .picture;
  std::size_t count = 0;
  for (std::uint32_t y = 0; y < 48; ++y)
    for (std::uint32_t x = 0; x < 48; ++x) {
      if (value(picture, "A", x, y) != 1) continue;
      const float part = std::clamp((position(picture, x, y).x + 1.5f) / 3, 0.0f, 1.0f);
      const Color seen_color = color(picture, x, y);
      EXPECT_NEAR(seen_color.x, 1 - part, 1e-5);
      EXPECT_EQ(seen_color.y, 0);
      EXPECT_NEAR(seen_color.z, part, 1e-5);
      ++count;
    }
  EXPECT_GT(count, 60u);
}

/// Then there are balls alone, behind other geometries.
TEST(Strokes, LinesWithoutLengthAreBalls) {
  const SceneFiles files;
  files.dir.write("a.obj", "v 0 0 0 0 1 0\nv 0 0 0 0 1 0\nl 1 2\n");
  const Picture picture = run(seen(files,
                                   "  - sphere: {radius: 0.1, center: [0, 0, -20]}\n"
                                   "  - mesh: {file: a.obj, stroke_width: 1.2}\n"
                                   "    material: {color: {attribute: color}}\n",
                                   "albedo"))
                              .picture;
  EXPECT_GT(pixels_shown(picture), 100u);
  EXPECT_EQ(color(picture, 24, 24), (Color{0, 1, 0}));
}

/// The width is that of the file in the world, however a node stretches its places, and skins bend them.
TEST(Strokes, NodesOfGltfFilesMoveThemWithoutStretchingThem) {
  const GltfFiles files;
  const GltfWriter out = five_points();
  const std::string path = files.files.write(
      "a.glb", out.glb("\"meshes\":[{\"primitives\":[" + primitive(",\"mode\":0") +
                       "]}],\"nodes\":[{\"mesh\":0,\"scale\":[2,0.5,1],\"translation\":[0,0,3]}],"
                       "\"scenes\":[{\"nodes\":[0]}]"));
  GltfOptions options;
  options.stroke_width = 0.25;
  const Scene scene = scene_from_mesh(path, options);
  ASSERT_EQ(scene.objects.size(), 1u);
  const auto& shape = std::get<MeshShape>(scene.objects[0].shape);
  EXPECT_TRUE(scene.objects[0].transform.is_identity());
  EXPECT_EQ(shape.stroke_width, 0.25);
  Ends expected;
  for (int i = 0; i < 5; ++i) {
    const Vec3f p = at(static_cast<float>(i));
    expected.push_back({Vec3f{2 * p.x, p.y / 2, p.z + 3}, Vec3f{2 * p.x, p.y / 2, p.z + 3}});
  }
  EXPECT_EQ(ends_of(*shape.mesh), expected);
}

TEST(Strokes, AnimationsSkinsAndMorphTargetsMoveThem) {
  const GltfFiles files;
  GltfWriter out = five_points();
  std::vector<float> times{0, 1}, moves{0, 0, 0, 4, 0, 0}, weights{1, 0.5f};
  std::vector<Vec3f> shifts(5, Vec3f{0, 0, 2});
  out.array(times, kFloat, "SCALAR", 1), out.array(moves, kFloat, "VEC3", 3);
  out.vectors(shifts);
  const std::string path = files.files.write(
      "a.glb",
      out.glb(
          "\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":3,"
          "\"targets\":[{\"POSITION\":4}]}]}],\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2]}],"
          "\"scenes\":[{\"nodes\":[0]}],\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":"
          "0,\"path\":\"translation\"}}],\"samplers\":[{\"input\":2,\"output\":3}]}]"));
  GltfOptions options;
  options.time = 0.5, options.shutter = 0.5;
  const FileScene scene = load_gltf_scene(path, options);
  ASSERT_EQ(scene.placements.size(), 1u);
  const PlacedMesh& placement = scene.placements[0];
  ASSERT_TRUE(placement.motion);
  const Vec3d start(ends_of(*scene.meshes[placement.mesh].mesh)[3][1]);
  EXPECT_EQ(start, (Vec3d{2 * 4 + 2, 2 * 16, 2 * (1 + 0.5 * 2)}));
  EXPECT_LT(length(placement.motion->at(1).point(start) - (start + Vec3d{2, 0, 0})), 1e-5);
}

// 1/200 of the diagonal, of many points that by the square root of their number.
TEST(Strokes, TheUsualWidthFollowsFromTheSurroundingsAndTheNumber) {
  const SceneFiles files;
  files.dir.write("few.obj", "v 0 0 0\nv 3 4 12\n");
  std::string many = "v 0 0 0\nv 3 4 12\n";
  for (int i = 0; i < 160000 - 2; ++i) many += "v 1 2 3\n";
  files.dir.write("many.obj", many);
  for (const auto& [name, count, part] : {std::tuple{"few.obj", "2", 200.0}, {"many.obj", "160000", 400.0}}) {
    const Scene scene = scene_from_mesh(files.dir.file(name));
    EXPECT_NEAR(std::get<MeshShape>(scene.objects.at(0).shape).stroke_width, 13 / part, 1e-6);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(files.without_directory(to_string(scene.warnings[0])),
              std::string(name) + ": warning: " + count + " points: shown " +
                  (part == 200 ? "0.065" : "0.0325") +
                  " wide; --stroke-width, or stroke_width of a mesh in a scene, says otherwise");
  }
  // With triangles beside them, these count, too.
  files.dir.write("both.obj", "v 0 0 0\nv 3 4 0\nv 3 4 12\nf 1 2 3\nl 1 2\n");
  const Scene scene = files.load_v1("objects: [{mesh: {file: both.obj}}]\n");
  ASSERT_EQ(scene.objects.size(), 2u);
  double width = 0;
  for (const Object& object : scene.objects)
    width = std::max(width, std::get<MeshShape>(object.shape).stroke_width);
  EXPECT_NEAR(width, 13 / 200.0, 1e-6);
}

/// A cloud alone fills the picture of its look.
TEST(Strokes, ACloudAloneIsShown) {
  const SceneFiles files;
  std::string text;
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 3000; ++i) {
    const Vec3f p = normalize(Vec3f{normal(random), normal(random), normal(random)});
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + " 1 0 0\n";
  }
  for (const std::string& all : {text, std::string("v 5 5 5 1 0 0\n")}) {
    files.dir.write("a.obj", all);
    Scene scene = scene_from_mesh(files.dir.file("a.obj"));
    ASSERT_TRUE(is_mesh_alone(scene));
    apply_look(scene, Look::studio);
    scene.film.width = 60, scene.film.height = 40, scene.integrator.samples = 4;
    scene.integrator.kind = IntegratorKind::albedo;
    const Picture picture = run(scene).picture;
    // The part of the picture that is red; the ground is grey.
    double red = 0;
    for (std::uint32_t y = 0; y < 40; ++y)
      for (std::uint32_t x = 0; x < 60; ++x)
        red += value(picture, "R", x, y) - value(picture, "G", x, y) > 0.2f;
    EXPECT_GT(red, 0.15 * 60 * 40);
  }
}

TEST(Strokes, ScenesSayWhatIsWrong) {
  const SceneFiles files;
  files.dir.write("line.obj",
                  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nl 1 2\n");
  files.dir.write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_starts(files.error_v1("objects: [{mesh: {file: line.obj, stroke_width: 0}}]\n"),
                "scene.yaml:2:49: ");
  EXPECT_EQ(files.warnings_v1("objects: [{mesh: {file: plain.obj, stroke_width: 1}}]\n"),
            "scene.yaml:2:50: warning: 'stroke_width' has no effect: the file has no points and lines\n");
  // Combinations are of what has an inside.
  EXPECT_EQ(files.warnings_v1("objects: [{union: [{mesh: {file: line.obj}}, {sphere: }]}]\n"),
            "scene.yaml:2:27: warning: points and lines of the mesh are skipped: they have no inside\n");
}

TEST(Strokes, ConversionsSayThatTheyAreLost) {
  const ObjFiles files;
  files.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2 3\np 1\n");
  for (const char* to : {"b.ply", "b.stl", "b.glb", "b.obj"})
    EXPECT_EQ(convert_mesh(files.dir.file("a.obj"), files.dir.file(to), {}).losses,
              std::vector<std::string>{"lost: 1 point and 2 lines"});
}

}  // namespace
}  // namespace oktett::test::strokes_test
