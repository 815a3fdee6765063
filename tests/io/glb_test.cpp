// What stands in the JSON and the bytes of GLB files that are written.

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/io/convert_test_support.h"
#include "tests/io/gltf_test_support.h"

namespace oktett::test::glb_test {
namespace {

using nlohmann::json;

/// The parts of a GLB file.
struct Glb {
  explicit Glb(const std::string& bytes) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, 4);
    file = json::parse(bytes.substr(20, size));
    binary = bytes.substr(28 + size);
  }

  /// The numbers of an attribute of the first primitive.
  std::vector<float> numbers(const char* attribute) const {
    const json& accessor =
        file["accessors"][file["meshes"][0]["primitives"][0]["attributes"][attribute].get<int>()];
    const json& view = file["bufferViews"][accessor["bufferView"].get<int>()];
    const std::string type = accessor["type"];
    std::vector<float> values(accessor["count"].get<std::size_t>() *
                              static_cast<std::size_t>(type.back() - '0'));
    std::memcpy(values.data(), binary.data() + view.value("byteOffset", 0), 4 * values.size());
    return values;
  }

  json file;
  std::string binary;
};

class GlbFiles : public Convert {
 protected:
  Glb written(const std::string& from) const {
    losses_ = convert(from, "a.glb");
    return Glb(file_content(files.dir.file("a.glb")));
  }
  mutable Losses losses_;
};

TEST_F(GlbFiles, NormalsAreUnitVectors) {
  // The second and third triangle of the fan have a normal that is none.
  for (const char* const bad : {"0 0 0", "nan 0 1", "1 inf 0", "-0 0 -0"}) {
    files.write("in.obj",
                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nv -1 0 0\nvn 0 3 4\nvn 0 0 1\nvn 1e-30 0 0\nvn " +
                    std::string(bad) + "\nf 1//1 2//2 3//3\nf 1//1 3//3 4//4\nf 1//1 4//4 5//2\n");
    const Glb glb = written("in.obj");
    const std::vector<float> n = glb.numbers("NORMAL"), p = glb.numbers("POSITION");
    ASSERT_EQ(n.size(), p.size());
    ASSERT_GT(n.size(), 15u);
    for (std::size_t i = 0; i < n.size(); i += 3)
      EXPECT_NEAR(std::hypot(n[i], n[i + 1], n[i + 2]), 1, 1e-6) << bad << " " << i;
    EXPECT_NEAR(n[1], 0.6f, 1e-6);
    EXPECT_NEAR(n[2], 0.8f, 1e-6);
    EXPECT_EQ(
        std::ranges::count(
            losses_, "changed: 2 corners whose normal is zero or not finite; their triangles get flat ones"),
        1)
        << testing::PrintToString(losses_);
    EXPECT_EQ(std::ranges::count(losses_, "changed: 2 normals, which glTF has at unit length"), 1)
        << testing::PrintToString(losses_);
    // The flat normal of the second triangle.
    const MeshFile read = load("a.glb");
    const Vec3f flat = read.mesh.normals[read.mesh.normal_indices[5]];
    EXPECT_LT(length(Vec3d(flat) - normalize(Vec3d{1, -1, 1})), 1e-6);
  }
}

// A triangle without an area has no normal; unit vectors all the same.
TEST_F(GlbFiles, TrianglesWithoutAnAreaHaveUnitNormals) {
  files.write("in.obj",
              "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\nf 1//1 2//1 4//1\nf 1//2 2//2 3//2\n");
  const std::vector<float> n = written("in.obj").numbers("NORMAL");
  for (std::size_t i = 0; i < n.size(); i += 3) EXPECT_EQ(std::hypot(n[i], n[i + 1], n[i + 2]), 1);
}

TEST_F(GlbFiles, DissolvedMaterialsAreBlended) {
  files.write("in.mtl", "newmtl m\nKd 1 0 0\nd 0.25\n");
  files.write("in.obj", "mtllib in.mtl\n" + kSquare + "usemtl m\nf 1 2 3\n");
  const json material = written("in.obj").file["materials"][0];
  EXPECT_EQ(material["alphaMode"], "BLEND");
  EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"][3], 0.25);
}

TEST_F(GlbFiles, PlacesOfTexturesAreTransforms) {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.vectors({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  out.array(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
  out.array(std::vector<float>{0, 0.5f, 0.5f, 0, 0, 1}, kFloat, "VEC2", 2);
  out.array(std::vector<float>{1, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1}, kFloat, "VEC4", 4);
  const std::string image = "data:image/png;base64," + base64("\x89PNG\r\n\x1a\nno more");
  files.write(
      "in.glb",
      out.glb("\"images\":[{\"uri\":\"" + image +
              "\"}],\"samplers\":[{\"magFilter\":9728,\"wrapS\":33648,\"wrapT\":33071}],\"textures\":[{"
              "\"source\":0,\"sampler\":0}],"
              "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{"
              "\"KHR_texture_transform\":{\"offset\":[0.25,0.5],\"scale\":[2,3],\"rotation\":1}}}},"
              "\"normalTexture\":{"
              "\"index\":0,\"texCoord\":1,\"scale\":0.5}}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
              "\"POSITION\":0,"
              "\"NORMAL\":1,\"TEXCOORD_0\":2,\"TEXCOORD_1\":3,\"TANGENT\":4},\"material\":0}]}],\"nodes\":[{"
              "\"mesh\":0}]"));
  const Glb glb = written("in.glb");
  const json& material = glb.file["materials"][0];
  const json& transform =
      material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"];
  EXPECT_NEAR(transform["offset"][0].get<double>(), 0.25, 1e-6);
  EXPECT_NEAR(transform["offset"][1].get<double>(), 0.5, 1e-6);
  EXPECT_EQ(transform["scale"], json::array({2, 3}));
  EXPECT_NEAR(transform["rotation"].get<double>(), 1, 1e-6);
  EXPECT_EQ(material["normalTexture"]["texCoord"], 1);
  EXPECT_EQ(material["normalTexture"]["scale"], 0.5);
  EXPECT_EQ(glb.file["samplers"][0]["wrapS"], 33648);
  EXPECT_EQ(glb.file["samplers"][0]["wrapT"], 33071);
  EXPECT_EQ(glb.file["samplers"][0]["magFilter"], 9728);
  EXPECT_EQ(glb.numbers("TEXCOORD_1"), (std::vector<float>{0, 0.5f, 0.5f, 0, 0, 1}));
  EXPECT_EQ(glb.numbers("TANGENT"), (std::vector<float>{1, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1}));
  // All of it comes back.
  const MeshFile before = load("in.glb"), after = load("a.glb");
  ASSERT_EQ(after.textures.size(), before.textures.size());
  for (std::size_t i = 0; i < before.textures.size(); ++i) {
    EXPECT_EQ(after.textures[i].lookup, before.textures[i].lookup);
    EXPECT_EQ(after.textures[i].uv_layer, before.textures[i].uv_layer);
    EXPECT_NEAR(after.textures[i].rotation, before.textures[i].rotation, 1e-6);
    EXPECT_LT(length(after.textures[i].offset - before.textures[i].offset), 1e-6);
  }
  EXPECT_EQ(to_vector(after.mesh.second_uvs), to_vector(before.mesh.second_uvs));
}

TEST_F(GlbFiles, GlassKeepsWhatItAbsorbs) {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  files.write(
      "in.glb",
      out.glb(
          "\"materials\":[{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},"
          "\"KHR_materials_volume\":{\"thicknessFactor\":1,\"attenuationDistance\":2,\"attenuationColor\":"
          "[0.5,1,0.25]}}}]," +
          one_node("{\"attributes\":{\"POSITION\":0},\"material\":0}")));
  const MeshFile before = load("in.glb");
  EXPECT_EQ(convert("in.glb", "a.glb"), Losses{});
  const MeshFile after = load("a.glb");
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(after.media.at(0).absorption[k], before.media.at(0).absorption[k], 1e-6);
}

/// Materials that show an image with these extensions, as a GLB file, and what is written of them.
class Extensions : public GlbFiles {
 protected:
  void read(const std::string& material, const std::string& attributes = "") const {
    GltfWriter out;
    out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    out.array(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
    const std::string image = "data:image/png;base64," + base64("\x89PNG\r\n\x1a\nno more");
    files.write("in.glb", out.glb("\"images\":[{\"uri\":\"" + image +
                                  "\"}],\"textures\":[{\"source\":0}],\"materials\":[" + material + "]," +
                                  one_node("{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1" + attributes +
                                           "},\"material\":0}")));
  }
  /// The extension as it is written, whose parameters come back with all bits and without losses.
  json written_again(const std::string& extension, const std::string& values) const {
    read("{\"extensions\":{\"" + extension + "\":" + values + "}}");
    const Glb glb = written("in.glb");
    EXPECT_EQ(losses_, Losses{});
    const MeshFile before = load("in.glb"), after = load("a.glb");
    EXPECT_EQ(after.materials.at(0).principled->parameters, before.materials.at(0).principled->parameters);
    EXPECT_NE(glb.file["extensionsUsed"].dump().find(extension), std::string::npos);
    return glb.file["materials"][0]["extensions"][extension];
  }
};

TEST_F(Extensions, ReflectionsKeepColourAndWeight) {
  const json all = written_again(
      "KHR_materials_specular",
      "{\"specularFactor\":0.75,\"specularTexture\":{\"index\":0},\"specularColorFactor\":[0.5,2,0.25],"
      "\"specularColorTexture\":{\"index\":0}}");
  EXPECT_EQ(all["specularFactor"], 0.75);
  EXPECT_EQ(all["specularColorFactor"], json::array({0.5, 2, 0.25}));
  EXPECT_TRUE(all["specularTexture"].contains("index"));
  EXPECT_TRUE(all["specularColorTexture"].contains("index"));
  const json grey = written_again("KHR_materials_specular", "{\"specularColorFactor\":[0.5,0.5,0.5]}");
  EXPECT_EQ(grey["specularColorFactor"], json::array({0.5, 0.5, 0.5}));
}

TEST_F(Extensions, AnisotropyKeepsItsImage) {
  const json plain = written_again("KHR_materials_anisotropy", "{\"anisotropyStrength\":0.5}");
  EXPECT_EQ(plain, (json{{"anisotropyStrength", 0.5}}));
  const json all = written_again(
      "KHR_materials_anisotropy",
      "{\"anisotropyStrength\":0.25,\"anisotropyRotation\":0.75,\"anisotropyTexture\":{\"index\":0}}");
  EXPECT_NEAR(all["anisotropyRotation"].get<double>(), 0.75, 1e-6);
  EXPECT_TRUE(all["anisotropyTexture"].contains("index"));
  EXPECT_NE(load("a.glb").materials.at(0).principled->anisotropy_texture, kNoId);
}

TEST_F(Extensions, ThinFilmsKeepTheirThickness) {
  const json plain = written_again("KHR_materials_iridescence",
                                   "{\"iridescenceFactor\":0.5,\"iridescenceThicknessMaximum\":256}");
  EXPECT_EQ(plain["iridescenceThicknessMaximum"], 256);
  const json all = written_again("KHR_materials_iridescence",
                                 "{\"iridescenceFactor\":0.5,\"iridescenceIor\":1.75,\"iridescenceTexture\":"
                                 "{\"index\":0},\"iridescenceThicknessTexture\":{\"index\":0},"
                                 "\"iridescenceThicknessMinimum\":128,\"iridescenceThicknessMaximum\":512}");
  EXPECT_EQ(all["iridescenceIor"], 1.75);
  EXPECT_TRUE(all["iridescenceTexture"].contains("index"));
  EXPECT_TRUE(all["iridescenceThicknessTexture"].contains("index"));
  EXPECT_EQ(all["iridescenceThicknessMinimum"], 128);
  EXPECT_EQ(all["iridescenceThicknessMaximum"], 512);
  const Texture a = load("in.glb").textures.at(1), b = load("a.glb").textures.at(1);
  EXPECT_EQ(a.gain, b.gain);
  EXPECT_EQ(a.base, b.base);
}

TEST_F(Extensions, GlassKeepsItsDispersion) {
  read(
      "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":"
      "{\"thicknessFactor\":1},\"KHR_materials_dispersion\":{\"dispersion\":0.5}}}");
  const Glb glb = written("in.glb");
  EXPECT_EQ(losses_, Losses{});
  EXPECT_EQ(glb.file["materials"][0]["extensions"]["KHR_materials_dispersion"]["dispersion"], 0.5);
  EXPECT_EQ(load("a.glb").materials.at(0).principled->parameters.dispersion, 0.5f);
}

TEST_F(Extensions, CoatsKeepTheirNormals) {
  const std::string coat = "\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1";
  const std::string own = ",\"clearcoatNormalTexture\":{\"index\":0,\"scale\":0.5}",
                    base = ",\"normalTexture\":{\"index\":0,\"scale\":0.5}";
  for (const std::string& normals : {std::string(), own})
    for (const std::string& below : {std::string(), base}) {
      read("{" + coat + normals + "}}" + below + "}");
      const Glb glb = written("in.glb");
      EXPECT_EQ(losses_, Losses{});
      const json& written = glb.file["materials"][0]["extensions"]["KHR_materials_clearcoat"];
      EXPECT_EQ(written.contains("clearcoatNormalTexture"), !normals.empty());
      if (!normals.empty()) {
        EXPECT_EQ(written["clearcoatNormalTexture"]["scale"], 0.5);
      }
      const MeshFile before = load("in.glb"), after = load("a.glb");
      const PrincipledMaterial &a = *before.materials.at(0).principled,
                               &b = *after.materials.at(0).principled;
      EXPECT_EQ(a.coat_normal_texture == kNoId, b.coat_normal_texture == kNoId);
      EXPECT_EQ(a.coat_normal_scale, b.coat_normal_scale);
      EXPECT_EQ(a.even_coat, b.even_coat);
    }
}

}  // namespace
}  // namespace oktett::test::glb_test
