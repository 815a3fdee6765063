#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <vector>

#include "render/light/emitter.h"
#include "tests/render/light_checks.h"

namespace oktett::light_irradiance_test {
namespace {

using namespace light_checks;

constexpr Color kWhite{1, 1, 1};

/// The mean of radiance * cosine / pdf over independent samples, and its standard error.
struct Estimate {
  double mean = 0, error = 0;
};

Estimate irradiance(const Emitter& emitter, const LightPoint& point, int samples, std::uint64_t key) {
  Random random(key);
  double sum = 0, squares = 0;
  for (int i = 0; i < samples; ++i) {
    const auto s = sample_emitter(emitter, point, random.square());
    if (!s) continue;
    const double cosine = std::max(0.0f, dot(s->direction, point.normal));
    const double value = (double{s->radiance.x} + s->radiance.y + s->radiance.z) / 3 * cosine / s->pdf;
    sum += value, squares += value * value;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

void expect_irradiance(const Emitter& emitter, const LightPoint& point, double expected, std::uint64_t key) {
  const Estimate e = irradiance(emitter, point, 20000, key);
  EXPECT_NEAR(e.mean, expected, 4 * e.error + 2e-6 * expected);
  EXPECT_LT(e.error, 0.02 * expected);
}

TEST(LightIrradiance, PolygonsGiveTheIrradianceOfLambertsFormula) {
  Random random(5);
  for (int i = 0; i < 60; ++i) {
    // A point below the polygon that looks up, so all of it is above the horizon.
    const auto corner = [&] {
      return Vec3f(Vec3d{random.between(-2, 2), random.between(-2, 2), random.between(0.3, 2)});
    };
    const LightPoint point{Vec3f(Vec3d{random.between(-1, 1), random.between(-1, 1), 0}), {0, 0, 1}};
    const TriangleEmitter t{corner(), corner(), corner(), kWhite, true};
    SCOPED_TRACE(i);
    expect_irradiance(t, point,
                      lambert({Vec3d(t.a), Vec3d(t.b), Vec3d(t.c)}, Vec3d(point.position), {0, 0, 1}), i);
    RectangleEmitter r{corner(), {}, {}, kWhite, true};
    const double turn = random.between(0, 2 * std::numbers::pi);
    r.edge_u = Vec3f(Vec3d{std::cos(turn), std::sin(turn), 0} * random.between(0.01, 3));
    r.edge_v = Vec3f(Vec3d{-std::sin(turn), std::cos(turn), random.between(0, 1)} * random.between(0.01, 3));
    const Vec3d c(r.corner), u(r.edge_u), v(r.edge_v);
    const double expected = lambert({c, c + u, c + u + v, c + v}, Vec3d(point.position), {0, 0, 1});
    expect_irradiance(r, point, expected, i);
  }
}

TEST(LightIrradiance, SpheresAndDisksGiveTheIrradianceOfTheirClosedForms) {
  Random random(6);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    // A sphere above the horizon: pi r^2 / d^2 times the cosine.
    const double height = random.between(0.5, 3), radius = height * std::pow(random(), 3) * 0.999 + 1e-6;
    const double x = random.between(-5, 5), square = x * x + height * height;
    const SphereEmitter sphere{Vec3f(Vec3d{x, 0, height}), static_cast<float>(radius), kWhite};
    const double r = sphere.radius;
    expect_irradiance(sphere, {{}, {0, 0, 1}}, std::numbers::pi * r * r / square * height / std::sqrt(square),
                      i);
    // A disk above its centre: pi R^2 / (R^2 + h^2).
    const double disk_radius = random.between(0.01, 3);
    const DiskEmitter disk{
        {0, 0, static_cast<float>(height)}, {0, 0, -1}, static_cast<float>(disk_radius), kWhite};
    expect_irradiance(
        disk, {{}, {0, 0, 1}},
        std::numbers::pi * disk_radius * disk_radius / (disk_radius * disk_radius + height * height), i);
    // From inside a sphere: pi for any position and normal.
    const SphereEmitter around{{}, 2, kWhite, true};
    expect_irradiance(around, {random.direction() * 1.9f, random.direction()}, std::numbers::pi, i);
  }
}

// Just above a large flat emitter that faces it, a surface receives pi: it sees nothing else.
TEST(LightIrradiance, SurfacesCloseToALargeEmitterReceivePi) {
  const RectangleEmitter floor{{-1000, -1000, 0}, {2000, 0, 0}, {0, 2000, 0}, kWhite};
  for (const float height : {1.0f, 1e-2f, 1e-4f, 1e-6f}) {
    SCOPED_TRACE(height);
    const Estimate e = irradiance(floor, {{10, 20, height}, {0, 0, -1}}, 20000, 3);
    EXPECT_NEAR(e.mean, std::numbers::pi, 4 * e.error + 1e-5);
    const TriangleEmitter half{{-1000, -1000, 0}, {2000, -1000, 0}, {-1000, 2000, 0}, kWhite};
    const DiskEmitter disk{{0, 0, 0}, {0, 0, 1}, 1000, kWhite};
    const Estimate d = irradiance(disk, {{10, 20, height}, {0, 0, -1}}, 20000, 5);
    EXPECT_NEAR(d.mean, std::numbers::pi, 4 * d.error + 1e-5);
    EXPECT_LT(d.error, 0.05);
    const Estimate t = irradiance(half, {{10, 20, height}, {0, 0, -1}}, 20000, 4);
    EXPECT_NEAR(t.mean, std::numbers::pi, 4 * t.error + 1e-5);
  }
}

TEST(LightIrradiance, PointsFallOffWithTheSquareOfTheDistance) {
  const LightPoint point{{1, 2, 3}, {}};
  const auto s = sample_emitter(PointEmitter{{1, 2, 8}, {50, 25, 0}}, point, {});
  ASSERT_TRUE(s);
  EXPECT_TRUE(s->delta);
  EXPECT_EQ(s->pdf, 1);
  EXPECT_EQ(s->direction, (Vec3f{0, 0, 1}));
  EXPECT_EQ(s->distance, 5);
  EXPECT_NEAR(s->radiance.x, 2, 1e-6f);
  EXPECT_NEAR(s->radiance.y, 1, 1e-6f);
  EXPECT_EQ(sample_emitter(PointEmitter{{1, 2, 8}, {50, 25, 0}, false}, point, {})->radiance,
            (Color{50, 25, 0}));
  EXPECT_FALSE(sample_emitter(PointEmitter{{1, 2, 3}, {50, 25, 0}}, point, {}));
}

TEST(LightIrradiance, SpotsAreFullInsideSmoothAtTheEdgeAndDarkOutside) {
  const SpotEmitter spot{{0, 0, 2}, {0, 0, -1}, {8, 8, 8}, 0.9f, 0.7f};
  const auto at = [&](double cosine) {
    const double sine = std::sqrt(1 - cosine * cosine);
    const auto s = sample_emitter(spot, {Vec3f(Vec3d{2 * sine, 0, 2 - 2 * cosine}), {}}, {});
    return s ? s->radiance.x : 0;
  };
  EXPECT_NEAR(at(1), 2, 1e-5f);
  EXPECT_NEAR(at(0.91), 2, 1e-5f);
  EXPECT_NEAR(at(0.8), 1, 1e-5f);
  EXPECT_NEAR(at(0.75), 2 * 0.15625, 1e-5f);
  EXPECT_EQ(at(0.69), 0);
  EXPECT_EQ(at(-1), 0);
}

TEST(LightIrradiance, TheSunHasItsIrradianceWhateverItsSize) {
  const Vec3f up = normalize(Vec3f{1, 2, 3}), n = normalize(Vec3f{0, 1, 2});
  const auto delta = sample_emitter(DirectionalEmitter{up, {3, 3, 3}}, {{}, n}, {});
  ASSERT_TRUE(delta && delta->delta);
  EXPECT_EQ(delta->direction, up);
  EXPECT_EQ(delta->radiance, (Color{3, 3, 3}));
  EXPECT_TRUE(std::isinf(delta->distance));
  for (const double degrees : {1e-3, 0.53, 5.0, 60.0, 180.0}) {
    SCOPED_TRACE(degrees);
    const DirectionalEmitter sun{up, {3, 3, 3}, static_cast<float>(degrees * std::numbers::pi / 180)};
    // On a surface that faces it.
    expect_irradiance(sun, {{}, up}, 3, 1);
    if (degrees < 90) expect_irradiance(sun, {{}, n}, 3 * dot(up, n), 2);
    Random random(9);
    int outside = 0;
    for (int i = 0; i < 1000; ++i) {
      const auto s = sample_emitter(sun, {{}, n}, random.square());
      if (infinite_radiance(sun, s->direction) == Color{})
        ++outside;
      else
        EXPECT_EQ(infinite_radiance(sun, s->direction), s->radiance);
    }
    // Rounding of directions.
    EXPECT_LE(outside, degrees < 0.1 ? 20 : 1);
  }
}

}  // namespace
}  // namespace oktett::light_irradiance_test
