// Materials, their images and pictures of meshes stay the same in files of other formats.

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "io/scene/scene_file.h"
#include "render/picture/render.h"
#include "tests/io/convert_test_support.h"
#include "tests/io/gltf_test_support.h"

namespace oktett::test::convert_materials_test {
namespace {

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
  const MeshFile obj = load("a.obj");
  EXPECT_EQ(obj.textures[0].path, files.dir.file("a-1.png"));
  // Numbers keep their channels.
  const PrincipledMaterial& first = *obj.materials[0].principled;
  EXPECT_EQ(obj.textures.at(first.metallic_texture).channel, ImageChannel::blue);
  EXPECT_EQ(obj.textures.at(first.roughness_texture).channel, ImageChannel::green);
  EXPECT_EQ(obj.textures.at(obj.materials[0].opacity_texture).channel, ImageChannel::alpha);
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
    scene.camera.up = {0, 1, 0};  // STL stands upright by itself
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

}  // namespace
}  // namespace oktett::test::convert_materials_test
