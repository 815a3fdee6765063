/// \file The view, the light and the ground that a mesh without a scene gets.

#include "render/look/default_look.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "render/camera.h"
#include "render/light/environment_map.h"
#include "render/look/mesh_view.h"
#include "tests/render/light_checks.h"
#include "tests/render/look_meshes.h"
#include "tests/render/test_scenes.h"

namespace oktett::look_test {
namespace {

using light_checks::Random;
using look_meshes::add_box;
using look_meshes::add_triangle;
using look_meshes::ball;

Film film(std::uint32_t width, std::uint32_t height) {
  Film f;
  f.width = width, f.height = height;
  return f;
}

Scene scene_of(TriangleMesh mesh) {
  Scene scene;
  scene.film = film(64, 36);
  MeshShape shape;
  shape.mesh = std::make_shared<TriangleMesh>(std::move(mesh));
  scene.objects.emplace_back().shape = shape;
  return scene;
}

TEST(FitMesh, FillsTheFrameAndCutsNothingOff) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    TriangleMesh mesh;
    const double size = std::exp(random.between(-8, 8));
    const auto point = [&] {
      return Vec3f(Vec3d{random.between(-1, 2), random.between(0, 3), random.between(-1, 1)} * size);
    };
    for (int i = 0; i < 5; ++i) add_triangle(mesh, point(), point(), point());
    const Film f = film(static_cast<std::uint32_t>(random.between(20, 500)), 100);
    const double margin = random.between(0, 0.2);
    const Camera camera = fit_mesh(mesh, Vec3d{0.2, -0.4, -1}, {0, 1, 0}, 35, margin, f);
    const CameraFrame frame = camera_frame(camera, f);
    double left = 1, right = 0, top = 1, bottom = 0;
    for (const Vec3f& p : mesh.positions) {
      const Vec3d d = Vec3d(p) - camera.from;
      const double depth = dot(d, frame.forward), height = 2 * std::tan(35 * std::numbers::pi / 360) * depth;
      ASSERT_GT(depth, 0);
      const double x = 0.5 + dot(d, frame.right) / (height * f.width / f.height),
                   y = 0.5 - dot(d, frame.up) / height;
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y),
      bottom = std::max(bottom, y);
    }
    EXPECT_GT(std::min(left, top), margin - 1e-6);
    EXPECT_LT(std::max(right, bottom), 1 - margin + 1e-6);
    // It touches the margins on two opposite sides and stands in the middle of the others.
    EXPECT_NEAR(std::min(left, top), margin, 1e-5);
    EXPECT_NEAR(std::max(right, bottom), 1 - margin, 1e-5);
  }
}

// The ground far from everything must look like the backdrop: radiance = albedo * irradiance / pi.
TEST(StudioPicture, GroundAndBackdropMerge) {
  StudioFrame frame;
  frame.up = {0, 0, 1}, frame.back = {0, -1, 0};
  const EnvironmentMap map(studio_picture(frame, 0.42, 0.45));
  Random random(2);
  constexpr int kSteps = 400;
  Vec3d irradiance;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {  // directions by their cosine
      const double r = std::sqrt((i + random()) / kSteps), a = (j + random()) / kSteps * 2 * std::numbers::pi;
      const Vec3d d{r * std::cos(a), r * std::sin(a), std::sqrt(1 - r * r)};
      irradiance += Vec3d(map.radiance(Vec3f(d))) * (std::numbers::pi / (kSteps * kSteps));
    }
  const Vec3d below(map.radiance({0.6f, 0, -0.8f}));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(below[k], 0.42 / std::numbers::pi * irradiance[k], 3e-3 * below[k]);
  EXPECT_NEAR((below.x + below.y + below.z) / 3, 0.45, 1e-5);
}

TEST(SmoothNormals, RoundThingsAreRoundAndEdgesStaySharp) {
  TriangleMesh round = ball(24);
  add_smooth_normals(round, 40);
  ASSERT_EQ(round.normal_indices.size(), round.indices.size());
  for (std::size_t i = 0; i < round.indices.size(); ++i)
    EXPECT_GT(dot(round.normals[round.normal_indices[i]], round.positions[round.indices[i]]), 0.995f);
  TriangleMesh box;
  add_box(box, {0, 0, 0}, {1, 1, 1});
  add_smooth_normals(box, 40);
  for (std::size_t i = 0; i < box.indices.size(); ++i) {
    const Vec3f n = box.normals[box.normal_indices[i]];
    EXPECT_EQ(max_component(abs(n)), 1);
  }
  // A fold of just less than the angle is smooth, one of just more is an edge.
  for (const double degrees : {39.7, 40.3}) {
    TriangleMesh fold;
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3f down(Vec3d{0, -std::cos(angle), -std::sin(angle)});
    for (const Vec3f& p : {Vec3f{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, down}) fold.positions.push_back(p);
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 3u, 1u}) fold.indices.push_back(i);
    add_smooth_normals(fold, 40);
    EXPECT_NEAR(fold.normals[fold.normal_indices[0]].z, degrees < 40 ? std::cos(angle / 2) : 1, 1e-5)
        << degrees;
  }
  TriangleMesh flat;  // without area
  add_triangle(flat, {0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  add_smooth_normals(flat, 40);
  EXPECT_EQ(flat.normal_indices[0], kNoId);
}

TEST(DefaultLook, StandsOnAGroundThatFades) {
  Scene scene = scene_of(ball(16));
  apply_look(scene, Look::studio);
  scene.integrator.samples = 64;
  EXPECT_EQ(scene.integrator.kind, IntegratorKind::path);
  ASSERT_EQ(scene.objects.size(), 3u);
  const auto& ground = std::get<DiskShape>(scene.objects[1].shape);
  EXPECT_LT(ground.center.y, -1);
  EXPECT_GT(ground.center.y, -1.01);
  const Picture picture = test::run(scene).picture;
  const auto red = [&](std::uint32_t x, std::uint32_t y) { return test::value(picture, "R", x, y); };
  // No seam at the left side, where nothing casts a shadow: ground and backdrop differ by noise only.
  for (std::uint32_t y = 12; y < 35; ++y) EXPECT_NEAR(red(1, y) / red(1, y + 1), 1, 0.12) << y;
  // The shadow lies to the right behind the ball.
  float darkest = 1;
  for (std::uint32_t x = 40; x < 63; ++x) darkest = std::min(darkest, red(x, 30));
  EXPECT_LT(darkest, 0.8f * red(2, 30));
}

// A material is never taken for a missing one, whatever its name is.
TEST(DefaultLook, OnlyWhatHasNoMaterialGetsOne) {
  for (const char* name : {"", "neutral", "satin"}) {
    Scene scene = scene_of(ball(8));
    scene.materials.emplace_back().name = name;
    std::get<MeshShape>(scene.objects[0].shape).slot_materials = {0};
    apply_look(scene, Look::studio);
    EXPECT_EQ(scene.objects[0].material, kNoId) << name;
  }
  Scene scene = scene_of(ball(8));
  apply_look(scene, Look::studio);
  ASSERT_NE(scene.objects[0].material, kNoId);
  EXPECT_EQ(scene.materials[scene.objects[0].material].name, "satin");
}

TEST(DefaultLook, StandsWhereItIsTold) {
  for (const Viewpoint viewpoint : {Viewpoint::automatic, Viewpoint::outside, Viewpoint::inside}) {
    Scene scene = scene_of(ball(8));
    apply_look(scene, Look::studio, viewpoint);
    const bool inside = viewpoint == Viewpoint::inside;
    EXPECT_EQ(length(scene.camera.from) < 1, inside);
    EXPECT_EQ(scene.objects.size(), inside ? 1u : 3u);
  }
  // Without an area there is no inside.
  TriangleMesh point;
  add_triangle(point, {1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  Scene scene = scene_of(point);
  apply_look(scene, Look::studio, Viewpoint::inside);
  EXPECT_NE(scene.camera.from, scene.camera.at);
}

TEST(DefaultLook, AnyAxisMayPointUp) {
  for (const Vec3d& up : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
    Scene scene = scene_of(ball(8));
    scene.camera.up = up;
    apply_look(scene, Look::studio);
    EXPECT_GT(dot(scene.camera.from, up), 0);
    const auto& ground = std::get<DiskShape>(scene.objects[1].shape);
    EXPECT_NEAR(dot(Vec3d(ground.center), up), -1, 1e-2);
    EXPECT_EQ(Vec3d(ground.normal), up);
  }
}

TEST(DefaultLook, ClayCoversMaterialsAndStudioKeepsThem) {
  for (const Look look : {Look::studio, Look::clay, Look::normals}) {
    Scene scene = scene_of(ball(8));
    scene.materials.emplace_back().name = "own";
    std::get<MeshShape>(scene.objects[0].shape).slot_materials = {0};
    apply_look(scene, look);
    const std::uint32_t material = scene.objects[0].material;
    EXPECT_EQ(material == kNoId, look != Look::clay);
    EXPECT_EQ(scene.objects.size(), look == Look::normals ? 1u : 3u);
    EXPECT_TRUE(scene.camera_given);
  }
  Scene nothing;
  apply_look(nothing, Look::studio);
  EXPECT_FALSE(nothing.camera_given);
}

}  // namespace
}  // namespace oktett::look_test
