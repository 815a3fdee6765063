/// \file Photons that are found by place, and how they are packed.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "render/photon/photon_map.h"

namespace oktett::photon_map_test {
namespace {

float dice(std::uint32_t number, std::uint32_t dimension) { return random_float(7, number, dimension); }

Vec3f unit_vector(std::uint32_t number) {
  const double z = 2.0 * dice(number, 10) - 1, turn = 2 * std::numbers::pi * dice(number, 11);
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return Vec3f(Vec3d{r * std::cos(turn), r * std::sin(turn), z});
}

TEST(Photon, DirectionsArePackedToATenThousandth) {
  std::vector<Vec3f> cases{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const float s = 1 / std::sqrt(2.0f);
  for (const float a : {s, -s})
    for (const float b : {s, -s})
      cases.push_back({a, b, 0}), cases.push_back({0, a, b}), cases.push_back({a, 0, b});
  for (std::uint32_t i = 0; i < 20000; ++i) cases.push_back(unit_vector(i));
  for (const Vec3f& d : cases) {
    const Vec3f back = unpack_direction(pack_direction(d));
    EXPECT_LT(length(back - d), 1e-4f) << d.x << ' ' << d.y << ' ' << d.z;
    EXPECT_NEAR(length(back), 1, 1e-6f);
  }
  // Files may hold any bits.
  for (const std::uint32_t bits : {0u, 0xffffffffu, 0xffffu, 0xffff0000u, 0x80008000u})
    EXPECT_NEAR(length(unpack_direction(bits)), 1, 1e-6f) << bits;
}

/// Photons at random places, many of them in the same places and on the edges of cells.
Column<Photon> random_photons(std::uint32_t count, float scale, float far) {
  Column<Photon> photons;
  for (std::uint32_t i = 0; i < count; ++i) {
    Photon p;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::uint32_t>(k);
      p.position[k] = (dice(i, axis) - 0.5f) * scale;
      if (i % 4 == 0) p.position[k] = std::round(p.position[k] * 8) / 8;
      p.position[k] += far;
    }
    p.power = {static_cast<float>(i), 1, 1}, p.bounces = 1;
    photons.push_back(p);
  }
  return photons;
}

TEST(PhotonPass, FindsWhatALookAtAllPhotonsFinds) {
  for (const float far : {0.0f, -1000.0f, 1e7f})
    for (const float radius : {0.03f, 0.125f, 0.5f, 40.0f, 1e-9f}) {
      const Column<Photon> photons = random_photons(600, 4, far);
      const PhotonPass pass(photons, radius);
      for (std::uint32_t i = 0; i < 200; ++i) {
        const Vec3f at = photons[i].position + unit_vector(i) * (radius * dice(i, 20));
        const Vec3f n = unit_vector(i + 1000);
        std::vector<float> want, got;
        for (const Photon& p : photons) {
          const Vec3f to = p.position - at;
          const float up = dot(to, n), across = dot(to, to) - up * up;
          if (across < radius * radius && std::abs(up) < radius / 4) want.push_back(p.power.x);
        }
        pass.visit_near(at, n, [&](const Photon& p, float) { got.push_back(p.power.x); });
        std::sort(got.begin(), got.end());
        EXPECT_EQ(got, want) << far << ' ' << radius << ' ' << i;
      }
    }
}

TEST(PhotonPass, WeightsAreADensity) {
  // One photon; the plane is moved past it.
  Column<Photon> one(1, Photon{{0.3f, 0.1f, -0.2f}, {1, 1, 1}, 0, 1, 0});
  const PhotonPass pass(one, 0.25f);
  const int steps = 400;
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < steps; ++k) {
      const Vec3f at{0.05f + 0.5f * (i + 0.5f) / steps, 0.15f, -0.45f + 0.5f * (k + 0.5f) / steps};
      pass.visit_near(at, {0, 1, 0}, [&](const Photon&, float w) { sum += w * 0.25 / (steps * steps); });
    }
  EXPECT_NEAR(sum, 1, 1e-3);
  pass.visit_near({0.3f, 0.17f, -0.2f}, {0, 1, 0}, [](const Photon&, float) { FAIL() << "too high above"; });
}

TEST(PhotonPass, OrderIsThatOfNumbersWithinACell) {
  Column<Photon> photons;
  for (std::uint32_t i = 0; i < 50; ++i)
    photons.push_back({{0.5f, 0.5f, 0.5f}, {static_cast<float>(i), 0, 0}, 0, 1, 0});
  const PhotonPass pass(photons, 1);
  float last = -1;
  pass.visit_near({0.5f, 0.5f, 0.5f}, {0, 0, 1}, [&](const Photon& p, float) {
    EXPECT_GT(p.power.x, last);
    last = p.power.x;
  });
  EXPECT_EQ(last, 49);
  PhotonPass().visit_near({}, {0, 0, 1}, [](const Photon&, float) { FAIL(); });
}

// The product of (i + a) / (i + 1), i = 1 ... n - 1, is gamma(n + a) / (gamma(1 + a) gamma(n + 1)).
TEST(PhotonPass, RadiiAreThoseOfKnausAndZwicker) {
  for (const std::uint32_t n : {1u, 2u, 3u, 16u, 1000u}) {
    const double a = 2.0 / 3;
    const double square = std::exp(std::lgamma(n + a) - std::lgamma(1 + a) - std::lgamma(n + 1.0));
    EXPECT_NEAR(pass_radius(3, n - 1), 3 * std::sqrt(square), 1e-10) << n;
  }
}

TEST(PhotonPass, TheUsualRadiusHoldsThirtyTwoPhotons) {
  // Uniform over a square of side 1: a disk of radius r holds n pi r^2.
  Column<Photon> photons;
  for (std::uint32_t i = 0; i < 20000; ++i)
    photons.push_back({{dice(i, 0), 0, dice(i, 1)}, {1, 1, 1}, 0, 1, 0});
  EXPECT_NEAR(usual_radius(photons), std::sqrt(32 / (20000 * std::numbers::pi)),
              0.05 * std::sqrt(32 / (20000 * std::numbers::pi)));
  photons.resize_uninitialized(1);
  EXPECT_EQ(usual_radius(photons), 0);
}

}  // namespace
}  // namespace oktett::photon_map_test
