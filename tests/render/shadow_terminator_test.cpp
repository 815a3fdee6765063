/// \file Where light ends on meshes of few triangles with interpolated normals: the normals show a ball, and
/// so must the light.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/render/test_scenes.h"

namespace oktett::shadow_terminator_test {
namespace {

using namespace test;

// ---- Balls

/// A ball of radius 1 about the origin with 20, 80, 320, ... triangles, whose normals are those of the ball.
std::shared_ptr<TriangleMesh> icosphere(int level) {
  auto mesh = std::make_shared<TriangleMesh>();
  std::vector<Vec3d> points;
  const double g = std::numbers::phi;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-g, g})
      for (int axis = 0; axis < 3; ++axis) {
        Vec3d p;
        p[axis] = s, p[(axis + 1) % 3] = t;
        points.push_back(normalize(p));
      }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // Corners of an edge are 1.05 apart, others at least 1.7.
  const auto near = [&](std::uint32_t a, std::uint32_t b) { return length(points[a] - points[b]) < 1.1; };
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        if (!near(a, b) || !near(b, c) || !near(c, a)) continue;
        const bool outward = dot(cross(points[b] - points[a], points[c] - points[a]), points[a]) > 0;
        triangles.push_back({a, outward ? b : c, outward ? c : b});
      }
  for (; level > 0; --level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), points.size());
      if (is_new) points.push_back(normalize(points[a] + points[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    triangles = finer;
  }
  for (const Vec3d& p : points) mesh->positions.push_back(Vec3f(p)), mesh->normals.push_back(Vec3f(p));
  for (const auto& t : triangles)
    for (const std::uint32_t i : t) mesh->indices.push_back(i), mesh->normal_indices.push_back(i);
  return mesh;
}

MeshShape ball(int level, bool smooth = true) {
  return MeshShape{icosphere(level), {}, smooth, TriangleTest::watertight};
}

constexpr IntegratorKind kKinds[] = {IntegratorKind::whitted, IntegratorKind::path};

/// A picture of the middle, lit without bounces.
Scene view(IntegratorKind kind, std::uint32_t size = 64) {
  Scene scene = bare_scene(size);
  scene.integrator.kind = kind, scene.integrator.depth = 0;
  scene.camera.from = {0.3, 0.7, 4}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 32;
  return scene;
}

Scene ball_scene(IntegratorKind kind, int level) {
  Scene scene = view(kind);
  add_object(scene, ball(level), add_material(scene, diffuse({1, 1, 1})));
  return scene;
}

const Vec3d kLights[] = {{1, 0.2, 0.1}, {-1, 0.4, -0.4}, {0.1, 1, 0.05}, {0.3, -1, -0.9}};

/// Compares pixels of a ball of some center with `cosine(normal, place)`, where the ball's own normal faces
/// the viewer: others are bent. Returns how many are lit.
template <class Cosine>
int expect_ball(const Scene& scene, const Vec3d& center, const Cosine& cosine, double tolerance = 1e-5) {
  const Picture p = run(scene).picture;
  int lit = 0;
  double worst = 0;
  for (std::uint32_t y = 0; y < p.height; ++y)
    for (std::uint32_t x = 0; x < p.width; ++x) {
      if (value(p, "A", x, y) == 0) continue;
      const Vec3d place(position(p, x, y)), n = normalize(place - center);
      if (dot(normalize(place - scene.camera.from), n) > -2e-3) continue;
      const double expected = cosine(n, place);
      lit += expected > 0;
      worst = std::max(worst, std::abs(static_cast<double>(value(p, "R", x, y)) - expected));
    }
  EXPECT_LT(worst, tolerance);
  return lit;
}

TEST(ShadowTerminator, BallsInParallelLightShowTheCosineOfTheBall) {
  for (const IntegratorKind kind : kKinds)
    for (int level = 0; level < 3; ++level)
      for (const Vec3d& towards : kLights) {
        Scene scene = ball_scene(kind, level);
        const Vec3d l = normalize(towards);
        scene.lights = {DirectionalLight{-l, {1, 1, 1}}};
        EXPECT_GT(
            expect_ball(scene, {}, [&](const Vec3d& n, const Vec3d&) { return std::max(0.0, dot(n, l)); }),
            80);
      }
}

/// A sphere light so far away that the ball's own size hardly matters, and so small that samples of it hardly
/// differ. It lights what faces it at the distance kFar by 1.
constexpr double kFar = 1e5, kRadius = 0.1;
void add_lamp(Scene& scene, const Vec3d& towards) {
  const auto radiance = static_cast<float>(kFar * kFar / (kRadius * kRadius));
  add_object(scene, SphereShape{normalize(towards) * kFar, kRadius},
             add_material(scene, glowing({radiance, radiance, radiance})));
}
double lamp_light(const Vec3d& towards, const Vec3d& n, const Vec3d& place) {
  const Vec3d to = normalize(towards) * kFar - place;
  return std::max(0.0, dot(n, to)) * kFar * kFar / std::pow(length(to), 3);
}

TEST(ShadowTerminator, BallsUnderASmallSphereLightShowTheCosineOfTheBall) {
  for (int level = 0; level < 3; ++level)
    for (const Vec3d& towards : kLights) {
      Scene scene = ball_scene(IntegratorKind::path, level);
      add_lamp(scene, towards);
      EXPECT_GT(
          expect_ball(scene, {},
                      [&](const Vec3d& n, const Vec3d& place) { return lamp_light(towards, n, place); }),
          80);
    }
}

// Where one of two lamps opposite to each other lies behind a triangle, it must still be chosen.
TEST(ShadowTerminator, LampsBehindTrianglesAreChosen) {
  for (const Vec3d& towards : kLights) {
    Scene scene = ball_scene(IntegratorKind::path, 0);
    add_lamp(scene, towards), add_lamp(scene, -towards);
    const auto light = [&](const Vec3d& n, const Vec3d& place) {
      return lamp_light(towards, n, place) + lamp_light(-towards, n, place);
    };
    // Close to the horizon of both, the wrong one may be chosen.
    EXPECT_GT(expect_ball(scene, {}, light, 1e-3), 200);
  }
}

TEST(ShadowTerminator, PointsAreSeenFromRaisedPoints) {
  for (const IntegratorKind kind : kKinds) {
    Scene scene = ball_scene(kind, 1);
    const Vec3d place = normalize(kLights[0]) * kFar;
    PointLight light;
    light.position = place, light.falloff = true,
    light.color = Color{1, 1, 1} * static_cast<float>(kFar * kFar);
    scene.lights = {light};
    expect_ball(scene, {}, [&](const Vec3d& n, const Vec3d& at) { return lamp_light(kLights[0], n, at); });
  }
}

// Also where maps move the ball, mirror it, or both in turn.
TEST(ShadowTerminator, MovedBallsShowTheCosineOfTheBall) {
  const Vec3d center{2, -1, 3}, l = normalize(kLights[1]);
  const Affine maps[] = {Affine::translation(center) * Affine::rotation({20, 30, 40}),
                         Affine::translation(center) * Affine::scaling({-0.5, 0.5, 0.5})};
  for (const Affine& map : maps)
    for (const bool instance : {false, true}) {
      Scene scene = view(IntegratorKind::path);
      scene.camera.from += center, scene.camera.at = center;
      scene.lights = {DirectionalLight{-l, {1, 1, 1}}};
      const std::uint32_t material = add_material(scene, diffuse({1, 1, 1}));
      if (instance) {
        Object inside;
        inside.shape = ball(0), inside.transform = Affine::rotation({10, 0, 5});
        scene.prototypes.push_back({"ball", {inside}});
        add_object(scene, InstanceShape{0}, material, map);
      } else {
        add_object(scene, ball(0), material, map);
      }
      expect_ball(scene, center, [&](const Vec3d& n, const Vec3d&) { return std::max(0.0, dot(n, l)); });
    }
}

// ---- What stays as it is

// The shadow of a mesh is that of its triangles, whatever its normals are.
TEST(ShadowTerminator, AFloorBelowABallKeepsItsBits) {
  for (const IntegratorKind kind : kKinds) {
    Picture pictures[2];
    for (const bool smooth : {false, true}) {
      Scene scene = view(kind);
      scene.integrator.samples = 4;
      scene.lights = {DirectionalLight{{-1, -0.6, -0.2}, {1, 1, 1}}};
      const std::uint32_t white = add_material(scene, diffuse({1, 1, 1}));
      add_object(scene, PlaneShape{{0, 1, 0}, -1}, white);
      add_object(scene, ball(0, smooth), white);
      if (kind == IntegratorKind::path)
        add_object(scene, SphereShape{{3, 2, 0}, 0.3}, add_material(scene, glowing({9, 9, 9})));
      pictures[smooth] = run(scene).picture;
    }
    int floor = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) {
        if (id(pictures[0], "geomID.I", x, y) != 0 || value(pictures[0], "P.Y", x, y) > -0.999f) continue;
        ++floor;
        EXPECT_EQ(color(pictures[0], x, y), color(pictures[1], x, y));
      }
    EXPECT_GT(floor, 500);
  }
}

TEST(ShadowTerminator, FlatTrianglesAreLitByTheirOwnCosine) {
  for (const IntegratorKind kind : kKinds) {
    Scene scene = view(kind);
    add_object(scene, ball(0, false), add_material(scene, diffuse({1, 1, 1})));
    const Vec3d l = normalize(kLights[0]);
    scene.lights = {DirectionalLight{-l, {1, 1, 1}}};
    const Picture p = run(scene).picture;
    for (std::uint32_t y = 0; y < p.height; ++y)
      for (std::uint32_t x = 0; x < p.width; ++x) {
        if (value(p, "A", x, y) == 0) continue;
        const Vec3d n{value(p, "N.X", x, y), value(p, "N.Y", x, y), value(p, "N.Z", x, y)};
        const double cosine = dot(n, l);
        EXPECT_NEAR(value(p, "R", x, y), std::max(0.0, cosine), 1e-6);
        EXPECT_TRUE(cosine > -1e-6 || value(p, "R", x, y) == 0);
      }
  }
}

// Walls are so close to the ball that they would lie between it and the points of Hanika's formula.
TEST(ShadowTerminator, ClosedRoomsStayDark) {
  for (const IntegratorKind kind : kKinds)
    for (const double room : {1.001, 1.03, 1.3})
      for (int level = 0; level < 2; ++level) {
        Scene scene = view(kind, 48);
        scene.integrator.depth = 2, scene.integrator.samples = 4;
        scene.camera.from = Vec3d{1, 1, 1} * (room - 1e-3), scene.camera.fov = 100;
        const std::uint32_t white = add_material(scene, diffuse({1, 1, 1}));
        add_object(scene, BoxShape{Vec3d{-1, -1, -1} * room, Vec3d{1, 1, 1} * room}, white);
        add_object(scene, ball(level), white);
        for (const Vec3d& l : kLights)
          for (const double side : {-1.0, 1.0})
            for (int turn = 0; turn < 3; ++turn)
              scene.lights.push_back(
                  DirectionalLight{Vec3d{l[turn], l[(turn + 1) % 3], l[(turn + 2) % 3]} * side, {1, 1, 1}});
        const Picture p = run(scene).picture;
        int seen = 0;
        for (std::uint32_t y = 0; y < p.height; ++y)
          for (std::uint32_t x = 0; x < p.width; ++x) {
            EXPECT_EQ(color(p, x, y), (Color{0, 0, 0}));
            seen += id(p, "geomID.I", x, y) == 1;
          }
        EXPECT_GT(seen, 200);
      }
}

// A wall just behind a smooth sheet hides what is behind it.
TEST(ShadowTerminator, AWallBehindASheetHidesTheLight) {
  for (const IntegratorKind kind : kKinds) {
    Scene scene = view(kind);
    const std::uint32_t white = add_material(scene, diffuse({1, 1, 1}));
    const auto sheet = parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    for (const Vec3f& n : {Vec3f{-1, -1, 1}, Vec3f{1, -1, 1}, Vec3f{1, 1, 1}, Vec3f{-1, 1, 1}})
      sheet->normals.push_back(normalize(n));
    sheet->normal_indices = sheet->indices;
    add_object(scene, MeshShape{sheet, {}, true, TriangleTest::watertight}, white);
    add_object(scene, PlaneShape{{0, 0, 1}, -1e-3}, white);
    for (const double x : {-1.0, 1.0}) scene.lights.push_back(DirectionalLight{{x, 0.1, 0.05}, {1, 1, 1}});
    const Picture p = run(scene).picture;
    for (const float v : p.find("R")->values) EXPECT_EQ(v, 0);
  }
}

// ---- Energy

// Every path of a white ball ends in the white that is around it.
TEST(ShadowTerminator, WhiteBallsInAWhiteVoidAreNotSeen) {
  for (int level = 0; level < 3; ++level) {
    Scene scene = ball_scene(IntegratorKind::path, level);
    scene.integrator.depth = 60, scene.integrator.samples = 16;
    scene.background = {1, 1, 1};
    const Picture p = run(scene).picture;
    for (const float v : p.find("R")->values) {
      EXPECT_LE(v, 1 + 1e-5f);
      EXPECT_GE(v, 1 - 1e-5f);
    }
  }
}

/// Six squares around the middle, at this distance from it.
void add_cube(Scene& scene, double distance, std::uint32_t material) {
  const auto d = static_cast<float>(distance);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-d, d}) {
      Vec3f corner{-d, -d, -d}, u, v;
      corner[axis] = side, u[(axis + 1) % 3] = 2 * d, v[(axis + 2) % 3] = 2 * d;
      add_object(scene, MeshShape{parallelogram(corner, u, v), {}, false, TriangleTest::watertight},
                 material);
    }
}

/// The mean of the pixels of the first object.
double mean_of_first(const Scene& scene) {
  const Picture p = run(scene).picture;
  double sum = 0, count = 0;
  for (std::uint32_t y = 0; y < p.height; ++y)
    for (std::uint32_t x = 0; x < p.width; ++x)
      if (id(p, "geomID.I", x, y) == 0) sum += static_cast<double>(value(p, "R", x, y)), ++count;
  return sum / count;
}

// The same where samples of light find the white, too: the weights of both ways must add up. The room is a
// ball, or a cube of six rectangles.
TEST(ShadowTerminator, WhiteBallsInAGlowingRoomAreWhite) {
  for (const double room : {1.2, 5.0})
    for (const bool cube : {false, true}) {
      Scene scene = ball_scene(IntegratorKind::path, 0);
      scene.camera.from = normalize(scene.camera.from) * 1.15, scene.camera.fov = 70;
      scene.integrator.samples = 256;
      const std::uint32_t white = add_material(scene, glowing({1, 1, 1}));
      if (cube)
        add_cube(scene, room, white);
      else
        add_object(scene, SphereShape{{}, room}, white);
      EXPECT_NEAR(mean_of_first(scene), 1, 5e-4) << room << ' ' << cube;
    }
}

/// A sheet whose normals lean towards a lamp that lies behind its plane. Without `sampled` only rays that
/// happen to meet the lamp find its light.
Scene leaning_sheet(const Shape& lamp, bool sampled) {
  Scene scene = view(IntegratorKind::path, 24);
  const auto sheet = parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (const Vec3f& n : {Vec3f{0.5f, 0, 1}, Vec3f{1, 0, 1}, Vec3f{1, 0.2f, 1}, Vec3f{0.7f, 0.1f, 1}})
    sheet->normals.push_back(normalize(n));
  sheet->normal_indices = sheet->indices;
  add_object(scene, MeshShape{sheet, {}, true, TriangleTest::watertight},
             add_material(scene, diffuse({1, 1, 1})));
  Material m = glowing({9, 9, 9});
  if (!sampled) m.opacity = std::nextafter(1.0f, 0.0f);
  add_object(scene, lamp, add_material(scene, m));
  scene.integrator.samples = sampled ? 256 : 4096;
  return scene;
}

TEST(ShadowTerminator, SamplesOfLampsBehindASheetFindTheLightThatRaysFind) {
  const Vec3d place{2.5, 0.2, -0.7};
  const Vec3d n = normalize(-place), u = normalize(cross(n, {0, 1, 0})), v = cross(n, u);
  const auto triangle = std::make_shared<TriangleMesh>();
  for (const Vec3d& p : {place - (u + v) * 0.6, place + (u - v) * 0.6, place + v * 0.6})
    triangle->positions.push_back(Vec3f(p));
  for (const std::uint32_t i : {0u, 1u, 2u}) triangle->indices.push_back(i);
  const auto rectangle = parallelogram(Vec3f(place - (u + v) * 0.5), Vec3f(u), Vec3f(v));
  const Shape lamps[] = {MeshShape{triangle, {}, false, TriangleTest::watertight},
                         MeshShape{rectangle, {}, false, TriangleTest::watertight}, DiskShape{place, n, 0.6},
                         SphereShape{place, 0.6}};
  for (const Shape& lamp : lamps) {
    const double by_samples = mean_of_first(leaning_sheet(lamp, true));
    const double by_chance = mean_of_first(leaning_sheet(lamp, false));
    EXPECT_GT(by_samples, 0.05);
    EXPECT_NEAR(by_samples / by_chance, 1, 0.02);
  }
}

// ---- Instruction sets

TEST(ShadowTerminator, AllInstructionSetsGiveTheSameBits) {
  for (const IntegratorKind kind : kKinds) {
    Scene scene = ball_scene(kind, 0);
    scene.integrator.samples = 4, scene.integrator.depth = 3;
    Material shiny = diffuse({0.7f, 0.5f, 0.2f});
    shiny.specular = 0.4f, shiny.phong = 20;
    add_object(scene, ball(1), add_material(scene, shiny), Affine::translation({1, 0.5, -1.5}));
    add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, diffuse({0.6f, 0.6f, 0.6f})));
    add_object(scene, SphereShape{{3, 2, 0}, 0.3}, add_material(scene, glowing({9, 9, 9})));
    scene.integrator.light_samples = kind == IntegratorKind::whitted ? 4 : 0;
    PointLight point;
    point.position = {-4, 1, 0};
    scene.lights = {DirectionalLight{{-1, -0.6, -0.2}, {1, 1, 1}}, point};
    const Picture scalar = run(scene, [](RenderOptions& o) { o.isa = Isa::scalar; }).picture;
    for (const Isa isa : available_isas())
      EXPECT_TRUE(same_bytes(scalar, run(scene, [&](RenderOptions& o) { o.isa = isa; }).picture))
          << to_string(isa);
  }
}

}  // namespace
}  // namespace oktett::shadow_terminator_test
