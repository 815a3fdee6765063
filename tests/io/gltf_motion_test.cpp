// Animations, skins and morph targets of glTF files at a time.

#include <cmath>
#include <numbers>

#include "io/scene/scene_file.h"
#include "render/geometry.h"
#include "tests/io/gltf_test_support.h"
#include "tests/render/test_scenes.h"

namespace oktett::test::gltf_motion_test {
namespace {

GltfOptions at_time(double time, double shutter = 0) {
  GltfOptions options;
  options.time = time, options.shutter = shutter;
  return options;
}

/// A triangle that a node shows; `channel` animates what `path` names.
class Moving {
 public:
  Moving(const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
         std::size_t width, const std::string& curve, const std::string& node = "") {
    GltfWriter out;
    out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    out.array(times, kFloat, "SCALAR", 1);
    out.array(values, kFloat, width == 4 ? "VEC4" : width == 3 ? "VEC3" : "SCALAR", width);
    out.vectors({{0, 0, 2}, {0, 0, 2}, {0, 0, 4}});
    path_ = files_.files.write(
        "a.glb",
        out.glb("\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":"
                "[{\"POSITION\":3}]}]}],\"nodes\":[{\"mesh\":0" +
                node + "}],\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"" +
                path + "\"}}],\"samplers\":[{\"input\":1,\"output\":2,\"interpolation\":\"" + curve +
                "\"}]}]"));
  }

  FileScene scene(const GltfOptions& options) const { return load_gltf_scene(path_, options); }
  /// Where the node shows a point.
  Vec3d point(double time, const Vec3d& p) const {
    return scene(at_time(time)).placements.at(0).to_world.point(p);
  }
  const std::string& path() const { return path_; }

 private:
  GltfFiles files_;
  std::string path_;
};

TEST(GltfMotion, LinesAndStepsBetweenKeys) {
  const std::vector<float> times{1, 2, 4}, places{0, 0, 0, 10, 0, 0, 10, 20, 0};
  const Moving linear("translation", times, places, 3, "LINEAR"),
      step("translation", times, places, 3, "STEP");
  for (const auto& [time, expected] : {std::pair<double, Vec3d>{0, {0, 0, 0}},
                                       {1, {0, 0, 0}},
                                       {1.25, {2.5, 0, 0}},
                                       {2, {10, 0, 0}},
                                       {3, {10, 10, 0}},
                                       {9, {10, 20, 0}}})
    EXPECT_LT(length(linear.point(time, {0, 0, 0}) - expected), 1e-6) << time;
  for (const auto& [time, expected] :
       {std::pair<double, Vec3d>{1.9, {0, 0, 0}}, {2, {10, 0, 0}}, {3.9, {10, 0, 0}}, {4, {10, 20, 0}}})
    EXPECT_LT(length(step.point(time, {0, 0, 0}) - expected), 1e-6) << time;
}

// A turn of 90 degrees about z in two seconds, along the shorter way although the signs of the keys differ.
TEST(GltfMotion, RotationsTurnAtConstantSpeed) {
  const auto h = static_cast<float>(std::sqrt(0.5));
  const Moving turn("rotation", {0, 2}, {0, 0, 0, 1, 0, 0, -h, -h}, 4, "LINEAR", ",\"translation\":[5,0,0]");
  for (const double time : {0.0, 0.5, 1.0, 1.7, 2.0}) {
    const double angle = time * std::numbers::pi / 4;
    EXPECT_LT(length(turn.point(time, {1, 0, 0}) - Vec3d{5 + std::cos(angle), std::sin(angle), 0}), 1e-6)
        << time;
  }
}

// The cubic with these values and slopes at its ends, here x^3 - 2 x + 1 from 0 to 2.
TEST(GltfMotion, CubicCurvesAreThoseOfTheirTangents) {
  const auto value = [](float x) { return x * x * x - 2 * x + 1; };
  const auto slope = [](float x) { return 3 * x * x - 2; };
  std::vector<float> numbers;
  for (const float x : {0.0f, 2.0f})
    for (const float y : {slope(x), value(x), slope(x)}) numbers.insert(numbers.end(), {y, 0, 0});
  const Moving cubic("translation", {0, 2}, numbers, 3, "CUBICSPLINE");
  for (const double time : {0.0, 0.3, 1.0, 1.9, 2.0})
    EXPECT_NEAR(cubic.point(time, {0, 0, 0}).x, time * time * time - 2 * time + 1, 1e-6) << time;
}

TEST(GltfMotion, WithoutATimeThingsAreAtRest) {
  const Moving moving("translation", {0, 2}, {1, 0, 0, 3, 0, 0}, 3, "LINEAR", ",\"translation\":[7,0,0]");
  const FileScene scene = moving.scene({});
  EXPECT_EQ(scene.placements.at(0).to_world.point({0, 0, 0}), (Vec3d{7, 0, 0}));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].message, "animations are not shown without a time: things are shown at rest");
  EXPECT_EQ(moving.scene(at_time(1)).warnings.size(), 0u);
}

// Weights of the mesh, of the node, of the animation: each replaces those before.
TEST(GltfMotion, MorphTargetsAreAddedByTheirWeights) {
  const auto z = [](const Moving& moving, const GltfOptions& options) {
    const FileScene scene = moving.scene(options);
    const Vec3f p = scene.meshes.at(0).mesh->positions[2];
    EXPECT_EQ((Vec3f{p.x, p.y, 0}), (Vec3f{0, 1, 0}));
    return p.z;
  };
  const Moving moving("weights", {0, 1}, {0.25f, 0.75f}, 1, "LINEAR");
  EXPECT_EQ(z(moving, {}), 2);
  EXPECT_EQ(z(moving, at_time(0)), 1);
  EXPECT_EQ(z(moving, at_time(0.5)), 2);
  EXPECT_EQ(z(moving, at_time(2)), 3);
  EXPECT_EQ(z(Moving("weights", {0, 1}, {0.25f, 0.75f}, 1, "LINEAR", ",\"weights\":[-1]"), {}), -4);
}

// Nine poses while the shutter is open, from time 0 to 1 of the scene.
TEST(GltfMotion, TheShutterBlursWhatMoves) {
  const Moving moving("translation", {0, 4}, {0, 0, 0, 8, 0, 0}, 3, "LINEAR");
  const FileScene scene = moving.scene(at_time(1, 0.5));
  const MotionPointer motion = scene.placements.at(0).motion;
  ASSERT_TRUE(motion);
  for (const double t : {0.0, 0.25, 0.6, 1.0})
    EXPECT_LT(length(motion->at(t).point({0, 0, 0}) - Vec3d{2 * (1 + 0.5 * t), 0, 0}), 1e-6) << t;
  EXPECT_FALSE(moving.scene(at_time(1)).placements.at(0).motion);
  EXPECT_FALSE(moving.scene(at_time(5, 0.5)).placements.at(0).motion);
  // The scene of the file alone has it, too.
  const Scene loaded = load_scene(moving.path(), {}, std::nullopt, at_time(1, 0.5));
  ASSERT_TRUE(loaded.objects.at(0).motion);
  EXPECT_EQ(loaded.objects.at(0).motion->at(0.5), motion->at(0.5));
}

/// Two joints; the second is a child of the first and turns about z by what the animation says. The mesh is a
/// triangle at x = 0, 1 and 2.
struct Skinned {
  explicit Skinned(const std::string& node = "", const std::string& weights_type = "VEC4") {
    GltfWriter out;
    out.vectors({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}});
    out.vectors({{0, 0, 1}, {0, 0, 1}, {0, 1, 0}});
    out.array(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, kUint8, "VEC4", 4);
    out.array(std::vector<float>{1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 2, 0, 0, 0}, kFloat, weights_type.c_str(), 4);
    // The bind pose: the first joint at 0, the second at (1, 0, 0).
    std::vector<float> binds;
    for (const float x : {0.0f, -1.0f})
      binds.insert(binds.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1});
    out.array(binds, kFloat, "MAT4", 16);
    out.array(std::vector<float>{0, 1}, kFloat, "SCALAR", 1);
    const auto h = static_cast<float>(std::sqrt(0.5));
    out.array(std::vector<float>{0, 0, 0, 1, 0, 0, h, h}, kFloat, "VEC4", 4);
    path = files.files.write(
        "a.glb",
        out.glb(
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"JOINTS_0\":2,"
            "\"WEIGHTS_0\":3}}]}],\"nodes\":[{\"mesh\":0,\"skin\":0" +
            node +
            "},{\"translation\":[0,0,5],\"children\":[2]},{\"translation\":[1,0,0]}],\"scenes\":[{\"nodes\":["
            "0,1]}],"
            "\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":4}],\"animations\":[{\"channels\":[{"
            "\"sampler\":0,"
            "\"target\":{\"node\":2,\"path\":\"rotation\"}}],\"samplers\":[{\"input\":5,\"output\":6}]}]"));
  }

  GltfFiles files;
  std::string path;
};

TEST(GltfMotion, SkinsMoveVerticesWithTheirJoints) {
  // Where the node itself is does not count.
  for (const char* const node : {"", ",\"translation\":[100,0,0]", ",\"scale\":[0,0,0]"}) {
    const Skinned skinned(node);
    const auto mesh_at = [&](const GltfOptions& options) {
      const FileScene scene = load_gltf_scene(skinned.path, options);
      EXPECT_TRUE(scene.placements.at(0).to_world.is_identity());
      return scene.meshes.at(0).mesh;
    };
    const auto rest = mesh_at({});
    EXPECT_LT(length(Vec3d(rest->positions[2]) - Vec3d{2, 1, 5}), 1e-6);
    const auto turned = mesh_at(at_time(1));
    // All with the first joint; half with each; all with the second, whose weight of 2 counts as 1: a quarter
    // about (1, 0, 5).
    EXPECT_LT(length(Vec3d(turned->positions[0]) - Vec3d{0, 0, 5}), 1e-6);
    EXPECT_LT(length(Vec3d(turned->positions[1]) - Vec3d{1, 0, 5}), 1e-6);
    EXPECT_LT(length(Vec3d(turned->positions[2]) - Vec3d{0, 1, 5}), 1e-6);
    EXPECT_LT(length(Vec3d(turned->normals[2]) - Vec3d{-1, 0, 0}), 1e-6);
    EXPECT_LT(length(Vec3d(turned->normals[0]) - Vec3d{0, 0, 1}), 1e-6);
  }
}

/// The mean of the alpha of pictures, which is the part of the time for which a pixel shows something.
std::vector<double> mean_alpha(const std::vector<Scene>& scenes) {
  std::vector<double> mean;
  for (const Scene& scene : scenes) {
    const Picture picture = run(scene).picture;
    const auto& alpha = picture.find("A")->values;
    mean.resize(alpha.size());
    for (std::size_t i = 0; i < alpha.size(); ++i)
      mean[i] += static_cast<double>(alpha[i]) / static_cast<double>(scenes.size());
  }
  return mean;
}

double mean_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

/// The file from before it, at a time and for so long.
Scene seen_at(const std::string& path, const GltfOptions& options, std::uint32_t samples) {
  Scene scene = load_scene(path, {}, IntegratorKind::albedo, options);
  scene.camera_given = scene.lights_given = true;
  scene.camera.from = {1, 0.5, 12}, scene.camera.at = {1, 0.5, 0}, scene.camera.fov = 20;
  scene.film.width = scene.film.height = 32;
  scene.integrator.kind = IntegratorKind::albedo;
  // A background that is part of the picture covers it.
  scene.background = {0, 0, 0};
  scene.integrator.samples = samples;
  return scene;
}

/// What a file shows while the shutter is open is the mean of what it shows at the times in between.
void expect_blur(const std::string& path, double time, double shutter) {
  std::vector<Scene> frames;
  for (int i = 0; i < 32; ++i) frames.push_back(seen_at(path, at_time(time + shutter * (i + 0.5) / 32), 4));
  const std::vector<double> mean = mean_alpha(frames),
                            blurred = mean_alpha({seen_at(path, at_time(time, shutter), 64)}),
                            sharp = mean_alpha({seen_at(path, at_time(time), 64)});
  EXPECT_LT(mean_difference(blurred, mean), 0.015);
  EXPECT_GT(mean_difference(sharp, mean), 0.04);
}

TEST(GltfMotion, TheShutterBlursSkinsAndMorphTargets) {
  expect_blur(Skinned().path, 0, 1);
  // The only target moves the triangle across the picture.
  GltfWriter out;
  out.vectors({{0, -1, 0}, {1, -1, 0}, {0, 2, 0}});
  out.array(std::vector<float>{0, 1}, kFloat, "SCALAR", 1);
  out.array(std::vector<float>{0, 1}, kFloat, "SCALAR", 1);
  out.vectors({{2, 0, 0}, {2, 0, 0}, {2, 0, 0}});
  const GltfFiles files;
  const auto write = [&](const std::string& primitive) {
    return files.files.write(
        "a.glb", out.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":"
                         "[{\"POSITION\":3}]" +
                         primitive +
                         "}]}],\"nodes\":[{\"mesh\":0,\"scale\":[1,0.7,1]}],\"animations\":[{\"channels\":"
                         "[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}}],\"samplers\":[{"
                         "\"input\":1,\"output\":2}]}]"));
  };
  expect_blur(write(""), 0, 1);
  // What moves between the first and the middle pose is blurred as much.
  expect_blur(write(""), 0.25, 0.5);
}

/// Each moment of the shutter has the vertices between two of nine poses, which are those of the file then.
TEST(GltfMotion, PosesOfTheShutterAreThoseOfTheirTimes) {
  const Skinned skinned;
  const FileScene scene = load_gltf_scene(skinned.path, at_time(0.25, 0.5));
  ASSERT_NE(scene.meshes.at(0).bending, nullptr);
  const std::vector<MeshPose>& poses = scene.meshes[0].bending->poses;
  ASSERT_EQ(poses.size(), 9u);
  for (const MeshPose& pose : poses) {
    const FileScene then = load_gltf_scene(skinned.path, at_time(0.25 + 0.5 * pose.time));
    EXPECT_EQ(then.meshes.at(0).bending, nullptr);
    EXPECT_EQ(to_vector(pose.positions), to_vector(then.meshes[0].mesh->positions));
    EXPECT_EQ(to_vector(pose.normals), to_vector(then.meshes[0].mesh->normals));
    MeshShape shape;
    shape.mesh = scene.meshes[0].mesh, shape.bending = scene.meshes[0].bending;
    EXPECT_EQ(to_vector(mesh_at(shape, pose.time)->positions), to_vector(pose.positions));
  }
  // What is not bent meanwhile has none.
  EXPECT_EQ(load_gltf_scene(skinned.path, at_time(5, 0.5)).meshes.at(0).bending, nullptr);
}

TEST(GltfMotion, DamagedMotionIsRefused) {
  // The file lives as long as its Moving.
  const auto error = [](const Moving& moving) -> std::string {
    try {
      moving.scene(at_time(0.5));
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  const auto ends = [](const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
  };
  const std::string order = error(Moving("translation", {1, 1}, {0, 0, 0, 1, 0, 0}, 3, "LINEAR"));
  EXPECT_TRUE(ends(order, "a.glb: animation channel 0: its times do not ascend")) << order;
  const std::string few = error(Moving("translation", {1, 2}, {0, 0, 0}, 3, "LINEAR"));
  EXPECT_TRUE(ends(few, "a.glb: animation channel 0: expected 6 numbers for 2 keys, found 3")) << few;
  const std::string type = error(Moving("rotation", {1}, {0, 0, 0}, 3, "LINEAR"));
  EXPECT_TRUE(ends(type, "a.glb: accessors[2]: expected vectors of 4 numbers, found 3")) << type;
}

}  // namespace
}  // namespace oktett::test::gltf_motion_test
