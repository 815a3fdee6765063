/// \file Photons in media and in nested solids.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "render/bsdf/optics.h"
#include "render/medium/density_grid.h"
#include "render/photon/trace_photons.h"
#include "tests/render/photon_support.h"

namespace oktett::photon_media_test {
namespace {

using namespace test;

Medium medium(const Color& absorption, const Color& scattering) {
  Medium m;
  m.absorption = absorption, m.scattering = scattering;
  return m;
}

/// Gives a material an interior.
Material filled(Scene& scene, Material m, const Medium& interior, std::int32_t priority = kNoPriority) {
  scene.media.push_back(interior);
  m.interior = static_cast<std::uint32_t>(scene.media.size() - 1);
  m.priority = priority;
  return m;
}

/// A grid of two values along each axis.
std::shared_ptr<const DensityGrid> cube_of(const std::array<float, 8>& densities) {
  Column<float> values;
  for (const float density : densities) values.push_back(density);
  return std::make_shared<DensityGrid>(2, 2, 2, std::move(values));
}

Material invisible() {
  Material m = diffuse({1, 1, 1});
  m.surface = false;
  return m;
}

/// A mirror disk of area pi that sends a parallel beam of irradiance pi, by 45 degrees, to the wall x = 2.
Scene mirror_before_wall() {
  Scene scene = bare_scene(1);
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 1}, add_material(scene, mirror()));
  add_object(scene, BoxShape{{2, -1, -9}, {3, 9, 9}}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {DirectionalLight{{1, -1, 0}, {1, 1, 1}, 0}};
  return scene;
}

/// What arrives at the wall when nothing takes any of it: irradiance pi / sqrt 2 on the disk's area.
const double kMirrored = std::numbers::pi * std::numbers::pi / std::sqrt(2.0);

struct Traced {
  Vec3d stored;  ///< sum of the powers of all photons
  PhotonEnergy energy;
};

Traced traced(const Scene& scene, std::uint32_t photons = 100000) {
  const PhotonScene ready(scene);
  const TracedPhotons found = trace_photons(ready.context, ready.source, plan_of(photons), 0);
  Traced sum;
  for (const Photon& p : found.photons) sum.stored = sum.stored + Vec3d(p.power);
  sum.energy = found.energy;
  const PhotonEnergy& e = sum.energy;
  EXPECT_NEAR(e.stored + e.absorbed + e.escaped + e.media + e.cut, e.emitted, 2e-3 * e.emitted);
  return sum;
}

void expect_power(const Vec3d& got, const Vec3d& want, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], tolerance * want[c] + 1e-12) << "channel " << c;
}

Vec3d mirrored_times(const Vec3d& depth) {
  return Vec3d{std::exp(-depth.x), std::exp(-depth.y), std::exp(-depth.z)} * kMirrored;
}

TEST(PhotonMedia, WithoutMediaAMirrorSendsOnWhatItGets) {
  const Traced clear = traced(mirror_before_wall());
  expect_power(clear.stored, mirrored_times({0, 0, 0}), 0.01);
  EXPECT_EQ(clear.energy.media, 0);
}

// A layer from y = 0.25 to y = 0.5 is passed twice, at 45 degrees.
TEST(PhotonMedia, LayersTakeWhatBeersLawSays) {
  Scene scene = mirror_before_wall();
  const Medium smoke = medium({0.5f, 0.2f, 0}, {1, 0.3f, 0});
  add_object(scene, BoxShape{{-9, 0.25, -9}, {9, 0.5, 9}},
             add_material(scene, filled(scene, invisible(), smoke)));
  const double way = 0.5 * std::sqrt(2.0);
  const Traced got = traced(scene);
  expect_power(got.stored, mirrored_times(Vec3d{1.5, 0.5, 0} * way), 0.01);
  EXPECT_GT(got.energy.media, 0);
  // As a grid of constant density, by ratio tracking.
  scene.media[0].grid = cube_of({1, 1, 1, 1, 1, 1, 1, 1});
  scene.media[0].grid_place = Affine::translation({-9, 0.25, -9}) * Affine::scaling({18, 0.25, 18});
  expect_power(traced(scene, 400000).stored, mirrored_times(Vec3d{1.5, 0.5, 0} * way), 0.012);
}

// A half-space of fog has no bounds: light enters it before its photon starts.
TEST(PhotonMedia, LightFromFarAwayEntersEndlessLayers) {
  Scene scene = mirror_before_wall();
  const std::uint32_t fog = add_material(scene, filled(scene, invisible(), medium({0.1f, 0, 0.2f}, {})));
  add_object(scene, PlaneShape{{0, 1, 0}, 6}, fog);
  // The way from the disk to the wall is 2 sqrt 2 in the mean over the disk, but the
  // mean of the exponential is a little more: by (s sqrt 2)^2 / 8 of it, to second order.
  const double root = std::sqrt(2.0);
  Vec3d want = mirrored_times(Vec3d{0.1, 0, 0.2} * (8 * root));
  want.x *= 1 + 0.01 * 2 / 8, want.z *= 1 + 0.04 * 2 / 8;
  // Only the way up depends on the place on the disk: down it is 6 sqrt 2 everywhere.
  expect_power(traced(scene).stored, want, 0.012);
  // With fog everywhere, nothing comes from infinitely far away but what it lets pass.
  scene = mirror_before_wall();
  scene.media.push_back(medium({0.1f, 0, 0}, {0, 0, 0.1f}));
  scene.medium = 0;
  expect_power(traced(scene).stored, {0, kMirrored, 0}, 0.01);
}

TEST(PhotonMedia, LightFromFarAwayPassesHoles) {
  Scene scene = mirror_before_wall();
  Material net = diffuse({1, 1, 1});
  net.opacity = 0.25f;
  add_object(scene, PlaneShape{{0, 1, 0}, 10}, add_material(scene, net));
  expect_power(traced(scene).stored, mirrored_times({0, 0, 0}) * 0.75, 0.01);
  scene.materials.back().opacity = 1;
  expect_power(traced(scene).stored, {0, 0, 0}, 0);
}

// A lamp in coloured glass, and one in a bubble within it.
TEST(PhotonMedia, PhotonsStartInTheSolidsAroundTheirLamp) {
  Scene scene = bare_scene(1);
  const Material clear = filled(scene, glass(1), medium({0.3f, 0.1f, 0}, {}), 1);
  add_object(scene, SphereShape{{0, 0, 0}, 2}, add_material(scene, clear));
  add_object(scene, SphereShape{{0, 0, 0}, 5}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {PointLight{{0, 0, 0}, {1, 1, 1}, true}};
  // Intensity pi in all directions.
  const auto want = [](double way) {
    return Vec3d{std::exp(-0.3 * way), std::exp(-0.1 * way), 1} * (4 * std::numbers::pi * std::numbers::pi);
  };
  expect_power(traced(scene).stored, want(2), 1e-3);
  const Material air = filled(scene, glass(1), medium({}, {}), 2);
  add_object(scene, SphereShape{{0, 0, 0}, 0.5}, add_material(scene, air));
  expect_power(traced(scene).stored, want(1.5), 1e-3);
  // A glowing ball has no middle to start from; each place of it lies in the glass.
  scene.lights.clear();
  add_object(scene, SphereShape{{0, 0, 0}, 0.001},
             add_material(scene, glowing({1e6f / 4, 1e6f / 4, 1e6f / 4})));
  expect_power(traced(scene).stored, want(1.5) * 0.25, 2e-3);
  // A lamp that reaches out of the bubble: photons start in different solids.
  scene.objects.pop_back();
  add_object(scene, TriangleShape{{Vec3d{-1, 0, 0.01}, Vec3d{1, 0, 0.01}, Vec3d{0, 0, -0.01}}},
             add_material(scene, glowing({1, 1, 1})));
  const PhotonScene ready(scene);
  std::vector<PhotonStart> starts;
  for (std::uint32_t i = 0; i < 200; ++i)
    if (const auto s = ready.source.emit(0.5, {(i + 0.5) / 200, 0.37}, {0.2, 0.3})) starts.push_back(*s);
  const std::vector<DielectricStack> around = start_dielectrics(ready.context, starts);
  ASSERT_EQ(around.size(), starts.size());
  std::size_t in_bubble = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const bool inside = length(starts[i].ray.origin) < 0.5f;
    in_bubble += inside;
    EXPECT_EQ(around[i].size(), inside ? 2u : 1u) << i;
  }
  EXPECT_GT(in_bubble, 20u);
  EXPECT_LT(in_bubble, starts.size() - 20);
}

/// A disk of radius 0.5 in a block of glass, which lies in a liquid, under parallel light at 45 degrees.
Scene disk_in_glass_in_liquid() {
  Scene scene = bare_scene(1);
  const auto of = [&](float ior, std::int32_t priority) {
    return add_material(scene, filled(scene, glass(ior), medium({}, {}), priority));
  };
  add_object(scene, BoxShape{{-3, -1, -3}, {3, 1, 3}}, of(1.33f, 1));
  // The lower face of a denser solid lies within the glass, which hides it.
  add_object(scene, BoxShape{{-2.5, -1, -2.5}, {2.5, 0.5, 2.5}}, of(1.7f, 3));
  add_object(scene, BoxShape{{-2, 0.2, -2}, {2, 0.4, 2}}, of(2.4f, 2));
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.5}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {DirectionalLight{{1, -1, 0}, {1, 1, 1}, 0}};
  return scene;
}

// Whatever lies in between, the sine of the angle in the glass is that of 45 degrees over its index. Power
// is divided by the square of the index, and what both surfaces reflect is lost.
TEST(PhotonMedia, NestedSolidsBendPhotonsAsSnellSays) {
  const PhotonScene ready(disk_in_glass_in_liquid());
  const TracedPhotons found = trace_photons(ready.context, ready.source, plan_of(200000, 2), 0);
  ASSERT_GT(found.photons.size(), 1000u);
  Vec3d sum;
  for (const Photon& p : found.photons) {
    sum = sum + Vec3d(p.power);
    EXPECT_NEAR(unpack_direction(p.direction).x, std::sqrt(0.5) / 1.7, 2e-4);
    EXPECT_LT(unpack_direction(p.direction).y, 0);
  }
  const double liquid = std::sqrt(1 - 0.5 / (1.33 * 1.33));
  const double passed = (1 - fresnel(std::sqrt(0.5), 1.33)) * (1 - fresnel(liquid, 1.7 / 1.33));
  const double want = std::numbers::pi * std::sqrt(0.5) * std::numbers::pi * 0.25 * passed / (1.7 * 1.7);
  expect_power(sum, {want, want, want}, 0.02);
}

TEST(PhotonMedia, CausticsOfColouredGlass) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.materials[1] = filled(scene, scene.materials[1], medium({0.2f, 1.2f, 3}, {}));
  expect_same_light(scene, many_photons(), 0.01);
}

// A ball of glass that reaches out of a liquid in a block of other glass: all three bend and take light.
TEST(PhotonMedia, CausticsOfGlassInALiquid) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.integrator.depth = 8;
  const auto of = [&](float ior, float absorption, std::int32_t priority) {
    return filled(scene, glass(ior), medium({0, absorption, 0}, {}), priority);
  };
  scene.materials[1] = of(1.7f, 0.3f, 3);
  add_object(scene, BoxShape{{-1.3, -0.5, -0.8}, {0.2, 0.8, 0.8}}, add_material(scene, of(1.33f, 0.5f, 1)));
  add_object(scene, BoxShape{{-1.4, -0.5, -0.9}, {-1.2, 1, 0.9}}, add_material(scene, of(1.5f, 1, 2)));
  expect_same_light(scene, many_photons(), 0.01);
}

// Rough glass in a liquid of its own density bends no light: photons know, though it is rough elsewhere.
TEST(PhotonMedia, RoughGlassIsSmoothInALiquidOfItsDensity) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.integrator.depth = 8;
  // The only thing that reflects light without the glass is small and elsewhere.
  scene.objects[2].shape = SphereShape{{1.2, 0.2, -0.5}, 0.2};
  const auto rough = [&](float absorption, std::int32_t priority) {
    Material m = diffuse({1, 1, 1});
    m.principled.emplace();
    m.principled->parameters.transmission = 1, m.principled->parameters.roughness = 0.6f;
    m.principled->parameters.ior = 1.5f;
    return filled(scene, m, medium({0, absorption, 0}, {}), priority);
  };
  scene.materials[1] = rough(1, 2);
  add_object(scene, BoxShape{{-1.3, 0.1, -0.8}, {0.3, 1.4, 0.8}}, add_material(scene, rough(0.2f, 1)));
  expect_same_light(scene, many_photons(), 0.01);
}

TEST(PhotonMedia, CausticsThroughSmoke) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.media.push_back(medium({0.05f, 0.05f, 0.05f}, {0.15f, 0.15f, 0.15f}));
  scene.medium = 0;
  expect_same_light(scene, many_photons(), 0.01);
  // A cloud between glass and floor, which also the camera looks through.
  scene.media[0] = {};
  Medium cloud = medium({0.3f, 0.3f, 0.3f}, {0.7f, 0.7f, 0.7f});
  cloud.grid = cube_of({0, 1, 2, 0.5f, 0, 2, 1, 0});
  cloud.grid_place = Affine::translation({-1.5, 0.05, -1}) * Affine::scaling({3, 0.5, 3});
  const std::uint32_t boundary = add_material(scene, filled(scene, invisible(), cloud));
  add_object(scene, BoxShape{{-1.5, 0.05, -1}, {1.5, 0.55, 2}}, boundary);
  expect_same_light(scene, many_photons(), 0.01);
}

}  // namespace
}  // namespace oktett::photon_media_test
