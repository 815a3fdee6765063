/// \file A thousand small lamps over a floor: pictures against closed forms, and the choice among the lamps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/isa.h"
#include "render/light/light_set.h"
#include "render/transport/render_code.h"
#include "tests/render/light_checks.h"
#include "tests/render/test_scenes.h"

namespace oktett::light_lamps_test {
namespace {

using namespace test;
using light_checks::chi_squared;
using light_checks::lambert;
using light_checks::Random;

constexpr double kHeight = 2.5, kEdge = 0.03, kRadius = 0.02;
constexpr int kSide = 32;

/// The corners of lamps at one height, so that none hides another, each at random in its cell of a grid.
std::vector<Vec3d> lamp_places() {
  Random random(1);
  std::vector<Vec3d> places;
  for (int i = 0; i < kSide * kSide; ++i)
    places.push_back({(i % kSide + random.between(0, 0.9)) / kSide * 12 - 6, kHeight,
                      (i / kSide + random.between(0, 0.9)) / kSide * 12 - 6});
  return places;
}

/// The radiance of lamp number `i`: from 1 to 100.
float strength(std::size_t i) { return std::pow(100.0f, static_cast<float>(i % 7) / 6); }

/// A diffuse floor of albedo 1/2 under the lamps that `add` adds, seen from below them.
Scene floor_under(const std::function<void(Scene&, const Vec3d&, std::uint32_t material)>& add) {
  Scene scene = bare_scene(16);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 512, scene.integrator.depth = 0;
  scene.camera.from = {0, 2, 0}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 0, -1};
  scene.camera.fov = 90;
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, diffuse({0.5f, 0.5f, 0.5f})));
  for (std::size_t i = 0; i < 7; ++i) add_material(scene, glowing(Color{1, 1, 1} * strength(i)));
  const std::vector<Vec3d> places = lamp_places();
  for (std::size_t i = 0; i < places.size(); ++i)
    add(scene, places[i], static_cast<std::uint32_t>(1 + i % 7));
  return scene;
}

/// What the floor shows by the irradiance that `lamp(place, point)` says a lamp of radiance 1 gives: the mean
/// over each pixel by Gauss's rule of 2 x 2 points.
std::vector<double> floor_light(const std::function<double(const Vec3d&, const Vec3d&)>& lamp) {
  constexpr int kSize = 16;
  const std::vector<Vec3d> places = lamp_places();
  std::vector<double> light;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      double sum = 0;
      for (const double gx : {-0.5 / std::sqrt(3), 0.5 / std::sqrt(3)})
        for (const double gy : {-0.5 / std::sqrt(3), 0.5 / std::sqrt(3)}) {
          const Vec3d point{(x + 0.5 + gx) / kSize * 4 - 2, 0, (y + 0.5 + gy) / kSize * 4 - 2};
          for (std::size_t i = 0; i < places.size(); ++i)
            sum += 0.5 / std::numbers::pi * double{strength(i)} * lamp(places[i], point) / 4;
        }
      light.push_back(sum);
    }
  return light;
}

/// The mean over the picture of light found over true light is 1 within noise, which must be small.
void expect_light(const Scene& scene, const std::vector<double>& want) {
  const Picture p = run(scene).picture;
  const Column<float>&got = p.find("G")->values, &variance = p.find("Variance.G")->values;
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    mean += double{got[i]} / want[i] / static_cast<double>(want.size());
    square += double{variance[i]} / (want[i] * want[i]);
  }
  const double deviation = std::sqrt(square) / static_cast<double>(want.size());
  EXPECT_LT(deviation, 0.0015);
  EXPECT_NEAR(mean, 1, 3 * deviation + 1e-4);
}

TEST(ManyLamps, TrianglesGiveTheLightOfLambertsFormula) {
  const auto quad = [](const Vec3d& p) {
    return std::vector<Vec3d>{p, p + Vec3d{kEdge, 0, 0}, p + Vec3d{kEdge, 0, kEdge}, p + Vec3d{0, 0, kEdge}};
  };
  const std::vector<double> want = floor_light([&](const Vec3d& p, const Vec3d& point) {
    return lambert(quad(p), point, {0, 1, 0});
  });
  // All lamps in one mesh of 2048 triangles.
  auto mesh = std::make_shared<TriangleMesh>();
  Scene scene = floor_under([&](Scene&, const Vec3d& p, std::uint32_t material) {
    const auto first = static_cast<std::uint32_t>(mesh->positions.size());
    for (const Vec3d& corner : quad(p)) mesh->positions.push_back(Vec3f(corner));
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh->indices.push_back(first + i);
    for (int i = 0; i < 2; ++i) mesh->material_slots.push_back(static_cast<std::uint16_t>(material));
  });
  MeshShape shape;
  shape.mesh = mesh;
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) shape.slot_materials.push_back(i);
  add_object(scene, shape, kNoId);
  expect_light(scene, want);
  // The same as rectangles, which are sampled in lanes.
  expect_light(floor_under([&](Scene& s, const Vec3d& p, std::uint32_t material) {
                 add_object(s, PolygonShape{quad(p)}, material);
               }),
               want);
}

TEST(ManyLamps, SpheresGiveTheLightOfTheirCaps) {
  expect_light(floor_under([&](Scene& s, const Vec3d& p, std::uint32_t material) {
                 add_object(s, SphereShape{p, kRadius}, material);
               }),
               floor_light([](const Vec3d& p, const Vec3d& point) {
                 const Vec3d to = p - point;
                 return std::numbers::pi * kRadius * kRadius * to.y / std::pow(dot(to, to), 1.5);
               }));
}

// Each lamp is chosen as often as the tree says, for many points together, and the probabilities sum to 1: on
// the floor, between the lamps, above them, and right below one.
TEST(ManyLamps, AreChosenWithTheirProbabilities) {
  std::vector<Emitter> emitters;
  for (const Vec3d& p : lamp_places()) {
    const Vec3f a(p + Vec3d{0, p.x * 0.1, 0}), u{static_cast<float>(kEdge), 0, 0};
    const Vec3f v{0, 0, static_cast<float>(kEdge)};
    const Color radiance = Color{1, 1, 1} * strength(emitters.size() / 2);
    emitters.emplace_back(TriangleEmitter{a, a + u, a + u + v, radiance, true});
    emitters.emplace_back(TriangleEmitter{a, a + u + v, a + v, radiance, true});
  }
  const LightSet lights(emitters);
  const Vec3f lamp = std::get<TriangleEmitter>(emitters[1000]).a;
  const LightPoint points[] = {{{0.5f, 0, 0.5f}, {0, 1, 0}, true},
                               {{3, 2.4f, -2}, {0, 1, 0}, true},
                               {{-4, 2.5f, 1}, {}, false},
                               {{1, 5, 1}, {0, -1, 0}, false},
                               {lamp - Vec3f{0, 0.01f, 0}, {0, 1, 0}, true},
                               {{5, 1, 5}, {1, 0, 0}, true}};
  constexpr int kRounds = 3000, kTogether = 64;
  Random random(2);
  for (const LightPoint& point : points) {
    std::vector<double> expected(emitters.size()), counted(emitters.size());
    double sum = 0;
    for (std::uint32_t i = 0; i < emitters.size(); ++i) {
      const double probability = lights.probability(point, i);
      sum += probability, expected[i] = probability * kRounds * kTogether;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    const std::vector<LightPoint> same(kTogether, point);
    for (int round = 0; round < kRounds; ++round) {
      const double u[kTogether] = {};
      SquareSample s[kTogether];
      LightSet::Choice chosen[kTogether];
      for (SquareSample& x : s) x = random.square();
      lights.choose(render_code(default_isa()).lights.choose, same, u, s, chosen);
      for (const LightSet::Choice& c : chosen) {
        ASSERT_EQ(c.probability, lights.probability(point, c.emitter));
        ++counted[c.emitter];
      }
    }
    EXPECT_LT(chi_squared(expected, counted), 4);
  }
}

}  // namespace
}  // namespace oktett::light_lamps_test
