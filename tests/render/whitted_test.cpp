#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/render/test_scenes.h"

namespace oktett::whitted_test {
namespace {

using namespace test;

/// Phong's model in double, straight from the textbook.
double textbook_phong(const Vec3d& n, const Vec3d& l, const Vec3d& v, double diffuse, double specular,
                      double exponent) {
  const double cosine = dot(n, l);
  if (cosine <= 0) return 0;
  const Vec3d r = n * (2 * cosine) - l;
  return diffuse * cosine + specular * std::pow(std::max(0.0, dot(r, v)), exponent);
}

Material shiny() {
  Material m;
  m.color = {0.5f, 0.25f, 1};
  m.specular_color = {1, 1, 1};
  m.emission = {0.01f, 0.02f, 0.03f};
  m.ambient = 0.2f, m.diffuse = 0.7f, m.specular = 0.4f, m.phong = 20;
  return m;
}

/// Compares each covered pixel with the textbook; `normal` gives the outward normal at a point.
template <class Normal>
void expect_phong(const Scene& scene, const Vec3d& light, bool directional, const Normal& normal) {
  const Material m = scene.materials[0];
  const Picture p = run(scene).picture;
  int covered = 0;
  for (std::uint32_t y = 0; y < p.height; ++y)
    for (std::uint32_t x = 0; x < p.width; ++x) {
      if (value(p, "A", x, y) == 0) continue;
      ++covered;
      const Vec3d at(position(p, x, y)), n = normal(at);
      const Vec3d l = directional ? normalize(-light) : normalize(light - at);
      const Vec3d v = normalize(scene.camera.from - at);
      if (std::abs(dot(n, l)) < 1e-3 || dot(n, v) < 2e-3) continue;
      for (int k = 0; k < 3; ++k) {
        const double c = m.color[k];
        const double want = m.emission[k] + c * m.ambient * scene.ambient_light[k] +
                            textbook_phong(n, l, v, c * m.diffuse, m.specular, m.phong);
        ASSERT_NEAR(color(p, x, y)[k], want, 2e-5) << x << ',' << y;
      }
    }
  EXPECT_GT(covered, 50);
}

TEST(Whitted, SphereFollowsPhong) {
  Scene scene = bare_scene(48);
  scene.ambient_light = {0.5f, 1, 0.25f};
  add_object(scene, SphereShape{{0.2, -0.1, 0}, 1}, add_material(scene, shiny()));
  const auto normal = [](const Vec3d& p) { return normalize(p - Vec3d{0.2, -0.1, 0}); };
  scene.lights = {PointLight{{4, 5, 6}, {1, 1, 1}, false}};
  expect_phong(scene, {4, 5, 6}, false, normal);
  scene.lights = {DirectionalLight{{-1, -2, -0.5}, {1, 1, 1}}};
  expect_phong(scene, {-1, -2, -0.5}, true, normal);
}

// A mirror before the camera shows a ball behind it at the last bounce. If the ball is a mirror only, it is
// dark and not shaded. All other balls show what they are.
TEST(Whitted, TheLastBounceShowsAllButMirrors) {
  const auto mirrored = [](const Material& ball) {
    Scene scene = bare_scene(16);
    scene.camera.from = {0, 0, 4}, scene.camera.at = {0, 0, 0};
    scene.integrator.depth = 1;
    scene.ambient_light = {1, 1, 1};
    scene.lights = {PointLight{{0, 0, 2}, {1, 1, 1}, false}};
    add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, mirror()));
    add_object(scene, SphereShape{{0, 0, 20}, 12}, add_material(scene, ball));
    return run(scene);
  };
  const auto green = [&](const auto& change) {
    Material ball = mirror();
    ball.color = {0.5f, 0.5f, 0.5f};
    change(ball);
    const RenderResult result = mirrored(ball);
    EXPECT_EQ(result.report.bounces[1].rays, 256u);
    EXPECT_EQ(result.report.bounces[1].shaded, 256u);
    return value(result.picture, "G", 8, 8);
  };
  const RenderResult dark = mirrored(mirror());
  EXPECT_EQ(value(dark.picture, "G", 8, 8), 0);
  EXPECT_EQ(dark.report.bounces[1].rays, 256u);
  EXPECT_EQ(dark.report.bounces[1].shaded, 0u);
  EXPECT_EQ(green([](Material& m) { m.emission = {0, 0.25f, 0}; }), 0.25f);
  EXPECT_EQ(green([](Material& m) { m.ambient = 0.25f; }), 0.125f);
  EXPECT_GT(green([](Material& m) { m.diffuse = 0.25f; }), 0.05f);
  EXPECT_GT(green([](Material& m) { m.specular = 1, m.phong = 1, m.specular_color = {1, 1, 1}; }), 0.05f);
}

TEST(Whitted, PlaneAndTriangleFollowPhong) {
  Scene scene = bare_scene(32);
  scene.camera.from = {0, 2, 4};
  scene.lights = {PointLight{{1, 3, 1}, {1, 1, 1}, false}};
  const std::uint32_t material = add_material(scene, shiny());
  add_object(scene, PlaneShape{{0, 1, 0}, -0.5}, material);
  expect_phong(scene, {1, 3, 1}, false, [](const Vec3d&) { return Vec3d{0, 1, 0}; });
  scene.objects.clear();
  add_object(scene, TriangleShape{{{-2, 0, 2}, {2, 0, 2}, {0, 0.5, -3}}}, material);
  const Vec3d n = normalize(cross(Vec3d{4, 0, 0}, Vec3d{2, 0.5, -5}));
  expect_phong(scene, {1, 3, 1}, false, [&](const Vec3d&) { return n; });
  // The same triangle seen from its back is lit alike.
  scene.objects.clear();
  add_object(scene, TriangleShape{{{2, 0, 2}, {-2, 0, 2}, {0, 0.5, -3}}}, material);
  expect_phong(scene, {1, 3, 1}, false, [&](const Vec3d&) { return n; });
}

/// Brightness of the centre of a floor seen from above, lit from `light`.
float floor_light(Scene& scene, const Light& light) {
  scene.camera.from = {0, 5, 0}, scene.camera.up = {0, 0, -1};
  scene.lights = {light};
  const Picture p = run(scene).picture;
  return value(p, "R", p.width / 2, p.height / 2);
}

TEST(Whitted, LightsFallOffOnlyIfAsked) {
  Scene scene = bare_scene(15);
  add_object(scene, PlaneShape{}, add_material(scene, diffuse({1, 1, 1})));
  EXPECT_NEAR(floor_light(scene, PointLight{{0, 2, 0}, {0.5f, 0.5f, 0.5f}, false}), 0.5f, 1e-6f);
  EXPECT_NEAR(floor_light(scene, PointLight{{0, 2, 0}, {0.5f, 0.5f, 0.5f}, true}), 0.125f, 1e-6f);
  EXPECT_NEAR(floor_light(scene, PointLight{{0, 20, 0}, {1, 1, 1}, true}), 1 / 400.0f, 1e-6f);
}

TEST(Whitted, ShadowsFallOnlyFromWhatIsBetween) {
  const Light point = PointLight{{2, 2, 0}, {1, 1, 1}, false};
  const Light directional = DirectionalLight{{-1, -1, 0}, {1, 1, 1}};
  const float lit = std::sqrt(0.5f);
  const auto with_ball_at = [&](const Vec3d& at, const Light& light) {
    Scene scene = bare_scene(15);
    const std::uint32_t material = add_material(scene, diffuse({1, 1, 1}));
    add_object(scene, PlaneShape{}, material);
    add_object(scene, SphereShape{at, 0.5}, material);
    return floor_light(scene, light);
  };
  EXPECT_EQ(with_ball_at({1, 1, 0}, point), 0);
  EXPECT_EQ(with_ball_at({1, 1, 0}, directional), 0);
  EXPECT_NEAR(with_ball_at({3, 3, 0}, point), lit, 1e-6f);  // behind the light
  EXPECT_EQ(with_ball_at({3, 3, 0}, directional), 0);
  EXPECT_NEAR(with_ball_at({-1, 1, 0}, point), lit, 1e-6f);
  EXPECT_NEAR(with_ball_at({-1, 1, 0}, directional), lit, 1e-6f);
  EXPECT_NEAR(with_ball_at({1, -1, 0}, point), lit, 1e-6f);  // below the floor
}

TEST(Whitted, LightsAddUp) {
  Scene scene = bare_scene(15);
  add_object(scene, PlaneShape{}, add_material(scene, diffuse({1, 1, 1})));
  scene.camera.from = {0, 5, 0}, scene.camera.up = {0, 0, -1};
  for (int i = 0; i < 5; ++i) scene.lights.push_back(DirectionalLight{{0, -1, 0}, {0.1f, 0.2f, 0.3f}});
  const Picture p = run(scene).picture;
  EXPECT_NEAR(value(p, "G", 7, 7), 1, 1e-6f);
}

TEST(Whitted, MirrorShowsWhatStandsBeforeIt) {
  // A mirror in the plane z = 0 turned by 45 degrees shows what lies along +x, tinted.
  Scene scene = bare_scene(15);
  Material m = mirror();
  m.specular_color = {1, 0.5f, 0.25f};
  m.reflection = 0.5f;
  add_object(scene, PlaneShape{{1, 0, 1}, 0}, add_material(scene, m));
  add_object(scene, SphereShape{{10, 0, 0}, 3}, add_material(scene, glowing({1, 1, 1})));
  scene.background = {0.2f, 0.2f, 0.2f};
  const Picture p = run(scene).picture;
  EXPECT_NEAR(length(color(p, 7, 7) - Color{0.5f, 0.25f, 0.125f}), 0, 1e-6f);
  EXPECT_NEAR(length(color(p, 7, 0) - Color{0.1f, 0.05f, 0.025f}), 0, 1e-6f);
}

// Between two parallel mirrors that also glow, each bounce adds its share of the light.
TEST(Whitted, RecursionEndsAtTheDepth) {
  Scene scene = bare_scene(9);
  Material m = mirror();
  m.reflection = 0.5f;
  m.emission = {1, 1, 1};
  const std::uint32_t material = add_material(scene, m);
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, material);
  add_object(scene, PlaneShape{{0, 0, 1}, 10}, material);
  for (const std::uint32_t depth : {0u, 1u, 2u, 5u, 9u}) {
    scene.integrator.depth = depth;
    const RenderResult r = run(scene);
    EXPECT_NEAR(value(r.picture, "R", 4, 4), 2 - std::pow(0.5f, static_cast<float>(depth)), 1e-6f) << depth;
    EXPECT_EQ(r.report.reflected_rays, 81u * depth);
  }
  // Deeper, the contribution becomes too small to be seen and the tree ends by itself.
  scene.integrator.depth = 64;
  const RenderResult r = run(scene);
  EXPECT_LE(r.report.reflected_rays, 81u * 12);
  EXPECT_NEAR(value(r.picture, "R", 4, 4), 2, 1e-3f);
}

TEST(Whitted, TreesOfRaysThatGainEnergyStayBounded) {
  Scene scene = bare_scene(2);
  Material m = glass(1.5f);
  m.reflection = 1;
  const std::uint32_t material = add_material(scene, m);
  for (int i = 0; i < 10; ++i) add_object(scene, PlaneShape{{0, 0, 1}, -0.3 * i}, material);
  add_object(scene, SphereShape{{0, 0, -10}, 2}, material);
  scene.background = {1, 1, 1};
  scene.integrator.depth = 64;
  const RenderResult r = run(scene);
  EXPECT_LE(r.report.reflected_rays + r.report.refracted_rays, 4u * 256 * 64);
}

}  // namespace
}  // namespace oktett::whitted_test
