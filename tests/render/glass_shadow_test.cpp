/// \file Light behind smooth glass: what arrives, against Fresnel's equations, against what the camera sees
/// through the same glass, and against photons.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/math.h"
#include "render/light/environment_picture.h"
#include "tests/render/test_scenes.h"

namespace oktett::glass_shadow_test {
namespace {

using namespace test;

// ---- Fresnel's equations in long double, in the form with both angles (Born 1999, 1.5.2).

long double reflectance(long double angle, long double ior) {
  if (angle == 0) return (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1));
  const long double sine = std::sin(angle) / ior;
  if (!(sine < 1)) return 1;
  const long double behind = std::asin(sine);
  const long double s = std::sin(angle - behind) / std::sin(angle + behind);
  const long double p = std::tan(angle - behind) / std::tan(angle + behind);
  return (s * s + p * p) / 2;
}

/// What two parallel faces let pass, of which the space between leaves the part `left`, by the sum over all
/// ways between them.
long double slab(long double angle, long double ior, long double left = 1) {
  const long double r = reflectance(angle, ior);
  long double sum = 0, way = (1 - r) * (1 - r) * left;
  for (int k = 0; k < 2000; ++k, way *= r * r * left * left) sum += way;
  return sum;
}

/// The mean over the directions up to `most` from the normal, as they light a floor.
long double mean_slab(long double most, long double ior) {
  const int steps = 20000;
  long double sum = 0, all = 0;
  for (int i = 0; i < steps; ++i) {
    const long double angle = most * (i + 0.5L) / steps, part = std::sin(angle) * std::cos(angle);
    sum += part * slab(angle, ior), all += part;
  }
  return sum / all;
}

// ---- Panes over a floor.

enum class Pane { box, mesh, thin };

Material principled_glass(float ior, bool thin) {
  Material m;
  m.color = {1, 1, 1};
  PrincipledParameters& p = m.principled.emplace().parameters;
  p.base_color = {1, 1, 1}, p.ior = ior, p.transmission = 1, p.roughness = 0, p.thin = thin;
  resemble_principled(m);
  return m;
}

void add_pane(Scene& scene, Pane pane, const Material& material) {
  const std::uint32_t glass = add_material(scene, material);
  if (pane == Pane::box) return add_object(scene, BoxShape{{-90, 1, -90}, {90, 1.001, 90}}, glass);
  if (pane == Pane::thin)
    return add_object(scene, MeshShape{parallelogram({-90, 1, 90}, {180, 0, 0}, {0, 0, -180}), {}}, glass);
  const auto low = parallelogram({-90, 1, 90}, {180, 0, 0}, {0, 0, -180});
  auto both = parallelogram({-90, 1.001f, 90}, {180, 0, 0}, {0, 0, -180});
  for (const Vec3f& p : low->positions) both->positions.push_back(p);
  both->uvs.clear(), both->uv_indices.clear();
  for (const std::uint32_t i : {4u, 6u, 5u, 4u, 7u, 6u}) both->indices.push_back(i);
  add_object(scene, MeshShape{both, {}}, glass);
}

/// A camera below the pane that sees a white floor.
Scene floor_scene(IntegratorKind kind, std::uint32_t samples = 1, float albedo = 1) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = kind, scene.integrator.samples = samples, scene.integrator.depth = 0;
  scene.camera.from = {0.3, 0.5, 0}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 0.001;
  add_object(scene, PlaneShape{}, add_material(scene, diffuse(Color{1, 1, 1} * albedo)));
  return scene;
}

double seen(const Scene& scene) { return static_cast<double>(value(run(scene).picture, "G", 0, 0)); }

/// What a pane leaves of the light at the middle of the floor.
double part(const Scene& scene, Pane pane, const Material& material) {
  Scene with = scene;
  add_pane(with, pane, material);
  return seen(with) / seen(scene);
}

std::vector<Light> lights_at(double angle) {
  const Vec3d to{-std::sin(angle), std::cos(angle), 0};
  SpotLight spot{.position = to * 20};
  spot.direction = -to;
  return {PointLight{to * 20, {1, 1, 1}, false}, PointLight{to * 20, {1, 1, 1}, true}, spot,
          DirectionalLight{-to, {1, 1, 1}}};
}

constexpr IntegratorKind kBothKinds[] = {IntegratorKind::whitted, IntegratorKind::path};

TEST(GlassShadow, APaneTakesFromPointsSpotsAndParallelLightWhatFresnelsEquationsSay) {
  for (const IntegratorKind kind : kBothKinds)
    for (const float ior : {1.0f, 1.1f, 1.5f, 2.4f, 4.0f, 1 / 1.5f})
      for (const double degrees : {0.0, 30.0, 50.0, 70.0, 85.0})
        for (const Light& light : lights_at(degrees * kDegree)) {
          Scene scene = floor_scene(kind);
          scene.lights = {light};
          const auto want = static_cast<double>(slab(degrees * std::numbers::pi_v<long double> / 180, ior));
          SCOPED_TRACE(testing::Message() << static_cast<int>(kind) << " ior " << ior << " at " << degrees);
          EXPECT_NEAR(part(scene, Pane::box, glass(ior)), want, 2e-5);
          EXPECT_NEAR(part(scene, Pane::mesh, principled_glass(ior, false)), want, 2e-5);
          if (kind == IntegratorKind::path && ior > 1) {
            EXPECT_NEAR(part(scene, Pane::thin, principled_glass(ior, true)), want, 2e-5);
          }
          // A single sheet of what fills solids is one face.
          const auto face =
              static_cast<double>(1 - reflectance(degrees * std::numbers::pi_v<long double> / 180, ior));
          EXPECT_NEAR(part(scene, Pane::thin, glass(ior)), face, 2e-5);
        }
}

/// Of films that are so thick that no channel has a fixed phase: the parts that both interfaces reflect add
/// up.
TEST(GlassShadow, APaneWithThickFilmsTakesWhatTheirInterfacesReflect) {
  Material m = principled_glass(1.5f, false);
  PrincipledParameters& p = m.principled->parameters;
  p.iridescence_ior = 2, p.iridescence_thickness = 20000;
  const auto head_on = [](double n) { return (n - 1) * (n - 1) / ((n + 1) * (n + 1)); };
  const double above = head_on(2), below = head_on(1.5 / 2), bare = head_on(1.5);
  const double film = (above + below - 2 * above * below) / (1 - above * below);
  for (const float weight : {0.0f, 0.5f, 1.0f}) {
    p.iridescence = weight;
    const double r = bare + static_cast<double>(weight) * (film - bare);
    Scene scene = floor_scene(IntegratorKind::path);
    scene.lights = {DirectionalLight{{0, -1, 0}, {1, 1, 1}}};
    EXPECT_NEAR(part(scene, Pane::box, m), (1 - r) / (1 + r), 2e-5) << weight;
  }
}

// In Whitted's model all points of glowing surfaces are asked straight, in path tracing their light is bent.
TEST(GlassShadow, APaneTakesFromGlowingSurfacesWhatFresnelsEquationsSay) {
  for (const float ior : {1.5f, 2.4f}) {
    Scene scene = floor_scene(IntegratorKind::whitted);
    scene.integrator.light_samples = 64;
    add_object(scene, SphereShape{{-10, 10, 0}, 0.05}, add_material(scene, glowing({1, 1, 1})));
    EXPECT_NEAR(part(scene, Pane::box, glass(ior)),
                static_cast<double>(slab(std::numbers::pi_v<long double> / 4, ior)), 2e-3);
  }
}

/// Lights of uniform radiance up to an angle from the normal, and that angle in degrees.
std::vector<std::pair<Scene, double>> wide_lights() {
  std::vector<std::pair<Scene, double>> scenes;
  // The floor sends some light back to the pane, which returns a part of it.
  Scene bare = floor_scene(IntegratorKind::path, 16384, 0.02f);
  bare.integrator.depth = 40;
  Scene sun = bare;
  sun.lights = {DirectionalLight{{0, -1, 0}, {1, 1, 1}, 60}};
  scenes.emplace_back(sun, 30.0);
  Scene lamp = bare;
  const double radius = 1000 * std::tan(40 * kDegree);
  add_object(lamp, DiskShape{{0, 1000, 0}, {0, -1, 0}, radius}, add_material(lamp, glowing({1, 1, 1})));
  scenes.emplace_back(lamp, 40.0);
  Scene mesh = bare;
  add_object(mesh, MeshShape{parallelogram({-1e5f, 50, -1e5f}, {2e5f, 0, 0}, {0, 0, 2e5f}), {}},
             add_material(mesh, glowing({1, 1, 1})));
  scenes.emplace_back(mesh, 90.0);
  Scene sky = bare;
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = 2, picture->height = 2;
  picture->pixels.assign(4, {1, 1, 1});
  EnvironmentLight environment;
  environment.picture = picture;
  sky.lights = {environment};
  scenes.emplace_back(sky, 90.0);
  return scenes;
}

TEST(GlassShadow, APaneTakesFromWideLightsTheMeanOverTheirDirections) {
  for (const auto& [scene, degrees] : wide_lights())
    for (const float ior : {1.5f, 2.4f}) {
      const auto want = static_cast<double>(mean_slab(degrees * std::numbers::pi_v<long double> / 180, ior));
      EXPECT_NEAR(part(scene, Pane::box, glass(ior)), want, 0.015) << degrees << " " << ior;
      EXPECT_NEAR(part(scene, Pane::thin, principled_glass(ior, true)), want, 0.015) << degrees << " " << ior;
    }
}

// Behind a pane in a space that is equally bright everywhere, nothing shows that there is a pane.
TEST(GlassShadow, AFurnaceBehindGlassIsAFurnace) {
  Scene scene = floor_scene(IntegratorKind::path, 4096, 1);
  scene.objects.clear();
  scene.integrator.depth = 60;
  add_object(scene, SphereShape{{0, -0.5, 0}, 0.5}, 0);
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = 2, picture->height = 2;
  picture->pixels.assign(4, {1, 1, 1});
  EnvironmentLight environment;
  environment.picture = picture;
  scene.lights = {environment};
  for (const Pane pane : {Pane::box, Pane::mesh}) EXPECT_NEAR(part(scene, pane, glass(1.5f)), 1, 0.01);
  EXPECT_NEAR(part(scene, Pane::thin, principled_glass(2.4f, true)), 1, 0.01);
}

/// What the camera sees of a bright board through a pane, head-on.
double through(const Material& material, Pane pane, IntegratorKind kind) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = kind, scene.integrator.depth = 30, scene.integrator.samples = 16384;
  scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 1, 0}, scene.camera.up = {0, 0, 1};
  scene.camera.fov = 0.001;
  add_object(scene, PlaneShape{{0, -1, 0}, -5}, add_material(scene, glowing({1, 1, 1})));
  add_pane(scene, pane, material);
  return seen(scene);
}

TEST(GlassShadow, LightArrivesAsTheCameraSeesItThroughTheSameGlass) {
  std::vector<std::pair<Material, Pane>> panes;
  for (const bool thin : {false, true}) {
    Material m = principled_glass(1.8f, thin);
    PrincipledParameters& p = m.principled->parameters;
    m.color = p.base_color = {0.9f, 0.7f, 0.5f};
    panes.emplace_back(m, thin ? Pane::thin : Pane::box);
    if (thin) p.transmission = 0.8f, p.metallic = 0.1f;
    p.coat = 0.7f, p.coat_ior = 1.7f;
    panes.emplace_back(m, thin ? Pane::thin : Pane::mesh);
  }
  Material tinted = glass(1.5f);
  tinted.color = {1, 0.6f, 0}, tinted.transparency = 0.7f;
  panes.emplace_back(tinted, Pane::box);
  for (std::size_t i = 0; i < panes.size(); ++i)
    for (const IntegratorKind kind : kBothKinds) {
      const auto& [material, pane] = panes[i];
      // Whitted's model bends light at sheets, too.
      if (kind == IntegratorKind::whitted && pane == Pane::thin) continue;
      Scene scene = floor_scene(kind);
      scene.lights = {DirectionalLight{{0, -1, 0}, {1, 1, 1}}};
      EXPECT_NEAR(part(scene, pane, material), through(material, pane, kind), 0.006)
          << i << " " << static_cast<int>(kind);
    }
}

// Light that goes to and fro in glass that absorbs loses some each time.
TEST(GlassShadow, GlassThatAbsorbsTakesMoreOfLightThatIsReflectedInside) {
  const float ior = 2.4f, absorption = 300;
  Material m = glass(ior);
  m.interior = 0;
  const auto left = std::exp(-static_cast<long double>(absorption) * 0.001L);
  for (const IntegratorKind kind : kBothKinds)
    for (const Light& light : lights_at(0)) {
      Scene scene = floor_scene(kind);
      scene.lights = {light};
      Medium medium;
      medium.absorption = Color{1, 1, 1} * absorption;
      scene.media = {medium};
      // The thickness of the pane is rounded to float.
      EXPECT_NEAR(part(scene, Pane::box, m), static_cast<double>(slab(0, ior, left)), 2e-4);
    }
}

// Water between two panes, whose faces to the water reflect by the ratio of both indices, at the angle that
// light has there.
TEST(GlassShadow, FacesBetweenSolidsCountByTheRatioOfTheirIndices) {
  Material pane = glass(1.5f), water = glass(1.33f);
  pane.priority = 2, water.priority = 1;
  for (const long double angle : {0.0L, 1.0L, 1.35L}) {
    Scene scene = floor_scene(IntegratorKind::path);
    scene.lights = {lights_at(static_cast<double>(angle)).back()};
    const double without = seen(scene);
    const std::uint32_t glassy = add_material(scene, pane), wet = add_material(scene, water);
    add_object(scene, BoxShape{{-90, 1, -90}, {90, 1.1, 90}}, glassy);
    add_object(scene, BoxShape{{-90, 1.3, -90}, {90, 1.4, 90}}, glassy);
    add_object(scene, BoxShape{{-89, 1.05, -89}, {89, 1.35, 89}}, wet);
    const long double outer = reflectance(angle, 1.5L);
    const long double inner = reflectance(std::asin(std::sin(angle) / 1.5L), 1.33L / 1.5L);
    const long double twice = (1 - outer) * (1 - inner);
    const double got = seen(scene) / without;
    // Between unlike faces, and from pane to pane, reflections of higher order may be left out.
    EXPECT_GT(got, static_cast<double>(twice * twice) - 1e-5);
    EXPECT_LT(got, static_cast<double>(twice * twice / ((1 - outer * outer) * (1 - outer * inner))) + 1e-3);
  }
}

// Photons bend at each face.
TEST(GlassShadow, PhotonsBringAsMuchThroughAThinPane) {
  Scene scene = floor_scene(IntegratorKind::path, 16);
  scene.integrator.depth = 8;
  scene.camera.from = {0.3, 0.5, 0}, scene.camera.at = {0, 0, 0};
  scene.objects.clear();
  // The floor sends little light back to the pane.
  const std::uint32_t grey = add_material(scene, diffuse(Color{1, 1, 1} * 0.02f));
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 2}, grey);
  scene.lights = {PointLight{{0, 6, 0}, {10, 10, 10}, true}};
  const std::uint32_t pane = add_material(scene, glass(2.4f));
  const double without = seen(scene);
  add_object(scene, BoxShape{{-2, 1, -2}, {2, 1.001, 2}}, pane);
  const double straight = seen(scene) / without;
  scene.integrator.caustics.photons = 400000, scene.integrator.caustics.passes = 16;
  scene.integrator.caustics.radius = 0.15;
  const double bent = seen(scene) / without;
  EXPECT_NEAR(straight, static_cast<double>(slab(0, 2.4L)), 0.005);
  EXPECT_NEAR(bent, straight, 0.015);
}

}  // namespace
}  // namespace oktett::glass_shadow_test
