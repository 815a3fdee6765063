// Mesh files written in other formats say the same again, and what they do not say is listed.

#include "io/mesh/save/convert_mesh.h"

#include <bit>
#include <filesystem>
#include <optional>

#include "io/scene/scene_file.h"
#include "render/render.h"
#include "tests/io/gltf_test_support.h"
#include "tests/io/mesh_test_support.h"

namespace oktett::test {
namespace {

namespace fs = std::filesystem;
using Losses = std::vector<std::string>;

class Convert : public testing::Test {
 protected:
  Losses convert(const std::string& from, const std::string& to, const ConvertOptions& options = {}) const {
    return convert_mesh(files.dir.file(from), files.dir.file(to), options).losses;
  }
  MeshFile load(const std::string& name) const { return load_mesh(files.dir.file(name)); }
  std::string error(const std::string& from, const std::string& to,
                    const ConvertOptions& options = {}) const {
    try {
      check_mesh_output(files.dir.file(to), options);
      convert(from, to, options);
    } catch (const Error& e) {
      return files.without_directory(e.what());
    }
    return "no error";
  }

  ObjFiles files;
};

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
    const TriangleMesh glb = load("a.glb").mesh;
    EXPECT_EQ(corners_of(glb), corners_of(mesh, false, !mesh.uv_indices.empty()));
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
  const Losses read{"lost: 2 names of objects and groups", "lost: colours of vertices",
                    "lost: digits of coordinates beyond single precision",
                    "changed: polygons are cut into triangles (2 faces, 3 triangles)"};
  const auto with = [&read](const Losses& more) {
    Losses all = read;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  EXPECT_EQ(convert("in.obj", "b.obj"), read);
  EXPECT_EQ(convert("in.obj", "b.ply"), with({"lost: 2 materials", "lost: 1 texture"}));
  EXPECT_EQ(
      convert("in.obj", "b.stl"),
      with({"lost: 2 materials", "lost: 1 texture", "lost: texture coordinates", "lost: normals of vertices",
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
                                "changed: polygons are cut into triangles (1 faces, 2 triangles)"}));
  EXPECT_EQ(files.as_text(ply.warnings), (Losses{"in.ply:7:1: warning: colours of vertices are not read"}));
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
TEST_F(Convert, MaterialsOfMtlStayTheSame) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto number = [&] { return " " + exact_text(unit(random)); };
  const auto color = [&] { return number() + number() + number(); };
  for (int i = 0; i < 80; ++i) {
    std::string text = "newmtl a b\n";
    const auto maybe = [&](const std::string& line) {
      if (random() % 2 == 0) text += line + "\n";
    };
    maybe("Kd" + color());
    maybe("Ka" + color());
    maybe("Ks" + color());
    maybe("Ke" + color());
    maybe("Ns" + number());
    maybe("Ni " + exact_text(1 + unit(random)));
    maybe(random() % 2 == 0 ? "d" + number() : "Tr" + number());
    maybe("illum " + std::to_string(random() % 9));
    maybe("map_Kd -s 2 3 1 -o 0.5 0 0 -clamp on a picture.png");
    maybe("map_Bump -bm 0.3 bump.png");
    maybe("map_d -mm 0.1 0.9 hole.png");
    if (random() % 3 == 0) text += "Pr" + number() + "\nPm" + number() + "\nmap_Pr rough.png\n";
    files.write("in.mtl", text);
    files.write("in.obj", "mtllib in.mtl\n" + kSquare + "f 1 2 3\nusemtl a b\nf 1 3 4\n");
    const MeshFile before = load("in.obj");
    const Losses losses = convert("in.obj", "a.obj");
    EXPECT_EQ(losses, Losses{}) << text << file_content(files.dir.file("a.mtl"));
    const MeshFile after = load("a.obj");
    EXPECT_EQ(after.materials, before.materials) << text << file_content(files.dir.file("a.mtl"));
    EXPECT_EQ(after.textures, before.textures) << text;
    if (!losses.empty()) return;
  }
}

/// The materials of a GLB file come through a GLB file with all bits, and with their images.
TEST_F(Convert, MaterialsOfGltfStayTheSame) {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.array(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
  const std::string image = "data:image/png;base64," + base64("\x89PNG\r\n\x1a\nno more");
  const auto primitive = [](int material) {
    return "{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":" + std::to_string(material) + "}";
  };
  files.write(
      "in.glb",
      out.glb(
          one_node(primitive(0) + "," + primitive(1) + "," + primitive(2)) + ",\"images\":[{\"uri\":\"" +
          image +
          "\"}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33071}],"
          "\"textures\":[{\"source\":0},{\"source\":0,\"sampler\":0}],"
          "\"extensionsUsed\":[\"KHR_materials_transmission\",\"KHR_materials_ior\"],"
          "\"materials\":[{\"name\":\"a\",\"doubleSided\":true,\"emissiveFactor\":[0.5,1,0.25],"
          "\"emissiveTexture\":{\"index\":0},\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,"
          "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.1,0.2,0.3,1],\"baseColorTexture\":{\"index\":0},"
          "\"metallicFactor\":0.7,\"roughnessFactor\":0.3,\"metallicRoughnessTexture\":{\"index\":1}}},"
          "{\"name\":\"glass\",\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.9},"
          "\"KHR_materials_ior\":{\"ior\":1.3}}},"
          "{\"name\":\"mist\",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":"
          "[1,1,1,0.3],\"baseColorTexture\":{\"index\":0}}}]"));
  const MeshFile before = load("in.glb");
  EXPECT_EQ(convert("in.glb", "a.glb"), Losses{});
  const MeshFile after = load("a.glb");
  ASSERT_EQ(after.materials.size(), 3u);
  const auto show = [](const MeshFile& file, std::uint32_t texture) {
    if (texture == kNoId) return Texture{};
    Texture t = file.textures[texture];
    EXPECT_NE(t.content, nullptr);
    if (t.content) t.path = *t.content;
    t.content = nullptr;
    return t;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Material &a = before.materials[i], &b = after.materials[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.principled->parameters, b.principled->parameters) << i;
    EXPECT_EQ(a.opacity, b.opacity) << i;
    EXPECT_EQ(a.emits_behind, b.emits_behind) << i;
    EXPECT_EQ(show(before, a.color_texture), show(after, b.color_texture)) << i;
    EXPECT_EQ(show(before, a.opacity_texture), show(after, b.opacity_texture)) << i;
    EXPECT_EQ(show(before, a.emission_texture), show(after, b.emission_texture)) << i;
    EXPECT_EQ(show(before, a.principled->metallic_texture), show(after, b.principled->metallic_texture)) << i;
    EXPECT_EQ(show(before, a.principled->roughness_texture), show(after, b.principled->roughness_texture));
  }
  // An image without a file of its own gets one beside an OBJ file.
  const Losses losses = convert("in.glb", "a.obj");
  EXPECT_EQ(std::ranges::count(losses, "changed: an image of a texture is written to 'a-1.png'"), 1);
  EXPECT_EQ(file_content(files.dir.file("a-1.png")), "\x89PNG\r\n\x1a\nno more");
  EXPECT_EQ(load("a.obj").textures[0].path, files.dir.file("a-1.png"));
  // A file that is there is not written over.
  files.write("a-1.png", "other");
  convert("in.glb", "a.obj");
  convert("in.glb", "a.obj");
  EXPECT_EQ(file_content(files.dir.file("a-1.png")), "other");
  EXPECT_EQ(load("a.obj").textures[0].path, files.dir.file("a-2.png"));
}

TEST_F(Convert, OddNamesOfMaterialsAreKeptApart) {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const auto primitive = [](int material) {
    return "{\"attributes\":{\"POSITION\":0},\"material\":" + std::to_string(material) + "}";
  };
  std::string primitives = primitive(0), materials;
  for (int i = 1; i < 4; ++i) primitives += "," + primitive(i);
  for (const char* name : {"a", "a", "\\n b\\\\", ""})
    materials += std::string(materials.empty() ? "" : ",") + "{\"name\":\"" + name + "\"}";
  files.write("in.glb", out.glb(one_node(primitives) + ",\"materials\":[" + materials + "]"));
  const Losses losses = convert("in.glb", "a.obj");
  EXPECT_EQ(std::ranges::count(losses, "changed: the names of 3 materials"), 1)
      << testing::PrintToString(losses);
  const MeshFile read = load("a.obj");
  std::vector<std::string> names;
  for (const Material& m : read.materials) names.push_back(m.name);
  EXPECT_EQ(names, (Losses{"a", "a_2", "_ b_", "material"}));
  EXPECT_EQ(to_vector(read.mesh.material_slots), (std::vector<std::uint16_t>{0, 1, 2, 3}));
}

/// All bits of all layers, of a mesh given alone with its materials.
TEST_F(Convert, PicturesAreTheSame) {
  files.write("in.mtl", "newmtl red\nKd 0.8 0.2 0.1\nPr 0.3\nnewmtl blue\nKd 0.1 0.2 0.8\nKs 1 1 1\nNs 40\n");
  std::string points, faces, bare;
  std::mt19937 random(8);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 90; ++i)
    points += "v " + exact_text(normal(random)) + " " + exact_text(normal(random)) + " " +
              exact_text(normal(random)) + "\n";
  for (int i = 1; i <= 90; i += 3) {
    const std::string face =
        "f " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
    bare += face, faces += (i % 2 == 0 ? "usemtl red\n" : "usemtl blue\n") + face;
  }
  files.write("in.obj", "mtllib in.mtl\n" + points + faces);
  files.write("bare.obj", points + bare);
  const auto picture = [this](const char* name) {
    Scene scene = load_scene(files.dir.file(name));
    scene.film.width = 40, scene.film.height = 32;
    return render(std::move(scene), {}).picture;
  };
  const auto expect_same = [&](const char* a, const char* b) {
    const Picture one = picture(a), other = picture(b);
    ASSERT_EQ(one.planes.size(), other.planes.size());
    for (std::size_t k = 0; k < one.planes.size(); ++k) {
      EXPECT_TRUE(same_bytes(one.planes[k].values, other.planes[k].values)) << b << " " << one.planes[k].name;
      EXPECT_TRUE(same_bytes(one.planes[k].ids, other.planes[k].ids)) << b << " " << one.planes[k].name;
    }
  };
  EXPECT_EQ(convert("in.obj", "a.obj"), Losses{});
  expect_same("in.obj", "a.obj");
  for (const char* name : {"b.ply", "b.glb"}) {
    EXPECT_EQ(convert("bare.obj", name), Losses{});
    expect_same("bare.obj", name);
  }
  convert("bare.obj", "b.stl");
  expect_same("bare.obj", "b.stl");
}

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
  EXPECT_EQ(error("empty.obj", "old.ply"), "empty.obj: no triangles to convert");
  EXPECT_EQ(error("gone.obj", "old.ply"), "gone.obj: cannot read: No such file or directory");
  EXPECT_EQ(file_content(files.dir.file("in.obj")), mesh);
  EXPECT_EQ(file_content(files.dir.file("old.ply")), "old");
  EXPECT_EQ(file_count(files.dir), 3u);
}

}  // namespace
}  // namespace oktett::test
