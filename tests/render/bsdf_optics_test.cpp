#include "render/bsdf/optics.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

namespace oktett::bsdf_optics_test {
namespace {

/// The unit vector that meets the surface z = 0 from above at `angle` to its normal.
Vec3f incoming(double angle) {
  return {static_cast<float>(std::sin(angle)), 0, static_cast<float>(-std::cos(angle))};
}

constexpr Vec3f kUp{0, 0, 1};

TEST(Optics, MirrorKeepsTheAngle) {
  for (double angle = 0; angle < 1.57; angle += 0.01) {
    const Vec3f d = incoming(angle), r = reflect_above(d, kUp, kUp);
    EXPECT_NEAR(r.x, d.x, 1e-6f);
    EXPECT_NEAR(r.z, -d.z, 1e-6f);
  }
}

TEST(Optics, RefractionObeysSnell) {
  for (const float eta : {0.5f, 0.75f, 0.9999f, 1.0f, 1.33f, 1.5f, 2.4f})
    for (double angle = 0; angle < 1.57; angle += 0.01) {
      const double sine = std::sin(angle) / static_cast<double>(eta);
      const auto t = refract(incoming(angle), kUp, eta);
      if (std::abs(sine - 1) < 1e-6) continue;
      ASSERT_EQ(t.has_value(), sine < 1) << eta << ' ' << angle;
      if (!t) continue;
      EXPECT_NEAR(t->x, sine, 1e-6);
      EXPECT_EQ(t->y, 0);
      EXPECT_LT(t->z, 0);
      EXPECT_NEAR(length(*t), 1, 1e-6f);
    }
}

// In terms of the angles (Fresnel's sine and tangent laws), unlike the code's cosines.
TEST(Optics, ReflectanceObeysFresnel) {
  for (const float eta : {0.6f, 0.8f, 1.33f, 1.5f, 2.4f})
    for (double angle = 0.01; angle < 1.57; angle += 0.01) {
      const double sine = std::sin(angle) / static_cast<double>(eta);
      const float got = fresnel(static_cast<float>(std::cos(angle)), eta);
      if (sine >= 1) {
        if (sine > 1.0001) {
          EXPECT_EQ(got, 1);
        }
        continue;
      }
      const double below = std::asin(sine);
      const double s = std::sin(angle - below) / std::sin(angle + below);
      const double p = std::tan(angle - below) / std::tan(angle + below);
      EXPECT_NEAR(got, (s * s + p * p) / 2, 1e-4) << eta << ' ' << angle;
    }
}

TEST(Optics, ReflectanceAtNormalIncidenceAndBrewstersAngle) {
  for (const double eta : {0.5, 1.33, 1.5, 2.4}) {
    const double head_on = (eta - 1) / (eta + 1);
    EXPECT_NEAR(fresnel(1, static_cast<float>(eta)), head_on * head_on, 1e-6);
    // At Brewster's angle one of the two polarisations is not reflected.
    const double brewster = std::atan(eta), below = std::numbers::pi / 2 - brewster;
    const double s = std::sin(brewster - below);
    EXPECT_NEAR(fresnel(static_cast<float>(std::cos(brewster)), static_cast<float>(eta)), s * s / 2, 1e-6);
  }
  EXPECT_EQ(fresnel(1, 1), 0);
  EXPECT_EQ(fresnel(0.3f, 1), 0);
  EXPECT_EQ(fresnel(0, 1.5f), 1);
}

// Light takes the same way back, and as much of it is reflected.
RC_GTEST_PROP(Optics, PathsAreReversible, ()) {
  const double angle = *rc::gen::inRange(0, 1500) / 1000.0;
  const float eta = static_cast<float>(*rc::gen::inRange(1010, 3000)) / 1000;
  const Vec3f d = incoming(angle);
  const auto t = refract(d, kUp, eta);
  RC_ASSERT(t.has_value());
  const auto back = refract(-*t, -kUp, 1 / eta);
  RC_ASSERT(back.has_value());
  RC_ASSERT(length(*back + d) < 1e-4f);
  const float above = fresnel(-d.z, eta), below = fresnel(-t->z, 1 / eta);
  RC_ASSERT(std::abs(above - below) < 2e-3f);
}

TEST(Optics, MirroredRaysStayAboveTheTrueSurface) {
  const Vec3f d = normalize(Vec3f{1, 0, -0.05f});
  for (float lean = -0.9f; lean < 0.9f; lean += 0.05f) {
    const Vec3f ns = normalize(Vec3f{lean, 0.3f, 1});
    if (dot(d, ns) >= 0) continue;
    EXPECT_GE(dot(reflect_above(d, ns, kUp), kUp), 0) << lean;
    EXPECT_NEAR(length(reflect_above(d, ns, kUp)), 1, 1e-5f);
  }
}

}  // namespace
}  // namespace oktett::bsdf_optics_test
