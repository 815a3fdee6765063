/// \file Reconstruction filters: places of samples against the filters' integrals.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/sampling/warp.h"
#include "tests/render/test_scenes.h"

namespace oktett::filter_test {
namespace {

using namespace test;

/// The filters once more, by their textbook formulas over [-radius, radius].
double weight(FilterKind kind, double radius, double x) {
  switch (kind) {
    case FilterKind::box:
      return 1;
    case FilterKind::tent:
      return radius - std::abs(x);
    case FilterKind::gaussian:
      return std::exp(-x * x / (2 * (radius / 3) * (radius / 3)));
    case FilterKind::blackman_harris: {
      const double t = (x + radius) / (2 * radius);
      return 0.35875 - 0.48829 * std::cos(2 * std::numbers::pi * t) +
             0.14128 * std::cos(4 * std::numbers::pi * t) - 0.01168 * std::cos(6 * std::numbers::pi * t);
    }
  }
  return 0;
}

/// The integral of x^power times the filter from -radius to `end`, over that of the filter.
double moment(FilterKind kind, double radius, int power, double end) {
  constexpr int kSteps = 200000;
  double sum = 0, all = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = radius * ((2 * i + 1.0) / kSteps - 1), w = weight(kind, radius, x);
    all += w;
    if (x < end) sum += w * std::pow(x, power);
  }
  return sum / all;
}

TEST(Filter, OffsetsHaveTheMomentsOfTheFilter) {
  for (const Choice<FilterKind>& kind : kFilterKinds)
    for (const double radius : {0.25, 0.5, 1.0, 2.7, 16.0}) {
      const FilterSampler sampler(kind.value, radius);
      constexpr int kSamples = 100000;
      double sums[5] = {}, last = -radius;
      for (int i = 0; i < kSamples; ++i) {
        const double x = sampler.offset((i + 0.5) / kSamples);
        ASSERT_GE(x, last) << kind.name;
        last = x;
        for (int power = 1; power < 5; ++power) sums[power] += std::pow(x, power) / kSamples;
      }
      for (int power = 1; power < 5; ++power)
        EXPECT_NEAR(sums[power], moment(kind.value, radius, power, radius), 3e-6 * std::pow(radius, power))
            << kind.name << ' ' << radius << ' ' << power;
      EXPECT_LE(last, radius);
      EXPECT_GE(sampler.offset(0), -radius);
      EXPECT_LE(sampler.offset(1 - 0x1p-32), radius);
    }
}

// Half of the plane glows. Pixels near its edge show the filter's integral up to the edge.
TEST(Filter, AStepEdgeShowsTheFiltersIntegral) {
  for (const Choice<FilterKind>& kind : kFilterKinds) {
    Scene scene = bare_scene(8);
    scene.film.filter = kind.value;
    scene.integrator.samples = 16384;
    scene.camera.projection = Projection::orthographic;
    scene.camera.height = 8;
    add_object(scene, BoxShape{{0.3, -50, -1}, {50, 50, 1}}, add_material(scene, glowing({1, 1, 1})));
    const Picture picture = run(scene).picture;
    const double radius = usual_radius(kind.value);
    for (std::uint32_t x = 0; x < 8; ++x) {
      const double edge = 0.3 - (x + 0.5 - 4);
      const double expected = 1 - (edge <= -radius ? 0 : moment(kind.value, radius, 0, edge));
      EXPECT_NEAR(value(picture, "R", x, 3), expected, 0.002) << kind.name << ' ' << x;
    }
  }
}

// The default is the square of the pixel, with the bits that it had before there were filters.
TEST(Filter, TheBoxOfAPixelChangesNothing) {
  const FilterSampler box(FilterKind::box, 0);
  EXPECT_TRUE(box.is_pixel());
  EXPECT_TRUE(FilterSampler().is_pixel());
  EXPECT_FALSE(FilterSampler(FilterKind::box, 0.6).is_pixel());
  for (const double u : {0.0, 0.25, 1 - 0x1p-32}) EXPECT_EQ(box.offset(u) + 0.5, u);
}

// One sample stays at the centre of the pixel.
TEST(Filter, OneSampleLooksThroughTheCentre) {
  Scene scene = bare_scene(16);
  scene.lights = {PointLight{{3, 4, 5}, {1, 1, 1}, false}};
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({1, 1, 1})));
  const Picture box = run(scene).picture;
  scene.film.filter = FilterKind::gaussian;
  EXPECT_TRUE(same_bytes(box, run(scene).picture));
}

TEST(Filter, PicturesHaveTheSameBits) {
  Scene scene = bare_scene(20);
  scene.integrator.samples = 6;
  scene.film.filter = FilterKind::blackman_harris;
  scene.lights = {PointLight{{3, 4, 5}, {1, 1, 1}, false}};
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({1, 1, 1})));
  const Picture one = run(scene, [](RenderOptions& o) { o.threads = 1, o.isa = Isa::scalar; }).picture;
  EXPECT_TRUE(same_bytes(one, run(scene, [](RenderOptions& o) { o.tile_size = 7; }).picture));
}

}  // namespace
}  // namespace oktett::filter_test
