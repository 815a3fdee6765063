#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "io/scene/scene_file.h"
#include "render/look/default_look.h"
#include "tests/io/gltf_test_support.h"

namespace oktett::test::gltf_scene_test {
namespace {

/// A triangle and what `rest` makes of it.
std::string with_triangle(const std::string& rest) {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.vectors({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  return out.glb(
      "\"meshes\":[{\"name\":\"thing\",\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}]," +
      rest);
}

TEST(GltfScene, NodesMoveMeshes) {
  const GltfFiles files;
  // Columns of a matrix; the parent doubles and moves, the child turns x to y (a quarter about z).
  const double s = std::sqrt(0.5);
  const std::string bytes = with_triangle(
      "\"nodes\":[{\"children\":[1],\"matrix\":[2,0,0,0, 0,2,0,0, 0,0,2,0, 10,20,30,1]},"
      "{\"mesh\":0,\"translation\":[1,2,3],\"scale\":[3,1,1],\"rotation\":[0,0," +
      std::to_string(s) + "," + std::to_string(s) + "]}],\"scenes\":[{\"nodes\":[0]}]");
  const TriangleMesh mesh = files.load(bytes).mesh;
  const Vec3d expected[] = {{12, 24, 36}, {12, 30, 36}, {10, 24, 36}};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(length(Vec3d(mesh.positions[i]) - expected[i]), 1e-4);
  for (const Vec3f& n : mesh.normals) EXPECT_LT(length(Vec3d(n) - Vec3d{0, 0, 1}), 1e-5);
}

// Of a part that is turned by (x, y) -> (-y, x) after scaling by 1, 2 and 4, the normal (a, b, c) becomes
// (-b / 2, a, c / 4), made to have length 1. Parts that are not moved keep theirs.
TEST(GltfScene, NormalsOfMovedPartsStayPerpendicular) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.vectors({{1, 0, 0}, {0.6f, 0.8f, 0}, {0, 0.6f, 0.8f}});
  const std::string s = std::to_string(std::sqrt(0.5));
  const TriangleMesh mesh =
      files
          .load(out.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}],"
                        "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[5,6,7],\"scale\":[1,2,4],"
                        "\"rotation\":[0,0," +
                        s + "," + s + "]}],\"scenes\":[{\"nodes\":[0,1]}]"))
          .mesh;
  ASSERT_EQ(mesh.normals.size(), 6u);
  const Vec3d expected[] = {{1, 0, 0},
                            {0.6, 0.8, 0},
                            {0, 0.6, 0.8},
                            {0, 1, 0},
                            Vec3d{-0.4, 0.6, 0} / std::sqrt(0.52),
                            Vec3d{-0.3, 0, 0.2} / std::sqrt(0.13)};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(length(Vec3d(mesh.normals[i]) - expected[i]), 1e-5) << i;
  EXPECT_EQ(to_vector(mesh.normal_indices), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  // Points are moved by the same map.
  EXPECT_LT(length(Vec3d(mesh.positions[5]) - Vec3d{3, 6, 7}), 1e-4);
}

// A mirror keeps the front the front: the corners run the other way around.
TEST(GltfScene, MirrorsTurnTriangles) {
  const GltfFiles files;
  const TriangleMesh mesh =
      files.load(with_triangle("\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,1]}],\"scenes\":[{\"nodes\":[0]}]"))
          .mesh;
  EXPECT_EQ(to_vector(mesh.indices), (std::vector<std::uint32_t>{0, 2, 1}));
  EXPECT_EQ(to_vector(mesh.normal_indices), (std::vector<std::uint32_t>{0, 2, 1}));
  EXPECT_EQ(mesh.positions[1], (Vec3f{-1, 0, 0}));
  EXPECT_EQ(mesh.normals[1], (Vec3f{0, 0, 1}));
}

TEST(GltfScene, NodesThatShareAMeshAreInstances) {
  const GltfFiles files;
  const std::string nodes =
      "\"nodes\":[{\"mesh\":0,\"name\":\"left\"},{\"mesh\":0,\"translation\":[5,0,0]},{\"camera\":0,"
      "\"translation\":[0,0,9]},"
      "{\"mesh\":1,\"name\":\"single\"}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0."
      "5,"
      "\"znear\":0.1,\"aspectRatio\":2}}],\"scenes\":[{\"nodes\":[0,1,2,3]}]";
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::string path = files.files.write(
      "a.glb", out.glb("\"meshes\":[{\"name\":\"thing\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},"
                       "{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," +
                       nodes));
  const Scene scene = load_scene(path);
  ASSERT_EQ(scene.prototypes.size(), 1u);
  EXPECT_EQ(scene.prototypes[0].name, "thing");
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[0].name, "single");
  EXPECT_TRUE(std::holds_alternative<MeshShape>(scene.objects[0].shape));
  EXPECT_EQ(scene.objects[1].name, "left");
  EXPECT_EQ(std::get<InstanceShape>(scene.objects[1].shape).prototype, 0u);
  EXPECT_EQ(scene.objects[2].name, "thing");
  EXPECT_EQ(scene.objects[2].transform.point({0, 0, 0}), (Vec3d{5, 0, 0}));
  EXPECT_TRUE(scene.camera_given);
  EXPECT_FALSE(scene.lights_given);
  EXPECT_EQ(scene.camera.from, (Vec3d{0, 0, 9}));
  EXPECT_EQ(scene.camera.at, (Vec3d{0, 0, 8}));
  EXPECT_NEAR(scene.camera.fov, 0.5 * 180 / std::numbers::pi, 1e-12);
  EXPECT_EQ(scene.film.width, 2 * scene.film.height);
  EXPECT_EQ(scene.integrator.kind, IntegratorKind::path);

  // The same in a scene file, whose own camera changes what it says.
  const Scene included = load_scene(files.files.write(
      "scene.yaml", "oktett: 1\ninclude: [a.glb]\ncamera: {fov: 30}\nobjects: [{sphere: {radius: 1}}]\n"));
  EXPECT_EQ(included.objects.size(), 4u);
  EXPECT_EQ(included.camera.from, (Vec3d{0, 0, 9}));
  EXPECT_EQ(included.camera.fov, 30);
  EXPECT_FALSE(included.lights_given);
  // As one mesh, each with triangles of its own.
  const Scene merged =
      load_scene(files.files.write("merged.yaml", "oktett: 1\nobjects: [{mesh: {file: a.glb}}]\n"));
  EXPECT_EQ(std::get<MeshShape>(merged.objects.at(0).shape).mesh->triangle_count(), 3u);
  EXPECT_FALSE(merged.camera_given);
}

TEST(GltfScene, OrthographicCamera) {
  const GltfFiles files;
  const FileScene scene = files.scene(
      with_triangle("\"nodes\":[{\"camera\":0,\"rotation\":[0,1,0,0]}],\"cameras\":[{\"type\":"
                    "\"orthographic\",\"orthographic\":"
                    "{\"xmag\":3,\"ymag\":2,\"znear\":0,\"zfar\":9}}],\"scenes\":[{\"nodes\":[0]}]"));
  ASSERT_TRUE(scene.camera);
  EXPECT_EQ(scene.camera->projection, Projection::orthographic);
  EXPECT_EQ(scene.camera->height, 4);
  EXPECT_EQ(scene.aspect, 1.5);
  EXPECT_EQ(scene.camera->at, (Vec3d{0, 0, 1}));
}

// Candela and lux over pi are the colours of lights here, see render/scene.h.
TEST(GltfScene, Lights) {
  const GltfFiles files;
  const FileScene scene = files.scene(with_triangle(
      "\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
      "{\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},"
      "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}}],\"scenes\":[{\"nodes\":[0,1,2]}],"
      "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensionsRequired\":[\"KHR_lights_punctual\"],"
      "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
      "{\"type\":\"directional\",\"intensity\":6.283185307179586,\"color\":[1,0.5,0]},{\"type\":\"point\","
      "\"intensity\":3.141592653589793},"
      "{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":0.5,\"outerConeAngle\":1}}]}}"));
  ASSERT_EQ(scene.lights.size(), 3u);
  const auto& sun = std::get<DirectionalLight>(scene.lights[0]);
  EXPECT_EQ(sun.color, (Color{2, 1, 0}));
  EXPECT_EQ(sun.direction, (Vec3d{0, 0, -1}));
  const auto& point = std::get<PointLight>(scene.lights[1]);
  EXPECT_EQ(point.color, (Color{1, 1, 1}));
  EXPECT_EQ(point.position, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(point.falloff);
  const auto& spot = std::get<SpotLight>(scene.lights[2]);
  EXPECT_NEAR(spot.inner_angle, 90 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(spot.outer_angle, 180 / std::numbers::pi, 1e-12);
}

TEST(GltfScene, TheDefaultSceneIsShown) {
  const GltfFiles files;
  const std::string nodes = "\"nodes\":[{\"mesh\":0,\"name\":\"a\"},{\"mesh\":0,\"name\":\"b\"}]";
  const auto shown = [&](const std::string& rest) {
    return files.scene(with_triangle(nodes + rest)).placements.at(0).name;
  };
  EXPECT_EQ(shown(",\"scenes\":[{\"nodes\":[1]},{\"nodes\":[0]}]"), "b");
  EXPECT_EQ(shown(",\"scenes\":[{\"nodes\":[1]},{\"nodes\":[0]}],\"scene\":1"), "a");
  // Without scenes, all that no other node has.
  EXPECT_EQ(files.scene(with_triangle(nodes)).placements.size(), 2u);
}

TEST(GltfScene, Materials) {
  const GltfFiles files;
  const std::string image = std::string("\x89PNG\r\n\x1a\n", 8) + "rest";
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::size_t view = out.view(image);
  const MeshFile file = files.load(out.glb(
      "\"images\":[{\"bufferView\":" + std::to_string(view) +
      ",\"mimeType\":\"image/png\"},{\"uri\":\"a%20b.jpg\"},"
      "{\"uri\":\"data:image/png;base64," +
      base64(image + std::string(300, 'x')) +
      "\"}],"
      "\"samplers\":[{\"wrapS\":33071,\"wrapT\":33071}],"
      "\"textures\":[{\"source\":0},{\"source\":1,\"sampler\":0},{\"source\":2}],"
      "\"materials\":[{\"name\":\"m\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,1,0.5],"
      "\"metallicFactor\":0.25,"
      "\"roughnessFactor\":0.75,\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":"
      "{\"offset\":[0.25,0.5],\"scale\":[2,4]}}},\"metallicRoughnessTexture\":{\"index\":1}},"
      "\"normalTexture\":{\"index\":2},\"emissiveFactor\":[1,0.5,0],\"alphaMode\":\"BLEND\",\"doubleSided\":"
      "true,"
      "\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4},\"KHR_materials_ior\":{"
      "\"ior\":1.25},"
      "\"KHR_materials_transmission\":{\"transmissionFactor\":0.5},\"KHR_materials_clearcoat\":{"
      "\"clearcoatFactor\":0.75}}}]," +
      one_node("{\"attributes\":{\"POSITION\":0},\"material\":0}")));
  ASSERT_EQ(file.materials.size(), 1u);
  const Material& m = file.materials[0];
  const PrincipledMaterial& p = m.principled.value();
  EXPECT_EQ(m.name, "m");
  EXPECT_EQ(m.color, (Color{0.5f, 0.25f, 1}));
  EXPECT_EQ(m.emission, (Color{4, 2, 0}));
  EXPECT_TRUE(m.emits_behind);
  EXPECT_EQ(m.opacity, 0.5f);
  EXPECT_EQ(p.parameters.metallic, 0.25f);
  EXPECT_EQ(p.parameters.roughness, 0.75f);
  EXPECT_EQ(p.parameters.ior, 1.25f);
  EXPECT_EQ(p.parameters.transmission, 0.5f);
  EXPECT_TRUE(p.parameters.thin);
  EXPECT_EQ(p.parameters.coat, 0.75f);
  const Texture& color = file.textures.at(m.color_texture);
  ASSERT_TRUE(color.content);
  EXPECT_EQ(*color.content, image);
  // v points down in glTF: (u, v) there is looked up at (2 u + 0.25, 4 v + 0.5).
  EXPECT_EQ(color.offset, (Vec3f{0.25f, 1 - 4 - 0.5f, 0}));
  EXPECT_EQ(color.scale, (Vec3f{2, 4, 1}));
  EXPECT_EQ(file.textures.at(m.opacity_texture).channel, ImageChannel::alpha);
  const Texture& roughness = file.textures.at(p.roughness_texture);
  EXPECT_EQ(roughness.channel, ImageChannel::green);
  EXPECT_EQ(files.files.without_directory(roughness.path), "a b.jpg");
  EXPECT_FALSE(roughness.content);
  EXPECT_EQ(roughness.lookup, kClampedTexture);
  EXPECT_EQ(file.textures.at(p.metallic_texture).channel, ImageChannel::blue);
  EXPECT_EQ(file.textures.at(m.normal_texture).content->size(), image.size() + 300);
}

TEST(GltfScene, MasksAreSteepAndGlassIsThickWithAVolume) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const MeshFile file =
      files.load(out.glb("\"images\":[{\"uri\":\"a.png\"}],\"textures\":[{\"source\":0}],"
                         "\"materials\":[{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,"
                         "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},"
                         "\"extensions\":{\"KHR_materials_volume\":{\"thicknessFactor\":1}}}]," +
                         one_node("{\"attributes\":{\"POSITION\":0},\"material\":0}")));
  const Material& m = file.materials.at(0);
  const Texture& mask = file.textures.at(m.opacity_texture);
  EXPECT_EQ(m.opacity, 1);
  EXPECT_GT(mask.base + mask.gain * 0.2505f, 1);
  EXPECT_LT(mask.base + mask.gain * 0.2495f, 0);
  EXPECT_FALSE(m.principled->parameters.thin);
  EXPECT_FALSE(m.emits_behind);
}

/// The material `json`, with a texture of an image that is not there and a sampler.
MeshFile with_material(const GltfFiles& files, const std::string& json, const std::string& sampler = "{}") {
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.array(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
  out.array(std::vector<float>{0.25, 0.5, 0, 0, 1, 1}, kFloat, "VEC2", 2);
  return files.load(out.glb(
      "\"images\":[{\"uri\":\"a.png\"}],\"samplers\":[" + sampler +
      "],\"textures\":[{\"source\":0,\"sampler\":0}],\"materials\":[" + json + "]," +
      one_node("{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"TEXCOORD_1\":2},\"material\":0}")));
}

TEST(GltfScene, SamplersWrapEachAxis) {
  const GltfFiles files;
  const std::string material = "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}";
  const std::pair<const char*, TextureWrap> codes[] = {
      {"33071", TextureWrap::clamp}, {"33648", TextureWrap::mirror}, {"10497", TextureWrap::repeat}};
  for (const auto& [s, u] : codes)
    for (const auto& [t, v] : codes) {
      const std::string sampler = std::string("{\"wrapS\":") + s + ",\"wrapT\":" + t + "}";
      const MeshFile file = with_material(files, material, sampler);
      EXPECT_EQ(file.textures.at(0).lookup, (TextureLookup{u, v})) << sampler;
      EXPECT_EQ(file.warnings.size(), 0u);
    }
  EXPECT_EQ(with_material(files, material, "{\"magFilter\":9728}").textures.at(0).lookup.magnified,
            TextureFilter::nearest);
  EXPECT_EQ(with_material(files, material, "{\"magFilter\":9729}").textures.at(0).lookup, TextureLookup{});
}

/// Where KHR_texture_transform looks up (u, v): offset + R (scale * uv), where the angle counts
/// counter-clockwise as the image is seen, and v points down.
TEST(GltfScene, TexturesAreTurned) {
  const GltfFiles files;
  for (const double angle : {0.0, 1.0, -2.5}) {
    const MeshFile file =
        with_material(files,
                      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{"
                      "\"KHR_texture_transform\":{\"offset\":[0.25,-0.5],\"scale\":[2,3],\"rotation\":" +
                          std::to_string(angle) + "}}}}}");
    const Texture& t = file.textures.at(0);
    const double c = std::cos(angle), s = std::sin(angle);
    for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.3, 0.8}}) {
      const double x = 0.25 + c * 2 * u + s * 3 * v, y = -0.5 - s * 2 * u + c * 3 * v;
      // Here v points up, and textures are turned and moved after they were scaled.
      const double us = u * double{t.scale.x}, vs = (1 - v) * double{t.scale.y}, turn = double{t.rotation};
      EXPECT_NEAR(std::cos(turn) * us - std::sin(turn) * vs + double{t.offset.x}, x, 1e-5);
      EXPECT_NEAR(1 - (std::sin(turn) * us + std::cos(turn) * vs + double{t.offset.y}), y, 1e-5);
    }
  }
}

TEST(GltfScene, TexturesLieByTwoSetsOfCoordinates) {
  const GltfFiles files;
  const auto use = [](const char* set) { return "{\"index\":0,\"texCoord\":" + std::string(set) + "}"; };
  const MeshFile both =
      with_material(files, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":" + use("0") +
                               "},\"extensions\":{\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,1,1],"
                               "\"sheenColorTexture\":" +
                               use("1") + "}}}");
  const Material& m = both.materials.at(0);
  EXPECT_EQ(both.textures.at(m.color_texture).uv_layer, 0);
  EXPECT_EQ(both.textures.at(m.principled->sheen_color_texture).uv_layer, 1);
  EXPECT_EQ(to_vector(both.mesh.uvs), (std::vector<Vec2f>{{0, 1}, {1, 1}, {0, 0}}));
  EXPECT_EQ(to_vector(both.mesh.second_uvs), (std::vector<Vec2f>{{0.25f, 0.5f}, {0, 1}, {1, 0}}));
  // One set alone is the first one of the mesh, whichever texture shows it.
  for (const std::string extension :
       {"KHR_materials_sheen\":{\"sheenColorFactor\":[1,1,1],\"sheenColorTexture",
        "KHR_materials_specular\":{\"specularTexture", "KHR_materials_specular\":{\"specularColorTexture",
        "KHR_materials_clearcoat\":{\"clearcoatTexture",
        "KHR_materials_clearcoat\":{\"clearcoatFactor\":1,\"clearcoatRoughnessTexture",
        "KHR_materials_transmission\":{\"transmissionTexture"}) {
    const MeshFile one = with_material(files, "{\"extensions\":{\"" + extension + "\":" + use("1") + "}}}");
    EXPECT_EQ(one.textures.at(0).uv_layer, 0) << extension;
    EXPECT_EQ(one.mesh.uvs[0], (Vec2f{0.25f, 0.5f})) << extension;
    EXPECT_TRUE(one.mesh.second_uvs.empty());
  }
  // A set that is not there is told.
  EXPECT_EQ(
      files.files.as_text(
          with_material(files, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":" + use("4") + "}}")
              .warnings),
      (std::vector<std::string>{"a.glb: warning: meshes[0].primitives[0]: has no TEXCOORD_4, by which its "
                                "material shows textures"}));
}

TEST(GltfScene, NormalTexturesHaveScaleAndTangents) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.vectors({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  out.array(std::vector<float>{1, 0, 0, -1, 0, 1, 0, -1, 1, 0, 0, -1}, kFloat, "VEC4", 4);
  const auto read = [&](const std::string& node) {
    return files.load(out.glb(
        "\"images\":[{\"uri\":\"a.png\"}],\"textures\":[{\"source\":0}],\"materials\":[{\"normalTexture\":"
        "{\"index\":0,\"scale\":-0.5}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
        "\"NORMAL\":1,\"TANGENT\":2},\"material\":0}]}],\"nodes\":[{\"mesh\":0" +
        node + "}]"));
  };
  const MeshFile file = read("");
  EXPECT_EQ(file.materials.at(0).normal_scale, -0.5f);
  EXPECT_EQ(file.mesh.tangents[1], (std::array<float, 4>{0, 1, 0, -1}));
  // As one mesh they are moved, and a mirror changes the side.
  const MeshFile moved = read(",\"scale\":[-2,1,1]");
  EXPECT_EQ(moved.mesh.tangents[0], (std::array<float, 4>{-2, 0, 0, 1}));
}

TEST(GltfScene, CoatsHaveNormalsOfTheirOwn) {
  const GltfFiles files;
  const auto read = [&](const std::string& coat, const std::string& base = "") {
    return with_material(files, "{\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1" + coat +
                                    "}}" + base + "}");
  };
  const std::string own = ",\"clearcoatNormalTexture\":{\"index\":0,\"scale\":0.5}",
                    base = ",\"normalTexture\":{\"index\":0,\"scale\":0.5}";
  const MeshFile with = read(own);
  EXPECT_TRUE(with.warnings.empty());
  const PrincipledMaterial& m = *with.materials.at(0).principled;
  EXPECT_NE(m.coat_normal_texture, kNoId);
  EXPECT_EQ(m.coat_normal_scale, 0.5f);
  EXPECT_FALSE(m.even_coat);
  // The normals of the surface are not those of the coat, unless it names the same.
  const PrincipledMaterial without = *read("", base).materials.at(0).principled;
  EXPECT_EQ(without.coat_normal_texture, kNoId);
  EXPECT_TRUE(without.even_coat);
  const PrincipledMaterial both = *read(own, base).materials.at(0).principled;
  EXPECT_EQ(both.coat_normal_texture, kNoId);
  EXPECT_FALSE(both.even_coat);
}

TEST(GltfScene, AnisotropyHasDirectionAndStrengthInOneImage) {
  const GltfFiles files;
  const MeshFile file = with_material(
      files,
      "{\"extensions\":{\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.75,\"anisotropyRotation\":"
      "1.5707963267948966,\"anisotropyTexture\":{\"index\":0}}}}");
  EXPECT_TRUE(file.warnings.empty());
  const PrincipledMaterial& m = *file.materials.at(0).principled;
  EXPECT_EQ(m.parameters.anisotropy, 0.75f);
  EXPECT_NEAR(m.anisotropy_rotation, 90, 1e-5);
  EXPECT_EQ(file.textures.at(m.anisotropy_texture).channel, ImageChannel::blue);
  EXPECT_NE(m.anisotropy_direction_texture, kNoId);
}

TEST(GltfScene, ThinFilmsAreAsThickAsTheImageSays) {
  const GltfFiles files;
  const auto read = [&](const std::string& film) {
    return with_material(
        files, "{\"extensions\":{\"KHR_materials_iridescence\":{\"iridescenceFactor\":0.5" + film + "}}}");
  };
  const MeshFile plain = read("");
  EXPECT_TRUE(plain.warnings.empty());
  const PrincipledParameters& p = plain.materials.at(0).principled->parameters;
  EXPECT_EQ(p.iridescence, 0.5f);
  EXPECT_EQ(p.iridescence_ior, 1.3f);
  EXPECT_EQ(p.iridescence_thickness, 400);
  // From the least to the greatest thickness, which may be the lesser one.
  for (const auto& [least, most] : {std::pair{150.0, 600.0}, {600.0, 150.0}, {300.0, 0.0}}) {
    const MeshFile file = read(
        ",\"iridescenceIor\":1.5,\"iridescenceTexture\":{\"index\":0},\"iridescenceThicknessTexture\":"
        "{\"index\":0},\"iridescenceThicknessMinimum\":" +
        std::to_string(least) + ",\"iridescenceThicknessMaximum\":" + std::to_string(most));
    const PrincipledMaterial& m = *file.materials.at(0).principled;
    EXPECT_EQ(m.parameters.iridescence_ior, 1.5f);
    EXPECT_EQ(file.textures.at(m.iridescence_texture).channel, ImageChannel::red);
    const Texture& t = file.textures.at(m.iridescence_thickness_texture);
    EXPECT_EQ(t.channel, ImageChannel::green);
    for (const double texel : {0.0, 0.25, 1.0})
      EXPECT_NEAR(double{m.parameters.iridescence_thickness} * (double{t.gain} * texel + double{t.base}),
                  least + (most - least) * texel, 1e-3);
  }
}

TEST(GltfScene, GlassDispersesIfItIsFilled) {
  const GltfFiles files;
  const auto dispersion = [&](const std::string& more) {
    return with_material(files,
                         "{\"extensions\":{\"KHR_materials_dispersion\":{\"dispersion\":0.5}" + more + "}}")
        .materials.at(0)
        .principled->parameters.dispersion;
  };
  const std::string glass = ",\"KHR_materials_transmission\":{\"transmissionFactor\":1}";
  EXPECT_EQ(dispersion(glass + ",\"KHR_materials_volume\":{\"thicknessFactor\":1}"), 0.5f);
  EXPECT_EQ(dispersion(glass), 0);
  EXPECT_EQ(dispersion(""), 0);
}

TEST(GltfScene, KtxImagesAreReplacedOrNamed) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.array(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
  const auto read = [&](const std::string& texture) {
    return files.load(out.glb(
        "\"extensionsUsed\":[\"KHR_texture_basisu\"],\"extensionsRequired\":[\"KHR_texture_basisu\"],"
        "\"images\":[{\"uri\":\"a.png\"},{\"uri\":\"a.ktx2\",\"mimeType\":\"image/ktx2\"}],\"textures\":["
        "{\"source\":0}," +
        texture + "],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}}}]," +
        one_node("{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":0}")));
  };
  const std::string packed = "\"extensions\":{\"KHR_texture_basisu\":{\"source\":1}}";
  const MeshFile other = read("{\"source\":0," + packed + "}");
  EXPECT_EQ(other.textures.at(other.materials.at(0).color_texture).path, files.files.dir.file("a.png"));
  EXPECT_EQ(files.files.as_text(other.warnings),
            (std::vector<std::string>{
                "a.glb: warning: textures[1]: its KTX2 image is not read; the other one that it names is"}));
  const MeshFile white = read("{" + packed + "}");
  EXPECT_EQ(white.materials.at(0).color_texture, kNoId);
  EXPECT_EQ(
      files.files.as_text(white.warnings),
      (std::vector<std::string>{"a.glb: warning: textures[1]: its KTX2 image is not read; white instead"}));
}

TEST(GltfScene, MasksKeepWhatIsEqualToTheCutoff) {
  const GltfFiles files;
  for (const double alpha : {1.0, 0.25, 0.7})
    for (int texel = 1; texel < 256; ++texel) {
      const double cutoff = alpha * texel / 255;
      char text[400];
      std::snprintf(
          text, sizeof text,
          "{\"alphaMode\":\"MASK\",\"alphaCutoff\":%.17g,\"pbrMetallicRoughness\":{\"baseColorFactor\":"
          "[1,1,1,%.17g],\"baseColorTexture\":{\"index\":0}}}",
          cutoff, alpha);
      const MeshFile file = with_material(files, text);
      const Texture& mask = file.textures.at(file.materials.at(0).opacity_texture);
      const auto opacity = [&](int v) { return static_cast<float>(v) / 255.0f * mask.gain + mask.base; };
      EXPECT_GE(opacity(texel), 1) << alpha << " " << texel;
      EXPECT_LE(opacity(texel - 1), 0) << alpha << " " << texel;
      if (texel > 3) texel += 6;
    }
}

TEST(GltfScene, GlassAbsorbsWhatTheVolumeSays) {
  const GltfFiles files;
  const std::string volume =
      "\"KHR_materials_volume\":{\"thicknessFactor\":1,\"attenuationDistance\":2,"
      "\"attenuationColor\":[0.5,1,0.25]}";
  const MeshFile file = with_material(
      files, "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}," + volume + "}}");
  const Medium& medium = file.media.at(file.materials.at(0).interior);
  EXPECT_NEAR(medium.absorption.x, std::log(2.0) / 2, 1e-6);
  EXPECT_EQ(medium.absorption.y, 0);
  EXPECT_NEAR(medium.absorption.z, std::log(4.0) / 2, 1e-6);
  EXPECT_EQ(with_material(files, "{\"extensions\":{" + volume + "}}").materials.at(0).interior, kNoId);
}

TEST(GltfScene, GlassThatIsOpenAbsorbsNothingAndIsTold) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  out.array(std::vector<std::uint16_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}, kUint16, "SCALAR", 1);
  out.array(std::vector<std::uint16_t>{0, 2, 1, 0, 1, 3}, kUint16, "SCALAR", 1);
  const auto warnings = [&](int indices) {
    const std::string glass =
        "{\"name\":\"wine\",\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},"
        "\"KHR_materials_volume\":{\"thicknessFactor\":1,\"attenuationDistance\":2,"
        "\"attenuationColor\":[0.5,1,0.25]}}}";
    const std::string path = files.files.write(
        "a.glb", out.glb("\"materials\":[" + glass + ",{}]," +
                         one_node("{\"attributes\":{\"POSITION\":0},\"material\":0,\"indices\":" +
                                  std::to_string(indices) +
                                  "},{\"attributes\":{\"POSITION\":0},\"material\":1,\"indices\":2}")));
    return files.files.as_text(scene_from_mesh(path).warnings);
  };
  EXPECT_EQ(warnings(1), std::vector<std::string>{});
  EXPECT_EQ(warnings(2), (std::vector<std::string>{
                             "a.glb: warning: material 'wine' attenuates light, but object 'a' is not closed "
                             "where light enters it; nothing is attenuated"}));
}

TEST(GltfScene, SpecularAndGlossBecomeMetalOrPlastic) {
  const GltfFiles files;
  const auto read = [&](const std::string& gloss) {
    return with_material(files, "{\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{" + gloss + "}}}");
  };
  const MeshFile plastic = read(
      "\"diffuseFactor\":[0.5,0.25,0,0.5],\"specularFactor\":[0.04,0.04,0.04],\"glossinessFactor\":0.75");
  EXPECT_EQ(plastic.materials.at(0).color, (Color{0.5f, 0.25f, 0}));
  EXPECT_EQ(plastic.materials.at(0).principled->parameters.metallic, 0);
  EXPECT_EQ(plastic.materials.at(0).principled->parameters.roughness, 0.25f);
  EXPECT_NEAR(plastic.materials.at(0).principled->parameters.specular, 0.5, 1e-6);
  const MeshFile metal = read("\"diffuseFactor\":[0,0,0,1],\"specularFactor\":[1,0.5,0.25]");
  EXPECT_EQ(metal.materials.at(0).color, (Color{1, 0.5f, 0.25f}));
  EXPECT_EQ(metal.materials.at(0).principled->parameters.metallic, 1);
  EXPECT_EQ(metal.materials.at(0).principled->parameters.roughness, 0);
  const MeshFile textured = read("\"specularGlossinessTexture\":{\"index\":0},\"glossinessFactor\":0.5");
  const Texture& t = textured.textures.at(textured.materials.at(0).principled->roughness_texture);
  EXPECT_EQ(t.channel, ImageChannel::alpha);
  EXPECT_EQ(t.gain, -0.5f);
  EXPECT_EQ(t.base, 1);
  // Its colours are what is reflected head-on, where plastic reflects 0.04.
  const PrincipledMaterial& colored = *textured.materials.at(0).principled;
  EXPECT_EQ(textured.textures.at(colored.specular_color_texture).channel, ImageChannel::red);
  EXPECT_NEAR(colored.parameters.specular_color.x, 25, 1e-4);
  EXPECT_EQ(colored.parameters.specular, 0.5f);
  EXPECT_TRUE(textured.warnings.empty());
}

TEST(GltfScene, ReflectionsHaveColourAndWeight) {
  const GltfFiles files;
  const auto read = [&](const std::string& extensions) {
    return with_material(files, "{\"extensions\":{" + extensions + "}}");
  };
  const MeshFile file = read(
      "\"KHR_materials_specular\":{\"specularFactor\":0.75,\"specularTexture\":{\"index\":0},"
      "\"specularColorFactor\":[0.5,2,0],\"specularColorTexture\":{\"index\":0}}");
  EXPECT_TRUE(file.warnings.empty());
  const PrincipledMaterial& m = *file.materials.at(0).principled;
  EXPECT_EQ(m.parameters.specular, 0.5f);
  EXPECT_EQ(m.parameters.specular_weight, 0.75f);
  EXPECT_EQ(m.parameters.specular_color, (Color{0.5f, 2, 0}));
  EXPECT_EQ(file.textures.at(m.specular_weight_texture).channel, ImageChannel::alpha);
  EXPECT_EQ(file.textures.at(m.specular_color_texture).color_space, TextureColors::srgb);
  // A grey colour is `specular`.
  const auto parameters = [&](const std::string& extensions) {
    return read(extensions).materials.at(0).principled->parameters;
  };
  const PrincipledParameters grey =
      parameters("\"KHR_materials_specular\":{\"specularColorFactor\":[1.5,1.5,1.5]}");
  EXPECT_EQ(grey.specular, 0.75f);
  EXPECT_EQ(grey.specular_color, (Color{1, 1, 1}));
  // The index 0 reflects all, so the colour alone is what is reflected head-on; 1000 nearly does.
  for (const char* const ior : {"0", "1000"}) {
    const PrincipledParameters metal =
        parameters(std::string("\"KHR_materials_ior\":{\"ior\":") + ior +
                   "},\"KHR_materials_specular\":{\"specularColorFactor\":[0.9,0.5,0.25]}");
    const float most = (metal.ior - 1) * (metal.ior - 1) / ((metal.ior + 1) * (metal.ior + 1));
    EXPECT_NEAR(metal.specular_color.x * most, 0.9f, 4e-3) << ior;
    EXPECT_NEAR(metal.specular_color.z * most, 0.25f, 2e-3) << ior;
  }
  const std::string glass = "\"KHR_materials_transmission\":{\"transmissionFactor\":1}";
  EXPECT_TRUE(read(glass + ",\"KHR_materials_specular\":{\"specularFactor\":1}").warnings.empty());
  EXPECT_EQ(
      files.files.as_text(read(glass + ",\"KHR_materials_specular\":{\"specularFactor\":0.5}").warnings),
      (std::vector<std::string>{"a.glb: warning: material '': its glass reflects as its index of refraction "
                                "says; KHR_materials_specular does not change that"}));
}

TEST(GltfScene, VariantsChooseMaterials) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::string path = files.files.write(
      "a.glb",
      out.glb(
          "\"extensionsUsed\":[\"KHR_materials_variants\"],\"extensionsRequired\":[\"KHR_materials_"
          "variants\"],"
          "\"extensions\":{\"KHR_materials_variants\":{\"variants\":[{\"name\":\"day\"},{\"name\":\"night\"},"
          "{\"name\":\"dusk\"}]}},"
          "\"materials\":[{\"name\":\"a\"},{\"name\":\"b\"},{\"name\":\"c\"}]," +
          one_node(
              "{\"attributes\":{\"POSITION\":0},\"material\":0,\"extensions\":{\"KHR_materials_variants\":"
              "{\"mappings\":[{\"material\":1,\"variants\":[0,2]},{\"material\":2,\"variants\":[1]}]}}}")));
  const auto shown = [&](const std::string& variant) {
    GltfOptions options;
    options.variant = variant;
    const FileScene scene = load_gltf_scene(path, options);
    return scene.materials.at(scene.meshes.at(0).slots.at(0)).name;
  };
  EXPECT_EQ(shown(""), "a");
  EXPECT_EQ(shown("day"), "b");
  EXPECT_EQ(shown("night"), "c");
  EXPECT_EQ(shown("dusk"), "b");
  try {
    shown("noon");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(files.files.without_directory(e.what()),
              "a.glb: there is no variant 'noon'; expected one of 'day', 'night', 'dusk'");
  }
}

TEST(GltfScene, NodesShowTheirMeshManyTimes) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.vectors({{1, 0, 0}, {0, 2, 0}});
  out.array(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 0, 127}, kInt8, "VEC4", 4, ",\"normalized\":true");
  out.vectors({{1, 1, 1}, {3, 1, 1}});
  const FileScene scene = files.scene(out.glb(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,"
      "\"translation\":[10,0,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{"
      "\"TRANSLATION\":1,\"ROTATION\":2,\"SCALE\":3}}}}],\"extensionsUsed\":[\"EXT_mesh_gpu_instancing\"],"
      "\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"]"));
  ASSERT_EQ(scene.placements.size(), 2u);
  ASSERT_EQ(scene.meshes.size(), 1u);
  // Half a turn about z, then moved; and stretched.
  EXPECT_LT(length(scene.placements[0].to_world.point({1, 0, 0}) - Vec3d{10, 0, 0}), 1e-6);
  EXPECT_LT(length(scene.placements[0].to_world.point({0, 1, 0}) - Vec3d{11, -1, 0}), 1e-6);
  EXPECT_LT(length(scene.placements[1].to_world.point({1, 0, 0}) - Vec3d{13, 2, 0}), 1e-6);
}

// KHR_lights_punctual: the square of (cos a - cos outer) / (cos inner - cos outer).
TEST(GltfScene, SpotsFadeAsTheSquareOfTheCosine) {
  const GltfFiles files;
  const FileScene scene = files.scene(with_triangle(
      "\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\"extensions\":{\"KHR_lights_"
      "punctual\":"
      "{\"lights\":[{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":0.3,\"outerConeAngle\":0.9}}]}}"));
  const LightProfile& profile = *std::get<SpotLight>(scene.lights.at(0)).profile;
  for (int i = 0; i <= 100; ++i) {
    const double angle = 0.01 * i;
    const double part =
        std::clamp((std::cos(angle) - std::cos(0.9)) / (std::cos(0.3) - std::cos(0.9)), 0.0, 1.0);
    EXPECT_NEAR(profile_value(profile, angle * 180 / std::numbers::pi, 0), part * part, 2e-5) << angle;
  }
}

TEST(GltfScene, ValidPartsThatAreNotShownDoNotMatter) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  out.array(std::vector<std::uint8_t>{0, 1, 2, 3}, kUint8, "SCALAR", 1);
  out.buffers = "{\"byteLength\":" + std::to_string(out.binary.size()) +
                "},{\"byteLength\":9},{\"byteLength\":9,\"uri\":\"none.bin\"},"
                "{\"byteLength\":1,\"uri\":\"data:application/octet-stream,%00\"}";
  out.accessors += ",{\"componentType\":5126,\"count\":4,\"type\":\"VEC9\"}";
  const auto read = [&](const std::string& rest, const std::string& primitive) {
    return files.load(out.glb(one_node(primitive) + rest));
  };
  const std::string plain = "{\"attributes\":{\"POSITION\":0},\"indices\":1}";
  const MeshFile odd = read(
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":4,\"znear\":1}},"
      "{\"type\":\"fisheye\"}]",
      plain + ",{\"attributes\":{\"NORMAL\":0}},{\"attributes\":{\"POSITION\":0},\"mode\":9}");
  EXPECT_EQ(odd.mesh.triangle_count(), 1u);
  EXPECT_EQ(
      files.files.as_text(odd.warnings),
      (std::vector<std::string>{
          "a.glb: warning: meshes[0].primitives[0]: expected three corners for each triangle, found 4 in "
          "all; the last ones are left out",
          "a.glb: warning: meshes[0]: primitives without an attribute POSITION are skipped",
          "a.glb: warning: meshes[0].primitives[2]: unknown mode 9; it is left out"}));
  // Elements without bytes are zeros: here the indices.
  out.accessors += ",{\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}";
  const MeshFile zeros = read("", "{\"attributes\":{\"POSITION\":0},\"indices\":3}");
  EXPECT_EQ(to_vector(zeros.mesh.indices), (std::vector<std::uint32_t>{0, 0, 0}));
  // A camera that cannot be shown is left out.
  const FileScene scene =
      files.scene(out.glb("\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":4,\"znear\":1}}],"
                          "\"nodes\":[{\"camera\":0}]"));
  EXPECT_FALSE(scene.camera);
  EXPECT_EQ(files.files.as_text(scene.warnings),
            (std::vector<std::string>{
                "a.glb: warning: cameras[0]: its field of view is out of range; it is left out"}));
}

// glTF 2.0, 3.7.2.1.
TEST(GltfScene, MeshesWithoutNormalsAreFlat) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, -0.3f}});
  out.array(std::vector<std::uint8_t>{0, 1, 2, 2, 1, 3}, kUint8, "SCALAR", 1);
  Scene scene = load_scene(
      files.files.write("a.glb", out.glb(one_node("{\"attributes\":{\"POSITION\":0},\"indices\":1}"))));
  apply_look(scene, Look::studio);
  const auto& shape = std::get<MeshShape>(scene.objects.at(0).shape);
  EXPECT_TRUE(shape.mesh->normals.empty());
}

TEST(GltfScene, WhatIsLostIsSaid) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(files.warnings(out.glb(
                "\"extensionsUsed\":[\"EXT_something\",\"KHR_materials_ior\"],\"skins\":[{\"joints\":[0]}],"
                "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                "\"samplers\":[{\"input\":0,\"output\":0}]}]," +
                one_node("{\"attributes\":{\"POSITION\":0,\"COLOR_0\":0},\"targets\":[{\"POSITION\":0}]}"))),
            (std::vector<std::string>{
                "a.glb: warning: animations are not shown without a time: things are shown at rest",
                "a.glb: warning: extension 'EXT_something' is not read"}));
}

}  // namespace
}  // namespace oktett::test::gltf_scene_test
