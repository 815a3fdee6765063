/// \file Pictures of media against closed forms and quadrature.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/render/medium_support.h"

namespace oktett::medium_transport_test {
namespace {

using namespace test;

Medium medium(const Color& absorption, const Color& scattering, float anisotropy = 0) {
  Medium m;
  m.absorption = absorption, m.scattering = scattering, m.anisotropy = anisotropy;
  return m;
}

/// A wall behind everything that glows with radiance 1.
void add_wall(Scene& scene) {
  add_object(scene, PlaneShape{{0, 0, 1}, -10}, add_material(scene, glowing({1, 1, 1})));
}

Mean seen(const Scene& scene) { return mean_of(run(scene).picture); }

/// Solids along the view axis with the length of the axis inside of them.
struct Solid {
  Shape shape;
  double length;
  bool is_turned = false;  ///< about the x axis by 90 degrees
};

std::vector<Solid> solids() {
  const auto box = [](double z, double half) {
    Object o;
    o.shape = BoxShape{{-half, -half, z - half}, {half, half, z + half}};
    return o;
  };
  const CsgShape dice{CsgOp::subtract,
                      std::make_shared<const std::vector<Object>>(std::vector{box(0, 1), box(0.5, 0.25)})};
  const auto mesh = sphere_mesh(16);
  return {{BoxShape{{-1, -1, -1}, {1, 1, 0.5}}, 1.5},
          {SphereShape{{0, 0, 1}, 0.75}, 1.5},
          {MeshShape{mesh, {}, true, TriangleTest::watertight, true}, 2},
          {ExactShape{TorusShape{0.7, 0.3}}, 1.2, true},
          {dice, 1.5}};
}

// Chromatic absorption in solids of all kinds: exactly e^(-sigma t), with and without scattering elsewhere.
TEST(MediumTransport, AbsorptionFollowsBeersLawInSolidsOfAllKinds) {
  for (const Solid& solid : solids()) {
    Scene scene = medium_scene(1, 8);
    add_wall(scene);
    const std::uint32_t smoke = add_interior(scene, medium({0.5f, 1, 0}, {0, 0, 0}));
    const Affine turn = solid.is_turned ? Affine::rotation({90, 0, 0}) : Affine{};
    if (const auto* csg = std::get_if<CsgShape>(&solid.shape)) {
      auto operands = *csg->operands;
      for (Object& o : operands) o.material = smoke;
      add_object(scene, CsgShape{csg->op, std::make_shared<const std::vector<Object>>(operands)}, smoke,
                 turn);
    } else {
      add_object(scene, solid.shape, smoke, turn);
    }
    expect_mean(seen(scene), exp_of(Vec3d{-0.5, -1, 0} * solid.length), 1e-4);
  }
}

// Of two CSG operands with different media the one that a ray entered by is left again by the other's face.
TEST(MediumTransport, ACombinationIsOneSolidWhateverItsFacesAreMadeOf) {
  Scene scene = medium_scene(1, 8);
  add_wall(scene);
  const std::uint32_t grey = add_interior(scene, medium({1, 1, 1}, {0, 0, 0}));
  const std::uint32_t other = add_interior(scene, medium({5, 5, 5}, {0, 0, 0}));
  std::vector<Object> parts(2);
  parts[0].shape = BoxShape{{-1, -1, -1}, {1, 1, 1}}, parts[0].material = grey;
  parts[1].shape = BoxShape{{-2, -2, -2}, {2, 2, 0}}, parts[1].material = other;
  add_object(scene, CsgShape{CsgOp::subtract, std::make_shared<const std::vector<Object>>(parts)}, grey);
  const double want = std::exp(-1.0);
  expect_mean(seen(scene), {want, want, want}, 1e-4);
}

// A fog around everything, with the camera in it, and a box without fog.
TEST(MediumTransport, FogFillsWhatNoSolidFills) {
  Scene scene = medium_scene(1, 8);
  add_wall(scene);
  scene.media.push_back(medium({0.1f, 0.05f, 0}, {0, 0, 0}));
  scene.medium = 0;
  expect_mean(seen(scene), exp_of({-1.5, -0.75, 0}), 1e-4);
  Material nothing = diffuse({1, 1, 1});
  nothing.surface = false;
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, add_material(scene, nothing));
  expect_mean(seen(scene), exp_of({-1.3, -0.65, 0}), 1e-4);
  // Behind endless fog nothing is seen, not even the background.
  scene.objects.clear();
  scene.background = {1, 1, 1};
  expect_mean(seen(scene), {0, 0, 1}, 1e-4);
}

// Glowing gas with absorption: (1 - e^(-sigma t)) emission / sigma.
TEST(MediumTransport, GlowingMediaGiveTheirLight) {
  Scene scene = medium_scene(4, 4);
  Medium flame = medium({0.5f, 1, 0}, {0, 0, 0});
  flame.emission = {3, 2, 1};
  add_object(scene, SphereShape{}, add_interior(scene, flame));
  expect_mean(seen(scene), {3 * (1 - std::exp(-1.0)) / 0.5, 2 * (1 - std::exp(-2.0)), 2}, 1e-4);
}

/// Single scattering along the z axis in the box [-1, 1]^3 of a point light of intensity pi at (0, 3, 0).
Vec3d single_scattering(const Medium& m) {
  constexpr int kSteps = 20000;
  Vec3d sum{0, 0, 0};
  for (int i = 0; i < kSteps; ++i) {
    const double s = 2 * (i + 0.5) / kSteps, z = 1 - s, r = std::sqrt(9 + z * z);
    const double g = static_cast<double>(m.anisotropy), cosine = z / r;  // of (0, 0, -1) and (0, 3, -z) / r
    const double phase = (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
    for (int c = 0; c < 3; ++c) {
      const double scattering = static_cast<double>(m.scattering[c]);
      const double sigma = scattering + static_cast<double>(m.absorption[c]);
      // A third of the way to the light lies in the box.
      sum[c] += scattering * std::exp(-sigma * (s + r / 3)) * phase * std::numbers::pi / (r * r) * 2 / kSteps;
    }
  }
  return sum;
}

TEST(MediumTransport, SingleScatteringMatchesQuadrature) {
  for (const float g : {0.0f, 0.7f, -0.4f}) {
    Scene scene = medium_scene(256, 0);
    const Medium smoke = medium({0.1f, 0.5f, 0}, {0.4f, 1, 2}, g);
    add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, add_interior(scene, smoke));
    PointLight lamp{{0, 3, 0}, {1, 1, 1}, true};
    scene.lights = {lamp};
    expect_mean(seen(scene), single_scattering(smoke), 0.004);
    // The same light from a small ball, which phase function and light sampling find together.
    scene.lights.clear();
    const float radiance = 1 / (0.05f * 0.05f);
    add_object(scene, SphereShape{{0, 3, 0}, 0.05},
               add_material(scene, glowing({radiance, radiance, radiance})));
    const Mean ball = seen(scene);
    const Vec3d want = single_scattering(smoke);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ball.value[c], want[c], 3 * ball.error[c] + 1e-3 * want[c]);
  }
}

// A large lamp near the smoke, sampled, against the same lamp as an exact box, which is not: the light that
// lamps and phase functions find agrees.
TEST(MediumTransport, SampledAndUnsampledLampsAgree) {
  Scene scene = medium_scene(512, 3);
  const std::uint32_t smoke = add_interior(scene, medium({0.2f, 0.2f, 0.2f}, {1, 2, 0.5f}, 0.5f));
  add_object(scene, SphereShape{}, smoke);
  const std::uint32_t lamp = add_material(scene, glowing({2, 2, 2}));
  add_object(scene, SphereShape{{0, 2.5, 0}, 1}, lamp);
  const Mean sampled = seen(scene);
  // The same ball as a quadric.
  scene.objects.back().shape = ExactShape{QuadricShape{}};
  scene.objects.back().transform = Affine::translation({0, 2.5, 0});
  const Mean unsampled = seen(scene);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(sampled.value[c], unsampled.value[c], 3 * std::hypot(sampled.error[c], unsampled.error[c]));
  EXPECT_LT(sampled.error.y, unsampled.error.y);
}

// Under a uniform sky a medium that only scatters cannot be seen: energy is conserved.
TEST(MediumTransport, AScatteringMediumUnderAUniformSkyIsInvisible) {
  for (const float g : {0.0f, 0.8f, -0.6f}) {
    Scene scene = medium_scene(64, 64);
    scene.background = {1, 1, 1};
    add_object(scene, SphereShape{}, add_interior(scene, medium({0, 0, 0}, {1, 2, 0.1f}, g)));
    // Paths that are scattered more often than 64 times are lost; there are none of these.
    expect_mean(seen(scene), {1, 1, 1}, 0.006);
  }
}

// The shadow of an absorbing box on a floor, by a point, and by a ball that rays can meet.
TEST(MediumTransport, ShadowRaysAreAttenuated) {
  Scene scene = medium_scene(64, 1);
  scene.camera.from = {0, 3, 5};
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.05}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {PointLight{{-3, 4, 0}, {1, 1, 1}, true}};
  const Mean clear = seen(scene);
  // The ray from the origin to (-3, 4, 0) is in the box from y = 1 to y = 2, for 5/4.
  add_object(scene, BoxShape{{-9, 1, -9}, {-0.1, 2, 9}},
             add_interior(scene, medium({0.4f, 0.8f, 0}, {0, 0, 0})));
  expect_mean(seen(scene), clear.value * exp_of({-0.5, -1, 0}), 1e-3);
  scene.lights.clear();
  add_object(scene, SphereShape{{-3, 4, 0}, 0.01}, add_material(scene, glowing({1e4f, 1e4f, 1e4f})));
  const Mean ball = seen(scene);
  for (int c = 0; c < 3; ++c) {
    const double want = clear.value[c] * std::exp(c == 0 ? -0.5 : c == 1 ? -1.0 : 0.0);
    EXPECT_NEAR(ball.value[c], want, 0.003 * want);
  }
}

// Boundaries without surface and without medium change nothing.
TEST(MediumTransport, EmptyBoundariesAreInvisible) {
  Scene scene = medium_scene(256, 3);
  scene.camera.from = {0, 3, 5};
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.05}, add_material(scene, diffuse({1, 1, 1})));
  add_object(scene, SphereShape{{0, 3, 0}, 0.5}, add_material(scene, glowing({2, 2, 2})));
  const Mean without = seen(scene);
  scene.media.push_back({});
  scene.medium = 0;
  for (const double radius : {0.5, 0.8, 1.2, 6.0})
    add_object(scene, SphereShape{{0, 0.1, 0}, radius}, add_interior(scene, {}));
  const Mean with = seen(scene);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(with.value[c], without.value[c], 0.002 * without.value[c]);
}

// The picture covers what the medium takes away.
TEST(MediumTransport, AlphaIsWhatTheMediumTakes) {
  Scene scene = medium_scene(256, 2);
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 0}}, add_interior(scene, medium({1, 1, 1}, {0, 0, 0})));
  const auto alpha = [&] { return static_cast<double>(value(run(scene).picture, "A", 3, 3)); };
  EXPECT_NEAR(alpha(), 1 - std::exp(-1.0), 1e-5);
  scene.media[0] = medium({0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f});
  EXPECT_NEAR(alpha(), 1 - std::exp(-1.0), 0.01);
  // All channels count alike.
  for (const auto& absorption : {Color{0, 0, 1.5f}, Color{0, 1.5f, 0}, Color{1.5f, 0, 0}}) {
    scene.media[0] = medium(absorption, {0, 0, 0});
    EXPECT_NEAR(alpha(), (1 - std::exp(-1.5)) / 3, 1e-5);
  }
  add_wall(scene);
  EXPECT_NEAR(alpha(), 1, 1e-5);
}

// A medium so dense that nothing passes scatters near its boundary; the picture is finite.
TEST(MediumTransport, VeryDenseMediaAreFinite) {
  Scene scene = medium_scene(16, 64);
  scene.background = {1, 1, 1};
  add_object(scene, SphereShape{}, add_interior(scene, medium({0, 0, 0}, {1e9f, 1e9f, 1e9f})));
  const RenderResult result = run(scene);
  EXPECT_EQ(result.report.bad_samples, 0u);
  const Mean mean = mean_of(result.picture);
  EXPECT_GE(mean.value.x, 0);
  EXPECT_LE(mean.value.x, 1.01);
}

TEST(MediumTransport, PicturesDependNeitherOnThreadsNorTilesNorSets) {
  Scene scene = bare_scene(24);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 5, scene.integrator.depth = 8;
  scene.camera.from = {0, 2, 6};
  scene.lights = {PointLight{{3, 4, 2}, {2, 2, 2}, false}};
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, diffuse({0.7f, 0.6f, 0.5f})));
  add_object(scene, SphereShape{{-1, 0, 0}, 0.9}, add_interior(scene, medium({0.2f, 0, 0}, {2, 3, 4}, 0.6f)));
  Material clear = glass(1.5f);
  scene.media.push_back(medium({2, 0.2f, 0.1f}, {0.1f, 0, 0}));
  clear.interior = 1, clear.priority = 2;
  add_object(scene, SphereShape{{0.6, 0, 0}, 0.8}, add_material(scene, clear));
  add_object(scene, SphereShape{{0, 3, 1}, 0.3}, add_material(scene, glowing({9, 8, 7})));
  scene.media.push_back(medium({0.01f, 0.01f, 0.01f}, {0.01f, 0.02f, 0.01f}));
  scene.medium = 2;
  const Picture first = run(scene, [](RenderOptions& o) { o.threads = 1; }).picture;
  for (const Isa isa : available_isas())
    for (const unsigned threads : {1u, 2u})
      for (const std::uint32_t tile : {32u, 7u}) {
        const Picture other = run(scene, [&](RenderOptions& o) {
                                o.isa = isa, o.threads = threads, o.tile_size = tile;
                              }).picture;
        EXPECT_TRUE(same_bytes(first, other)) << to_string(isa) << threads << tile;
      }
}

}  // namespace
}  // namespace oktett::medium_transport_test
