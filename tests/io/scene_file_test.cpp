#include "io/scene/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_file_test {
namespace {

using test::SceneFiles;
using test::shape_of;

const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST(SceneFile, EmptySceneHasTheDefaults) {
  const Scene scene = SceneFiles().load("oktett: 1\n");
  EXPECT_EQ(scene.camera, Camera{});
  EXPECT_EQ(scene.film, Film{});
  EXPECT_EQ(scene.integrator, IntegratorSettings{});
  EXPECT_FALSE(scene.camera_given);
  EXPECT_FALSE(scene.lights_given);
  EXPECT_TRUE(scene.objects.empty());
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.source.ends_with("scene.yaml"));
}

TEST(SceneFile, EmptySectionsAreEmpty) {
  const Scene scene =
      SceneFiles().load_v1("objects:\nmaterials: {}\nlights: []\ndefine:\ninclude:\nparams:\n");
  EXPECT_TRUE(scene.objects.empty());
  EXPECT_TRUE(scene.lights_given);
}

TEST(SceneFile, ReadsSettings) {
  const Scene scene = SceneFiles().load_v1(
      "camera: {from: [0, 1, 5], at: [1, 0, 0], up: [0, 0, 1], fov: 35, projection: orthographic, height: "
      "3}\n"
      "film: {width: 320, height: 200, crop: [0.25, 0.75, 0, 0.5]}\n"
      "integrator: {kind: ao, samples: 16, depth: 0, seed: 4294967295, ao_radius: 1.5}\n"
      "background: [0.1, 0.2, 0.3]\n"
      "ambient_light: \"#ffffff\"\n");
  EXPECT_EQ(scene.camera, (Camera{Projection::orthographic, {0, 1, 5}, {1, 0, 0}, {0, 0, 1}, 35, 3}));
  EXPECT_TRUE(scene.camera_given);
  EXPECT_EQ(scene.film, (Film{320, 200, {0.25, 0.75, 0, 0.5}}));
  EXPECT_EQ(
      scene.integrator,
      (IntegratorSettings{
          .kind = IntegratorKind::ao, .samples = 16, .depth = 0, .seed = 4294967295u, .ao_radius = 1.5}));
  EXPECT_EQ(scene.background, (Color{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(scene.ambient_light, (Color{1, 1, 1}));
}

TEST(SceneFile, CameraHasAFrame) {
  const SceneFiles files;
  const Camera camera =
      files
          .load_v1(
              "camera: {from: [1, 2, 3], frame: {right: [4, 0, 0], up: [0, 2, 0], direction: [0, 0, 1]}}")
          .camera;
  ASSERT_TRUE(camera.frame);
  EXPECT_EQ(*camera.frame, (ViewFrame{{4, 0, 0}, {0, 2, 0}, {0, 0, 1}}));
  // What looks for the plain keys finds the same view.
  EXPECT_EQ(camera.at, (Vec3d{1, 2, 4}));
  EXPECT_EQ(camera.height, 2);
  EXPECT_NEAR(camera.fov, 90, 1e-9);
  test::expect_errors(
      {{"camera: {frame: {right: [4, 0, 0], up: [0, 2, 0]}}", "scene.yaml:2:17: a frame needs 'direction'"},
       {"camera: {frame: {right: [4, 0, 0], up: [0, 2, 0], direction: [1, 1, 0]}}",
        "scene.yaml:2:62: the three vectors of the frame lie in one plane"},
       {"camera: {frame: {right: [0, 0, 0], up: [0, 2, 0], direction: [1, 1, 0]}}",
        "scene.yaml:2:62: the three vectors of the frame lie in one plane"},
       {"camera: {fov: 3, frame: {right: [4, 0, 0], up: [0, 2, 0], direction: [0, 0, 1]}}",
        "scene.yaml:2:15: expected 'frame' or 'fov', not both"}});
}

TEST(SceneFile, ReadsCurvedProjections) {
  const auto read = [](const std::string& text) {
    return SceneFiles().load_v1("camera: {" + text + "}").camera;
  };
  Camera camera = read("projection: spherical, angle: [200, 90]");
  EXPECT_EQ(camera.projection, Projection::spherical);
  EXPECT_EQ(camera.angle[0], 200);
  EXPECT_EQ(camera.angle[1], 90);
  camera = read("projection: fisheye, angle: 120");
  EXPECT_EQ(camera.projection, Projection::fisheye);
  EXPECT_EQ(camera.angle[0], 120);
  EXPECT_EQ(camera.angle[1], 0);
  camera = read("projection: cylindrical, axis: right, along_axis: orthographic, height: 3");
  EXPECT_EQ(camera.projection, Projection::cylindrical);
  EXPECT_EQ(camera.axis, CylinderAxis::right);
  EXPECT_EQ(camera.along_axis, Projection::orthographic);
  EXPECT_EQ(camera.height, 3);
  for (const auto& [name, projection] : kProjections) {
    if (projection == Projection::mesh) continue;  // it needs one
    EXPECT_EQ(read(std::string("projection: ") + name).projection, projection);
  }
  test::expect_errors({
      {"camera: {projection: fisheye, angle: 361}",
       "scene.yaml:2:38: expected a number greater than 0 and of at most 360, found '361'"},
      {"camera: {projection: fisheye, angle: [90, 90]}",
       "scene.yaml:2:38: a fisheye view has one angle; two are for a spherical view"},
      {"camera: {projection: omnimax, aperture: 1}",
       "scene.yaml:2:41: an omnimax view has no lens; 'aperture' is for perspective and orthographic views"},
      {"camera: {projection: cylindrical, along_axis: fisheye}",
       "scene.yaml:2:47: expected perspective or orthographic, found 'fisheye'"},
  });
  const auto warning = [](const std::string& text) {
    const Scene scene = SceneFiles().load_v1("camera: {" + text + "}");
    return scene.warnings.size() == 1 ? to_string(scene.warnings[0]) : "not one warning";
  };
  const auto ends = [&](const std::string& text, const std::string& end) {
    EXPECT_TRUE(warning(text).ends_with(end)) << warning(text);
  };
  ends("fov: 30, projection: fisheye", "a fisheye view has an 'angle'");
  ends("angle: 30", "a perspective view has a 'fov'");
  ends("angle: 30, projection: panoramic", "a panoramic view has always the same angle");
  ends("axis: right, projection: spherical", "a spherical view has no cylinder");
  ends("height: 2, projection: cylindrical", "a cylindrical view has an 'angle'");
}

TEST(SceneFile, ReadsCaustics) {
  const auto read = [](const std::string& text) {
    return SceneFiles().load_v1("integrator: {kind: path" + text + "}\n").integrator.caustics;
  };
  constexpr std::uint32_t kUsual = CausticSettings::kUsualPhotons;
  EXPECT_EQ(read(""), CausticSettings{});
  EXPECT_EQ(read(", caustics: false"), CausticSettings{});
  EXPECT_EQ(read(", caustics: true"), (CausticSettings{kUsual, 16, 0}));
  EXPECT_EQ(read(", caustics: {}"), (CausticSettings{kUsual, 16, 0}));
  EXPECT_EQ(read(", caustics: {photons: 5, passes: 3, radius: 0.5}"), (CausticSettings{5, 3, 0.5}));
  EXPECT_EQ(read(", caustics: {radius: auto}"), (CausticSettings{kUsual, 16, 0}));
}

TEST(SceneFile, ReadsLights) {
  const Scene scene = SceneFiles().load_v1(
      "lights:\n"
      "  - point: {position: [5, 8, 4], color: [1, 0.5, 0], falloff: true}\n"
      "  - directional: {direction: [1, -1, 0]}\n");
  ASSERT_EQ(scene.lights.size(), 2u);
  const auto& point = std::get<PointLight>(scene.lights[0]);
  EXPECT_EQ(point.position, (Vec3d{5, 8, 4}));
  EXPECT_EQ(point.color, (Color{1, 0.5f, 0}));
  EXPECT_TRUE(point.falloff);
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[1]).direction, (Vec3d{1, -1, 0}));
}

TEST(SceneFile, ReadsMaterials) {
  SceneFiles files;
  files.dir.write("wood.png", "x");
  const Scene scene = files.load_v1(
      "materials:\n"
      "  all: {color: [1, 2, 3], specular_color: [4, 5, 6], emission: [7, 8, 9], ambient: 0.25, diffuse: "
      "0.5,\n"
      "        specular: 2, phong: 60, reflection: 0.75, transparency: 1, ior: 1.25, roughness: 0.5, "
      "metallic: 1,\n"
      "        map_color: wood.png, map_specular: wood.png, map_bump: {file: wood.png, scale: [2, 3],\n"
      "        offset: [0.5, 0.25], clamp: true, filter: nearest,\n"
      "        gain: 2, base: -1}, bump_scale: 3,\n"
      "        map_emission: {file: wood.png, scale: 4}, map_opacity: wood.png, map_normal: wood.png}\n");
  ASSERT_EQ(scene.materials.size(), 1u);
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.name, "all");
  EXPECT_EQ(m.color, (Color{1, 2, 3}));
  EXPECT_EQ(m.specular_color, (Color{4, 5, 6}));
  EXPECT_EQ(m.emission, (Color{7, 8, 9}));
  EXPECT_EQ(m.ambient, 0.25f);
  EXPECT_EQ(m.diffuse, 0.5f);
  EXPECT_EQ(m.specular, 2);
  EXPECT_EQ(m.phong, 60);
  EXPECT_EQ(m.reflection, 0.75f);
  EXPECT_EQ(m.transparency, 1);
  EXPECT_EQ(m.ior, 1.25f);
  ASSERT_TRUE(m.principled);
  EXPECT_EQ(m.principled->parameters.roughness, 0.5f);
  EXPECT_EQ(m.principled->parameters.metallic, 1);
  EXPECT_EQ(m.bump_scale, 3);
  ASSERT_EQ(scene.textures.size(), 3u) << "equal textures are shared";
  EXPECT_EQ(scene.textures.at(m.color_texture).path, files.dir.file("wood.png"));
  EXPECT_EQ(m.specular_texture, m.color_texture);
  EXPECT_EQ(m.opacity_texture, m.color_texture);
  EXPECT_EQ(m.normal_texture, m.color_texture);
  EXPECT_EQ(scene.textures.at(m.emission_texture).scale, (Vec3f{4, 4, 4}));
  Texture bump;
  bump.path = files.dir.file("wood.png"),
  bump.lookup = {TextureWrap::clamp, TextureWrap::clamp, TextureFilter::nearest};
  bump.offset = {0.5f, 0.25f, 0}, bump.scale = {2, 3, 1}, bump.gain = 2, bump.base = -1;
  EXPECT_EQ(scene.textures.at(m.bump_texture), bump);
}

/// "#rrggbb" is sRGB; linear values come from the definition of its transfer function.
TEST(SceneFile, ConvertsSrgbColours) {
  const Scene scene = SceneFiles().load_v1("background: \"#80FF0a\"\n");
  EXPECT_NEAR(scene.background.x, 0.21586050, 1e-6);
  EXPECT_EQ(scene.background.y, 1);
  EXPECT_NEAR(scene.background.z, 10 / 255.0 / 12.92, 1e-6);
}

TEST(SceneFile, ObjectsTakeMaterialsByNameAndInline) {
  const Scene scene = SceneFiles().load_v1(
      "materials: {gold: {}}\n"
      "objects: [{sphere: {}, material: gold}, {sphere: {}, material: {ambient: 0.5}}, {sphere: {}}]\n");
  EXPECT_EQ(scene.objects.at(0).material, 0u);
  EXPECT_EQ(scene.materials.at(scene.objects.at(1).material).ambient, 0.5f);
  EXPECT_EQ(scene.objects.at(2).material, kNoId);
}

TEST(SceneFile, AppliesTransformsInOrder) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - sphere:\n"
      "    transform: [{scale: 2}, {rotate: [0, 0, 90]}, {translate: [0, 1, 0]}]\n"
      "  - sphere:\n"
      "    transform: {scale: [1, 2, 3]}\n"
      "  - sphere:\n"
      "    transform: [{rotate: {axis: [0, 0, 5], angle: 90}}]\n"
      "  - sphere:\n"
      "    transform: [{matrix: [1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 1, 12]}]\n"
      "  - sphere:\n"
      "    transform: [{matrix: [1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 1, 12, 0, 0, 0, 1]}]\n");
  ASSERT_EQ(scene.objects.size(), 5u);
  EXPECT_EQ(scene.objects[0].transform.point({1, 0, 0}), (Vec3d{0, 3, 0}));
  EXPECT_EQ(scene.objects[1].transform.point({1, 1, 1}), (Vec3d{1, 2, 3}));
  EXPECT_EQ(scene.objects[2].transform.point({1, 0, 0}), (Vec3d{0, 1, 0}));
  EXPECT_EQ(scene.objects[3].transform.m[1][3], 8);
  EXPECT_EQ(scene.objects[3].transform, scene.objects[4].transform);
}

TEST(SceneFile, GroupsHandDownTransformMaterialAndName) {
  const Scene scene = SceneFiles().load_v1(
      "materials: {a: {}, b: {}}\n"
      "objects:\n"
      "  - group:\n"
      "      - sphere:\n"
      "        name: inner\n"
      "      - box:\n"
      "        material: b\n"
      "      - group: [{disk: {}, transform: {translate: [0, 1, 0]}}]\n"
      "    material: a\n"
      "    name: outer\n"
      "    transform: [{scale: 2}]\n");
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[0].material, 0u);
  EXPECT_EQ(scene.objects[0].name, "inner");
  EXPECT_EQ(scene.objects[0].where.line, 5);
  EXPECT_EQ(scene.objects[0].where.column, 9);
  EXPECT_EQ(scene.objects[1].material, 1u);
  EXPECT_EQ(scene.objects[1].name, "outer");
  EXPECT_EQ(scene.objects[2].material, 0u);
  EXPECT_EQ(scene.objects[2].name, "outer");
  EXPECT_EQ(scene.objects[2].transform.point({0, 0, 0}), (Vec3d{0, 2, 0}));
}

TEST(SceneFile, InstancesReferToPrototypes) {
  const Scene scene = SceneFiles().load_v1(
      "materials: {m: {}}\n"
      "define:\n"
      "  leaf: {sphere: {}}\n"
      "  branch: {group: [{instance: leaf}, {instance: leaf, transform: {translate: [1, 0, 0]}}]}\n"
      "objects:\n"
      "  - {instance: branch, material: m}\n"
      "  - {group: [{instance: leaf}], material: m, name: tree}\n");
  ASSERT_EQ(scene.prototypes.size(), 2u);
  EXPECT_EQ(scene.prototypes[1].name, "branch");
  ASSERT_EQ(scene.prototypes[1].objects.size(), 2u);
  EXPECT_EQ(std::get<InstanceShape>(scene.prototypes[1].objects[1].shape).prototype, 0u);
  EXPECT_EQ(shape_of<InstanceShape>(scene).prototype, 1u);
  EXPECT_EQ(scene.objects[0].material, 0u);
  EXPECT_EQ(scene.objects[1].material, kNoId) << "a prototype keeps its materials inside a group";
  EXPECT_EQ(scene.objects[1].name, "tree");
}

TEST(SceneFile, NumbersMayBeExpressions) {
  const Scene scene =
      SceneFiles().load_v1("objects: [{sphere: {center: [\"2*pi/3\", +1, .5], radius: 1e-3}}]\n");
  EXPECT_EQ(shape_of<SphereShape>(scene).center, (Vec3d{2 * M_PI / 3, 1, 0.5}));
  EXPECT_EQ(shape_of<SphereShape>(scene).radius, 1e-3);
}

TEST(SceneFile, ParametersHaveDefaultsThatDefinitionsOverride) {
  const std::string text =
      "params: {r: 2, d: \"${r} + 1\", m: gold}\n"
      "materials: {gold: {}, iron: {}}\n"
      "objects: [{sphere: {radius: \"${r}*${d}\"}, material: \"${m}\", name: \"$${r}\"}]\n";
  SceneFiles files;
  const Scene defaults = files.load_v1(text);
  EXPECT_EQ(shape_of<SphereShape>(defaults).radius, 2 * 2 + 1) << "values are pasted as text";
  EXPECT_EQ(defaults.objects[0].material, 0u);
  EXPECT_EQ(defaults.objects[0].name, "${r}");
  const Scene given = files.load_v1(text, {{"r", "5"}, {"m", "iron"}});
  EXPECT_EQ(shape_of<SphereShape>(given).radius, 5 * 5 + 1);
  EXPECT_EQ(given.objects[0].material, 1u);
  EXPECT_TRUE(given.warnings.empty());
}

TEST(SceneFile, WarnsOfDefinitionsThatNothingUses) {
  const Scene scene = SceneFiles().load_v1("params: {radius: 2}\n", {{"radios", "3"}});
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(to_string(scene.warnings[0]),
            "warning: -D radios: the scene has no ${radios}; did you mean 'radius'?");
}

TEST(SceneFile, IncludesAreMergedAndOverriddenKeyByKey) {
  SceneFiles files;
  files.dir.write("lib/base.yaml",
                  "oktett: 1\ninclude: [more.yaml]\nparams: {r: 7}\nfilm: {width: 10, height: 20}\n"
                  "materials: {gold: {}}\ndefine: {ball: {sphere: {radius: \"${r}\"}}}\n"
                  "objects: [{mesh: {file: t.obj}}]\nlights: [{point: {position: [0, 0, 0]}}]\n");
  files.dir.write("lib/more.yaml", "oktett: 1\nbackground: [1, 1, 1]\nmaterials: {iron: {}}\n");
  files.dir.write("lib/t.obj", kTetrahedron);
  const Scene scene = files.load_v1(
      "include: [lib/base.yaml, lib/more.yaml]\nparams: {r: 3}\nfilm: {height: 40}\n"
      "objects: [{instance: ball, material: iron}]\nlights: [{directional: {}}]\n");
  EXPECT_EQ(scene.film.width, 10u);
  EXPECT_EQ(scene.film.height, 40u);
  EXPECT_EQ(scene.background, (Color{1, 1, 1}));
  EXPECT_EQ(scene.lights.size(), 2u);
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.materials.at(scene.objects[1].material).name, "iron");
  EXPECT_EQ(std::get<SphereShape>(scene.prototypes.at(0).objects.at(0).shape).radius, 3)
      << "the outermost wins";
  EXPECT_TRUE(scene.objects[0].where.file.ends_with("lib/base.yaml"));
}

TEST(SceneFile, AliasesStandForWhatTheyName) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n  - sphere: &s {radius: 3}\n  - sphere: *s\n  - box: {max: &v [2, 2, 2]}\n  - disk: "
      "{center: *v}\n");
  EXPECT_EQ(shape_of<SphereShape>(scene, 1).radius, 3);
  EXPECT_EQ(shape_of<DiskShape>(scene, 3).center, (Vec3d{2, 2, 2}));
}

TEST(SceneFile, MeshesAreReadOnce) {
  SceneFiles files;
  files.dir.write("t.obj", kTetrahedron);
  std::filesystem::create_directory(files.dir.path() / "sub");
  const Scene scene = files.load_v1(
      "materials: {m: {}}\n"
      "objects:\n"
      "  - mesh: {file: t.obj}\n"
      "  - mesh: {file: sub/../t.obj, smooth: false, test: badouel}\n"
      "    material: m\n");
  const auto& first = shape_of<MeshShape>(scene, 0);
  const auto& second = shape_of<MeshShape>(scene, 1);
  EXPECT_EQ(first.mesh, second.mesh);
  EXPECT_EQ(first.mesh->triangle_count(), 4u);
  EXPECT_TRUE(first.smooth);
  EXPECT_EQ(first.test, TriangleTest::watertight);
  EXPECT_FALSE(second.smooth);
  EXPECT_EQ(second.test, TriangleTest::badouel);
  EXPECT_EQ(scene.objects[0].material, kNoId);
  EXPECT_EQ(scene.objects[1].material, 0u);
}

TEST(SceneFile, MeshMaterialsAreAppended) {
  SceneFiles files;
  files.dir.write("t.mtl", "newmtl one\nKd 1 0 0\nnewmtl textured\nKd 0 1 0\nmap_Kd x.png\n");
  files.dir.write("x.png", "x");
  files.dir.write("y.png", "y");
  files.dir.write("t.obj",
                  "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl one\nf 1 2 3\nusemtl textured\nf 3 2 1\n");
  const Scene scene = files.load_v1(
      "materials: {m: {map_color: y.png}}\nobjects: [{mesh: {file: t.obj}}, {mesh: {file: t.obj}, material: "
      "m}]\n");
  ASSERT_EQ(scene.materials.size(), 3u);
  const auto& mesh = shape_of<MeshShape>(scene);
  ASSERT_EQ(mesh.slot_materials, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(scene.materials[1].name, "one");
  const std::uint32_t texture = scene.materials[2].color_texture;
  EXPECT_TRUE(scene.textures.at(texture).path.ends_with("x.png"));
  EXPECT_EQ(scene.objects[1].material, 0u);
}

TEST(SceneFromMesh, HasOneObjectAndTheMaterialsOfItsFile) {
  SceneFiles files;
  const Scene scene = load_scene(files.dir.write("tetra.OBJ", kTetrahedron));
  EXPECT_FALSE(scene.camera_given);
  EXPECT_FALSE(scene.lights_given);
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "tetra");
  EXPECT_TRUE(scene.materials.empty());
  EXPECT_TRUE(shape_of<MeshShape>(scene).slot_materials.empty());
  files.dir.write("red.mtl", "newmtl red\nKd 1 0 0\n");
  const Scene red =
      load_scene(files.dir.write("red.obj", std::string("mtllib red.mtl\nusemtl red\n") + kTetrahedron));
  ASSERT_EQ(red.materials.size(), 1u);
  EXPECT_EQ(shape_of<MeshShape>(red).slot_materials, std::vector<std::uint32_t>{0});
}

TEST(SceneFromMesh, WithoutAnAreaThereIsAWarning) {
  SceneFiles files;
  const Scene line = load_scene(files.dir.write("line.obj", "v 0 0 0\nv 1 2 3\nv 2 4 6\nf 1 2 3\n"));
  ASSERT_EQ(line.warnings.size(), 1u);
  EXPECT_NE(line.warnings[0].message.find("no triangle of the mesh has an area"), std::string::npos);
  // One triangle with an area is enough.
  const Scene tetra = load_scene(files.dir.write("tetra.obj", std::string(kTetrahedron) + "f 1 1 2\n"));
  EXPECT_TRUE(tetra.warnings.empty());
}

TEST(LoadScene, ChoosesByExtension) {
  SceneFiles files;
  EXPECT_EQ(load_scene(files.dir.write("a.yml", "oktett: 1\n")).objects.size(), 0u);
  EXPECT_EQ(load_scene(files.dir.write("a.obj", kTetrahedron)).objects.size(), 1u);
  try {
    load_scene(files.dir.write("a.3ds", "x"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(
        files.without_directory(e.what()),
        "a.3ds: unknown kind of file; expected a scene (.yaml, .yml, .pov) or a mesh (.obj, .ply, .stl, "
        ".off, .3mf, .gltf or .glb, also packed as .gz)");
    EXPECT_EQ(e.kind(), ErrorKind::bad_input);
  }
}

}  // namespace
}  // namespace oktett::scene_file_test
