// The same mesh in files of all formats is the same picture, in all bits of all layers.

#include <cmath>

#include "io/scene/scene_file.h"
#include "render/picture/render.h"
#include "tests/io/gltf_test_support.h"
#include "tests/io/ply_test_support.h"

namespace oktett::test::mesh_formats_test {
namespace {

/// A bumpy ball of triangles.
MeshModel ball() {
  constexpr std::uint32_t kRows = 24, kColumns = 32;
  MeshModel model;
  for (std::uint32_t y = 0; y <= kRows; ++y)
    for (std::uint32_t x = 0; x < kColumns; ++x) {
      const double a = 3.14159 * y / kRows, b = 6.28319 * x / kColumns,
                   r = 1 + 0.1 * std::sin(5 * b) * std::sin(a);
      model.positions.push_back(static_cast<Vec3f>(
          Vec3d{r * std::sin(a) * std::cos(b), r * std::cos(a), r * std::sin(a) * std::sin(b)}));
    }
  for (std::uint32_t y = 0; y < kRows; ++y)
    for (std::uint32_t x = 0; x < kColumns; ++x) {
      const std::uint32_t i = y * kColumns + x, j = y * kColumns + (x + 1) % kColumns;
      model.faces.push_back({{i, j, j + kColumns}, {}});
      model.faces.push_back({{i, j + kColumns, i + kColumns}, {}});
    }
  return model;
}

std::string stl_of(const MeshModel& model) {
  std::string bytes(80, ' ');
  append_bytes(bytes, static_cast<std::uint32_t>(model.faces.size()));
  for (const MeshModel::Face& face : model.faces) {
    bytes.append(12, '\0');
    for (const std::uint32_t i : face.corners)
      for (const float x : {model.positions[i].x, model.positions[i].y, model.positions[i].z})
        append_bytes(bytes, x);
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string glb_of_model(const MeshModel& model) {
  GltfWriter out;
  out.vectors(model.positions);
  std::vector<std::uint32_t> corners;
  for (const MeshModel::Face& face : model.faces)
    corners.insert(corners.end(), face.corners.begin(), face.corners.end());
  out.array(corners, kUint32, "SCALAR", 1);
  return out.glb(one_node("{\"attributes\":{\"POSITION\":0},\"indices\":1}"));
}

TEST(MeshFormats, PicturesAreTheSame) {
  const ObjFiles files;
  const MeshModel model = ball();
  files.write("a.obj", obj_text(model));
  files.write("a.ply", ply_bytes(model, {.format = PlyFormat::little_endian}));
  files.write("a.stl", stl_of(model));
  files.write("a.glb", glb_of_model(model));
  RenderOptions options;
  std::vector<Picture> pictures;
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb"}) {
    // Camera and lights are those of a mesh given alone.
    Scene scene = load_scene(files.dir.file(name));
    scene.film.width = 48, scene.film.height = 40;
    scene.camera.up = {0, 1, 0};  // STL stands upright by itself
    pictures.push_back(render(std::move(scene), options).picture);
  }
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    ASSERT_EQ(pictures[i].planes.size(), pictures[0].planes.size());
    for (std::size_t k = 0; k < pictures[0].planes.size(); ++k) {
      EXPECT_TRUE(same_bytes(pictures[i].planes[k].values, pictures[0].planes[k].values))
          << pictures[0].planes[k].name;
      EXPECT_TRUE(same_bytes(pictures[i].planes[k].ids, pictures[0].planes[k].ids))
          << pictures[0].planes[k].name;
    }
  }
  const PicturePlane* const alpha = pictures[0].find("A");
  ASSERT_NE(alpha, nullptr);
  EXPECT_GT(std::count(alpha->values.begin(), alpha->values.end(), 1.0f), 400);
}

// The mark before UTF-8 is left out of every text; bytes that happen to begin like it stay.
TEST(MeshFormats, ByteOrderMarks) {
  const std::string mark = "\xef\xbb\xbf";
  const ObjFiles files;
  const MeshModel model{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}, {}, {}, {{{0, 1, 2}, {}}, {{1, 3, 2}, {}}}};
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n";
  std::string header = ply_bytes(model, {.format = PlyFormat::ascii});
  const std::string body = header.substr(header.find("end_header\n") + 11);
  header.resize(header.size() - body.size());
  std::string bytes = stl_of(model);
  std::copy(mark.begin(), mark.end(), bytes.begin());
  struct Case {
    const char* name;
    std::string content;
    std::size_t triangles;
  };
  for (const Case& c : {Case{"a.obj", mark + obj_text(model), 2},
                        {"a.ply", mark + header + body, 2},
                        {"b.ply", header + mark + body, 2},
                        {"c.ply", mark + ply_bytes(model, {.format = PlyFormat::big_endian}), 2},
                        {"a.stl", mark + stl, 1},
                        {"b.stl", bytes, 2}}) {
    files.write(c.name, c.content);
    EXPECT_EQ(load_mesh(files.dir.file(c.name)).mesh.triangle_count(), c.triangles) << c.name;
  }

  files.write("balls.txt", mark + "0 0 0 1\n3 0 0 1\n");
  files.write("f.grid", mark + "oktett density grid 1\nsize 2 2 2\nvalues text\n0 1 2 3 4 5 6 7\n");
  files.write("a.ies", mark + "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 60\n0 90\n0\n5 5\n");
  files.write("scene.yaml", mark +
                                "oktett: 1\n"
                                "media: {m: {scattering: [1, 1, 1], grid: f.grid}}\n"
                                "materials: {s: {surface: false, interior: m}}\n"
                                "lights: [{point: {position: [0, 9, 0], profile: a.ies}}]\n"
                                "objects:\n"
                                "  - spheres: {file: balls.txt}\n"
                                "  - metaballs: {file: balls.txt}\n"
                                "  - {sphere: {center: [9, 0, 0]}, material: s}\n");
  EXPECT_EQ(load_scene(files.dir.file("scene.yaml")).objects.size(), 3u);
}

}  // namespace
}  // namespace oktett::test::mesh_formats_test
