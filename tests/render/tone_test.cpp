/// \file Tone curves and the clamp of samples.

#include "render/tone.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/test_scenes.h"
#include "tests/support/limits.h"

namespace oktett::tone_test {
namespace {

using namespace test;

TEST(Tone, RawNumbersAreThoseOfTheFile) {
  // As sRGB's curve encodes it.
  const auto encoded = [](float v) {
    return v <= 0.0031308f ? 12.92 * v : 1.055 * std::pow(static_cast<double>(v), 1 / 2.4) - 0.055;
  };
  for (int byte = 0; byte < 256; ++byte) {
    const float v = static_cast<float>(byte) / 255;
    EXPECT_NEAR(encoded(toned({ToneKind::raw}, {v, 0, 2}).x), v, 1e-6);
  }
  EXPECT_EQ(toned({ToneKind::raw}, {-1, 0, 2}), (Color{0, 0, 1}));
  // The exposure counts before.
  EXPECT_NEAR(encoded(toned({ToneKind::raw, -1}, {0.4f, 0, 0}).x), 0.2, 1e-6);
}

TEST(Tone, SrgbLeavesLightAsItIs) {
  for (const Color& c : {Color{0.1f, 1, 30}, Color{-1, 0, kInf}, Color{1e30f, 1e-30f, 0.5f}})
    EXPECT_EQ(toned({}, c), c);
}

TEST(Tone, ExposureCountsInStops) {
  EXPECT_EQ(toned({ToneKind::srgb, 3}, {0.1f, 0.2f, 1}), (Color{0.8f, 1.6f, 8}));
  EXPECT_EQ(toned({ToneKind::srgb, -1}, {0.5f, 0, 3}), (Color{0.25f, 0, 1.5f}));
  for (const ToneKind kind : {ToneKind::filmic, ToneKind::aces, ToneKind::neutral})
    EXPECT_EQ(toned({kind, 2}, {0.05f, 0.1f, 0.2f}), toned({kind, 0}, {0.2f, 0.4f, 0.8f}));
}

// Each curve grows with the light, stays in [0, 1], and keeps grey within what its own definition allows.
TEST(Tone, CurvesGrowAndStayInRange) {
  for (const ToneKind kind : {ToneKind::filmic, ToneKind::aces, ToneKind::neutral}) {
    float last = -1;
    for (double light = 1e-6; light < 1e38; light *= 1.5) {
      const auto v = static_cast<float>(light);
      const Color c = toned({kind, 0}, {v, v, v});
      for (int k = 0; k < 3; ++k) EXPECT_TRUE(c[k] >= 0 && c[k] <= 1) << light;
      // The neutral curve bends over by rounding only.
      EXPECT_GE(c.x, last - 1e-6f) << light;
      EXPECT_NEAR(c.x, c.y, 2e-5f);
      EXPECT_NEAR(c.x, c.z, 2e-5f);
      last = c.x;
    }
    EXPECT_GT(last, 0.99f);
    EXPECT_EQ(toned({kind, 0}, {-1, -2, -3}), toned({kind, 0}, {0, 0, 0}));
  }
}

// Numbers from the definitions, computed by hand in exact arithmetic.
TEST(Tone, KnownValues) {
  // Hable: 11.2 / 2 is white; f(2 * 1) / f(11.2) with f(2) = 0.6724/... .
  EXPECT_NEAR(toned({ToneKind::filmic, 0}, {5.6f, 5.6f, 5.6f}).y, 1, 1e-6f);
  const auto f = [](double v) {
    return (v * v * 0.15 + 0.05 * v + 0.004) / (0.15 * v * v + 0.5 * v + 0.06) - 1.0 / 15;
  };
  EXPECT_NEAR(toned({ToneKind::filmic, 0}, {0.18f, 1, 3}).x, f(0.36) / f(11.2), 1e-6);
  EXPECT_NEAR(toned({ToneKind::filmic, 0}, {0.18f, 1, 3}).z, f(6) / f(11.2), 1e-6);
  // Khronos: dielectrics reflect 0.04, which is taken away, so that 0.5 shows as 0.46.
  EXPECT_NEAR(toned({ToneKind::neutral, 0}, {0.5f, 0.5f, 0.5f}).x, 0.46f, 1e-6f);
  EXPECT_NEAR(toned({ToneKind::neutral, 0}, {0.7f, 0.3f, 0.04f}).x, 0.7 - (0.04 - 6.25 * 0.0016), 1e-6);
  // Hill's fit of grey: its matrices keep grey, so it is the curve alone.
  const double grey = (0.5 * 0.5245786 - 0.000090537) / (0.5 * (0.983729 * 0.5 + 0.432951) + 0.238081);
  EXPECT_NEAR(toned({ToneKind::aces, 0}, {0.5f, 0.5f, 0.5f}).x, grey, 1e-4);
}

TEST(Tone, WhatIsNotFiniteStaysSo) {
  for (const ToneKind kind : {ToneKind::filmic, ToneKind::aces, ToneKind::neutral}) {
    EXPECT_EQ(toned({kind, 0}, {kInf, 0, 0}).x, kInf);
    EXPECT_TRUE(std::isnan(toned({kind, 0}, {0, std::nanf(""), 0}).y));
  }
}

// A tenth of the pixel glows a thousand times as bright. Clamped samples lose that light and keep the colour.
TEST(Clamp, DarkensBrightSamples) {
  Scene scene = bare_scene(1);
  scene.integrator.samples = 1024;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 1;
  add_object(scene, BoxShape{{0.25, -5, -1}, {5, 5, 1}}, add_material(scene, glowing({1000, 500, 0})));
  add_object(scene, BoxShape{{-5, -5, -1}, {0.25, 5, 1}}, add_material(scene, glowing({2, 1, 1})));
  EXPECT_NEAR(value(run(scene).picture, "R", 0, 0), 0.25 * 1000 + 0.75 * 2, 0.01);
  scene.integrator.clamp = 4;
  for (const bool layers : {true, false}) {
    const Picture p = run(scene, [&](RenderOptions& o) { o.data_layers = layers; }).picture;
    EXPECT_NEAR(value(p, "R", 0, 0), 0.25 * 4 + 0.75 * 2, 1e-5);
    EXPECT_NEAR(value(p, "G", 0, 0), 0.25 * 2 + 0.75 * 1, 1e-5);
  }
  scene.integrator.samples = 1;
  EXPECT_EQ(value(run(scene).picture, "R", 0, 0), 2);
}

}  // namespace
}  // namespace oktett::tone_test
