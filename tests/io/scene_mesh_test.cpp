// Scenes with meshes of all formats.

#include "tests/io/ply_test_support.h"
#include "tests/io/scene_test_support.h"

namespace oktett::test::scene_mesh_test {
namespace {

/// A tetrahedron.
MeshModel tetrahedron() {
  return {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          .normals = {},
          .uvs = {},
          .faces = {{{0, 2, 1}, {}}, {{0, 1, 3}, {}}, {{0, 3, 2}, {}}, {{1, 2, 3}, {}}}};
}

std::string stl_text(const MeshModel& model) {
  std::string text = "solid\n";
  for (const MeshModel::Face& face : model.faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t corner : face.corners) {
      const Vec3f& p = model.positions[corner];
      text += "vertex ";
      text.append(exact_text(p.x))
          .append(" ")
          .append(exact_text(p.y))
          .append(" ")
          .append(exact_text(p.z))
          .append("\n");
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

TEST(SceneMesh, PlyIsReadAsObj) {
  SceneFiles files;
  files.dir.write("a.obj", obj_text(tetrahedron()));
  files.dir.write("b.PLY", ply_bytes(tetrahedron(), {.format = PlyFormat::big_endian}));
  const Scene scene = files.load_v1("objects: [{mesh: {file: a.obj}}, {mesh: {file: b.PLY}}]");
  expect_same_mesh(*shape_of<MeshShape>(scene, 0).mesh, *shape_of<MeshShape>(scene, 1).mesh);
  EXPECT_TRUE(scene.warnings.empty());
}

// Two objects of one file share it if both weld it or both do not.
TEST(SceneMesh, StlIsWeldedOnRequest) {
  SceneFiles files;
  files.dir.write("a.stl", stl_text(tetrahedron()));
  const Scene scene = files.load_v1(
      "objects: [{mesh: {file: a.stl}}, {mesh: {file: a.stl, weld: true}}, {mesh: {file: a.stl, weld: "
      "false}}]");
  EXPECT_EQ(shape_of<MeshShape>(scene, 0).mesh->positions.size(), 12u);
  EXPECT_EQ(shape_of<MeshShape>(scene, 1).mesh->positions.size(), 4u);
  EXPECT_EQ(shape_of<MeshShape>(scene, 0).mesh, shape_of<MeshShape>(scene, 2).mesh);
  EXPECT_EQ(shape_of<MeshShape>(load_scene(files.dir.file("a.stl"))).mesh->positions.size(), 4u);
}

TEST(SceneMesh, ErrorsNameTheMeshFile) {
  SceneFiles files;
  files.dir.write("a.ply", "ply\nformat ascii 2.0\n");
  EXPECT_EQ(files.error_v1("objects: [{mesh: {file: a.ply}}]"),
            "a.ply:2:14: expected version 1.0, found '2.0'");
}

}  // namespace
}  // namespace oktett::test::scene_mesh_test
