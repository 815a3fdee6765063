#include <cmath>
#include <numbers>

#include "io/scene/scene_file.h"
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
  const GltfScene scene = files.scene(
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
  const GltfScene scene = files.scene(with_triangle(
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
  EXPECT_TRUE(roughness.clamp);
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

TEST(GltfScene, WhatIsLostIsSaid) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(
      files.warnings(out.glb(
          "\"extensionsUsed\":[\"EXT_something\",\"KHR_materials_ior\"],\"skins\":[{\"joints\":[0]}],"
          "\"animations\":[{\"channels\":[],\"samplers\":[]}]," +
          one_node("{\"attributes\":{\"POSITION\":0,\"COLOR_0\":0},\"targets\":[{\"POSITION\":0}]}"))),
      (std::vector<std::string>{"a.glb: warning: animations are not read: things are shown at rest",
                                "a.glb: warning: skins are not read: meshes are shown at rest",
                                "a.glb: warning: extension 'EXT_something' is not read",
                                "a.glb: warning: colours of vertices are not read",
                                "a.glb: warning: morph targets are not read: meshes are shown at rest"}));
}

}  // namespace
}  // namespace oktett::test::gltf_scene_test
