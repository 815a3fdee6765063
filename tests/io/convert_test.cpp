// Mesh files written in other formats say the same again, and what they do not say is listed.

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "tests/io/convert_test_support.h"
#include "tests/io/gltf_test_support.h"

namespace oktett::test::convert_test {
namespace {

/// What a corner of a triangle looks like, in bits.
struct Corner {
  std::array<std::uint32_t, 3> position;
  std::optional<std::array<std::uint32_t, 3>> normal;
  std::array<std::uint32_t, 2> uv;
  bool operator==(const Corner&) const = default;
};

std::array<std::uint32_t, 3> bits(const Vec3f& v) {
  return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
          std::bit_cast<std::uint32_t>(v.z)};
}

/// All corners in order; without normals and uvs if `bare`. `turn_v`: as v is after it was counted from the
/// top in between.
std::vector<Corner> corners_of(const TriangleMesh& mesh, bool bare = false, bool turn_v = false) {
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    Corner& corner = corners.emplace_back();
    corner.position = bits(mesh.positions[mesh.indices[i]]);
    corner.uv = {};
    if (bare) continue;
    if (!mesh.normal_indices.empty() && mesh.normal_indices[i] != kNoId)
      corner.normal = bits(mesh.normals[mesh.normal_indices[i]]);
    Vec2f uv = corner_uvs(mesh, static_cast<std::uint32_t>(i / 3))[i % 3];
    if (turn_v) uv.y = 1 - (1 - uv.y);
    corner.uv = {std::bit_cast<std::uint32_t>(uv.x), std::bit_cast<std::uint32_t>(uv.y)};
  }
  return corners;
}

/// Corners keep all bits of their position, normal and texture coordinates in all formats that have them.
TEST_F(Convert, KeepsTheBitsOfRandomMeshes) {
  std::mt19937 random(5);
  int meshes = 0;
  for (int i = 0; i < 30; ++i) {
    const bool corner_uvs = i % 4 == 1;
    const MeshModel model = random_model(random, i % 2 == 0, i % 3 == 0 && !corner_uvs, corner_uvs);
    if (model.faces.empty()) continue;
    ++meshes;
    files.write("in.obj", obj_text(model));
    const TriangleMesh mesh = load("in.obj").mesh;
    convert("in.obj", "a.obj");
    expect_same_mesh(load("a.obj").mesh, mesh);
    for (const bool ascii : {false, true}) {
      convert("in.obj", "a.ply", {.ascii = ascii});
      const TriangleMesh ply = load("a.ply").mesh;
      EXPECT_EQ(corners_of(ply), corners_of(mesh));
      // What PLY says it says again.
      convert("a.ply", "b.ply", {.ascii = !ascii});
      expect_same_mesh(load("b.ply").mesh, ply);
      convert("in.obj", "a.stl", {.ascii = ascii});
      EXPECT_EQ(corners_of(load("a.stl").mesh, true), corners_of(mesh, true));
    }
    convert("in.obj", "a.glb");
    // In glTF normals are unit vectors.
    TriangleMesh unit = mesh;
    for (Vec3f& n : unit.normals)
      if (const double size = length(Vec3d(n)); std::abs(size - 1) > 1e-6) n = Vec3f(Vec3d(n) / size);
    const TriangleMesh glb = load("a.glb").mesh;
    EXPECT_EQ(corners_of(glb), corners_of(unit, false, !mesh.uv_indices.empty()));
  }
  EXPECT_GT(meshes, 20);
}

TEST_F(Convert, KeepsIndicesOfMeshesWithoutNormals) {
  files.write("in.obj", kSquare + "v 5 5 5\nf 1 2 3\nf 1 3 4\n");
  for (const char* to : {"a.obj", "a.ply", "a.glb"}) {
    EXPECT_EQ(convert("in.obj", to), Losses{}) << to;
    expect_same_mesh(load(to).mesh, load("in.obj").mesh);
  }
  convert("in.obj", "a.stl");
  EXPECT_EQ(convert("a.stl", "b.ply", {.weld = true}), Losses{});
  EXPECT_EQ(load("b.ply").mesh.positions.size(), 4u);
}

/// Triangles without normals are flat beside others that are not.
TEST_F(Convert, CornersWithoutNormalsAreFlat) {
  files.write("in.obj", kSquare + "vn 0 1 1\nf 1//1 2//1 3//1\nf 1 3 4\n");
  EXPECT_EQ(convert("in.obj", "a.ply"),
            (Losses{"changed: 6 vertices instead of 4, because one has one normal and one texture coordinate",
                    "changed: 1 triangle without normals get those of flat triangles"}));
  const TriangleMesh mesh = load("a.ply").mesh;
  EXPECT_EQ(mesh.normals[mesh.normal_indices[1]], (Vec3f{0, 1, 1}));
  EXPECT_EQ(mesh.normals[mesh.normal_indices[5]], (Vec3f{0, 0, 1}));
}

TEST_F(Convert, NamesWhatIsLost) {
  files.write("a.mtl", "newmtl red\nKd 1 0 0\nmap_Kd red.png\nnewmtl blue\nKd 0 0 1\n");
  files.write("in.obj",
              "mtllib a.mtl\no thing\ng part\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0.12345678912\nv 0 1 0\n"
              "vt 0 0\nvn 0 0 1\nusemtl red\nf 1/1/1 2/1/1 3/1/1 4/1/1\nusemtl blue\nf 1/1/1 3/1/1 2/1/1\n");
  const Losses read{"lost: 2 names of objects and groups",
                    "lost: digits of coordinates beyond single precision",
                    "changed: polygons are cut into triangles (2 faces, 3 triangles)"};
  const auto with = [&read](const Losses& more) {
    Losses all = read;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  EXPECT_EQ(convert("in.obj", "b.obj"), read);
  EXPECT_EQ(convert("in.obj", "b.ply"), with({"lost: 2 materials"}));
  EXPECT_EQ(convert("in.obj", "b.stl"),
            with({"lost: 2 materials", "lost: 1 texture", "lost: texture coordinates",
                  "lost: normals of vertices", "lost: the attribute 'color'",
                  "lost: which triangles share vertices; read it with --weld to join them again"}));
  // There is no such image.
  EXPECT_EQ(convert("in.obj", "b.glb"), with({"lost: 1 texture, which glTF cannot show as they are",
                                              "changed: 2 materials, which glTF says only nearly ('red' and "
                                              "others)"}));
}

TEST_F(Convert, NamesWhatIsLostOfPlyAndStl) {
  files.write(
      "in.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double "
      "z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n4 0 1 2 3\n");
  const Conversion ply = convert_mesh(files.dir.file("in.ply"), files.dir.file("a.obj"), {});
  EXPECT_EQ(ply.losses, (Losses{"lost: digits of coordinates beyond single precision",
                                "changed: polygons are cut into triangles (1 faces, 2 triangles)",
                                "lost: the attribute 'red'"}));
  EXPECT_TRUE(ply.warnings.empty());
  convert("in.ply", "a.stl");
  std::string bytes = file_content(files.dir.file("a.stl"));
  bytes[84 + 48] = 1;
  files.write("in.stl", bytes);
  EXPECT_EQ(convert("in.stl", "b.stl"), (Losses{"lost: attributes of facets, such as colours"}));
}

TEST_F(Convert, NamesWhatIsLostOfGltf) {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  files.write("in.glb",
              out.glb("\"extensionsUsed\":[\"KHR_lights_punctual\"],"
                      "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\"}]}},"
                      "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":1}}],"
                      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                      "\"nodes\":[{\"mesh\":0,\"name\":\"one\"},{\"mesh\":0,\"translation\":[3,0,0]},"
                      "{\"camera\":0},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],"
                      "\"scenes\":[{\"nodes\":[0,1,2,3]}]"));
  EXPECT_EQ(convert("in.glb", "a.ply"),
            (Losses{"changed: 1 instance of meshes that are shown before, written as further triangles",
                    "lost: names of 2 objects, which become one mesh", "lost: cameras", "lost: 1 light"}));
  EXPECT_EQ(load("a.ply").mesh.triangle_count(), 2u);
}

/// MTL files that say all that is read of them.
TEST_F(Convert, RefusesInOneLine) {
  const std::string mesh = kSquare + "f 1 2 3\n";
  files.write("in.obj", mesh);
  files.write("empty.obj", kSquare);
  files.write("old.ply", "old");
  EXPECT_EQ(error("in.obj", "a.fbx"),
            "a.fbx: unknown kind of mesh file to write; expected .obj, .ply, .stl or .glb");
  EXPECT_EQ(error("in.obj", "a.gltf"),
            "a.gltf: unknown kind of mesh file to write; expected .obj, .ply, .stl or .glb");
  EXPECT_EQ(error("in.obj", "a.glb", {.ascii = true}),
            "a.glb: --ascii is for .ply and .stl, which are bytes without it");
  EXPECT_EQ(error("in.obj", "none/a.ply"), "none/a.ply: cannot write: no directory 'none'");
  EXPECT_EQ(error("in.obj", "in.obj"), "in.obj: is the input, too");
  EXPECT_EQ(error("empty.obj", "old.ply"),
            "empty.obj: no triangles to convert; points and lines are not written");
  EXPECT_EQ(error("gone.obj", "old.ply"), "gone.obj: cannot read: No such file or directory");
  EXPECT_EQ(file_content(files.dir.file("in.obj")), mesh);
  EXPECT_EQ(file_content(files.dir.file("old.ply")), "old");
  EXPECT_EQ(file_count(files.dir), 3u);
}

}  // namespace
}  // namespace oktett::test::convert_test
