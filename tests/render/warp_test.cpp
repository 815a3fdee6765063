/// \file Warps, turbulence, waves and maps of patterns, by values of POV-Ray 3.7.0.10 where it has the same:
/// those of `function { pattern { gradient x ... } }` along each axis, written out by `#write`.

#include "render/warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kernels/functions/function_tape.h"
#include "render/pattern.h"
#include "tests/render/light_checks.h"

namespace oktett::warp_test {
namespace {

using light_checks::Random;

Vec3d random_point(Random& random, double reach) {
  return {random.between(-reach, reach), random.between(-reach, reach), random.between(-reach, reach)};
}

TEST(Waves, HaveTheValuesOfPovRay) {
  const double places[] = {-2.3, -1, -0.7, -0.3, 0, 0.2, 0.5, 0.9, 1.2, 1.5, 5.5};
  const struct {
    Wave wave;
    double values[11];
  } all[] = {
      {{}, {0.70002, 0, 0.3, 0.7, 0, 0.2, 0.5, 0.9, 0.2, 0.5, 0.5}},
      {{WaveShape::triangle}, {0.59996, 0, 0.6, 0.6, 0, 0.4, 1, 0.2, 0.4, 1, 1}},
      {{WaveShape::sine},
       {0.0244523295, 0.5, 0.975528258, 0.0244717419, 0.5, 0.975528258, 0.5, 0.206107374, 0.975528258, 0.5,
        0.5}},
      {{WaveShape::scallop},
       {0.808980061, 0, 0.809016994, 0.809016994, 0, 0.587785252, 1, 0.309016994, 0.587785252, 1, 1}},
      {{WaveShape::cubic}, {0.7840252, 0, 0.216, 0.784, 0, 0.104, 0.5, 0.972, 0.104, 0.5, 0.5}},
      {{WaveShape::poly, 3}, {0.343029401, 0, 0.027, 0.343, 0, 0.008, 0.125, 0.729, 0.008, 0.125, 0.125}},
      {{WaveShape::own, 1, 2}, {0.40004, 1e-05, 0.60001, 0.4, 0, 0.4, 1, 0.79999, 0.4, 1, 1}},
      {{WaveShape::own, 1, 1, 0.25},
       {0.95002, 0.25, 0.55, 0.95, 0.25, 0.45, 0.75, 0.14999, 0.45, 0.75, 0.75}},
      {{WaveShape::own, 1, -1}, {0.29998, 1, 0.7, 0.3, 0, 0.8, 0.5, 0.1, 0.8, 0.5, 0.5}},
      {{WaveShape::own, 1, 0, 0.25}, {0.7, 0, 0.3, 0.7, 0, 0.2, 0.5, 0.9, 0.2, 0.5, 0.5}},
      {{WaveShape::sine, 1, 3, 0.125},
       {0.993873622, 0.853597817, 0.578248262, 0.99384417, 0.853553391, 0.0061558297, 0.146468825,
        0.0544682164, 0.0061558297, 0.146468825, 0.146468825}},
  };
  for (const auto& known : all)
    for (std::size_t i = 0; i < 11; ++i) {
      PatternTexture texture;
      texture.pattern = LinearPattern{};
      texture.wave = known.wave;
      EXPECT_NEAR(double{pattern_color(texture, {places[i], 0, 0}).x}, known.values[i], 1e-6)
          << &known - all << " at " << places[i];
    }
}

using Figure = MappingWarp::Figure;

TEST(Warps, LeadToThePlacesOfPovRay) {
  const struct {
    Warp warp;
    Vec3d from, to;
  } all[] = {
      {RepeatWarp{{2, 0, 0}}, {-0.29, 0.36, 2.55}, {1.71, 0.36, 2.55}},
      {RepeatWarp{{2, 0, 0}}, {-0.21, 0.05, 0.52}, {1.79, 0.05, 0.52}},
      {RepeatWarp{{2, 0, 0}}, {-1.89, 0.07, 0.78}, {0.11, 0.07, 0.78}},
      {RepeatWarp{{0, -0.7, 0}}, {-0.29, 0.36, 2.55}, {-0.29, -0.33999999, 2.55}},
      {RepeatWarp{{0, -0.7, 0}}, {-0.21, 0.05, 0.52}, {-0.21, -0.64999999, 0.52}},
      {RepeatWarp{{0, -0.7, 0}}, {-1.89, 0.07, 0.78}, {-1.89, -0.62999999, 0.78}},
      {RepeatWarp{{0, 0, 1.5}, {0.1, 0.2, 0.3}, {1, 0, 1}}, {-0.29, 0.36, 2.55}, {0.39, 0.56, 0.75}},
      {RepeatWarp{{0, 0, 1.5}, {0.1, 0.2, 0.3}, {1, 0, 1}}, {-0.21, 0.05, 0.52}, {-0.21, 0.05, 0.52}},
      {RepeatWarp{{0, 0, 1.5}, {0.1, 0.2, 0.3}, {1, 0, 1}}, {-1.89, 0.07, 0.78}, {-1.89, 0.07, 0.78}},
      {RepeatWarp{{1, 0, 0}, {0, 0, 0}, {1, 1, 0}}, {-0.29, 0.36, 2.55}, {0.29, -0.36, 2.55}},
      {RepeatWarp{{1, 0, 0}, {0, 0, 0}, {1, 1, 0}}, {-0.21, 0.05, 0.52}, {0.21, -0.05, 0.52}},
      {RepeatWarp{{1, 0, 0}, {0, 0, 0}, {1, 1, 0}}, {-1.89, 0.07, 0.78}, {0.11, 0.07, 0.78}},
      {BlackHoleWarp{}, {0.1, 0.2, 0}, {0.16027864, 0.32055728, 0}},
      {BlackHoleWarp{}, {0.5, 0.3, -0.2}, {0.5735586, 0.34413516, -0.22942344}},
      {BlackHoleWarp{}, {-0.3, 0.1, 0.9}, {-0.30063648, 0.10021216, 0.90190944}},
      {BlackHoleWarp{{0.1, 0.2, 0.3}, 2, 0.5, 3}, {0.1, 0.2, 0}, {0.1, 0.2, -0.09211875}},
      {BlackHoleWarp{{0.1, 0.2, 0.3}, 2, 0.5, 3}, {0.5, 0.3, -0.2}, {0.561773, 0.31544325, -0.27721625}},
      {BlackHoleWarp{{0.1, 0.2, 0.3}, 2, 0.5, 3}, {-0.3, 0.1, 0.9}, {-0.35145056, 0.087137361, 0.97717584}},
      {BlackHoleWarp{{0, 0, 0}, 1, 3, 1}, {0.1, 0.2, 0}, {0.2, 0.4, 0}},
      {BlackHoleWarp{{0, 0, 0}, 1, 3, 1}, {0.5, 0.3, -0.2}, {1, 0.6, -0.4}},
      {BlackHoleWarp{{0, 0, 0}, 1, 3, 1}, {-0.3, 0.1, 0.9}, {-0.34145472, 0.11381824, 1.0243642}},
      {BlackHoleWarp{{0, 0, 0}, 1, 0.8, 4, true}, {0.1, 0.2, 0}, {0.070931884, 0.14186377, 0}},
      {BlackHoleWarp{{0, 0, 0}, 1, 0.8, 4, true}, {0.5, 0.3, -0.2}, {0.49134261, 0.29480557, -0.19653704}},
      {BlackHoleWarp{{0, 0, 0}, 1, 0.8, 4, true}, {-0.3, 0.1, 0.9}, {-0.29999892, 0.09999964, 0.89999676}},
      {MappingWarp{Figure::cylindrical}, {-0.29, 0.36, 2.55}, {0.26802254, 0.36, 2.5664372}},
      {MappingWarp{Figure::cylindrical}, {-0.21, 0.05, 0.52}, {0.31108647, 0.05, 0.560803}},
      {MappingWarp{Figure::cylindrical}, {-1.89, 0.07, 0.78}, {0.43770594, 0.07, 2.0446271}},
      {MappingWarp{Figure::cylindrical, {1, 0, 0}, 0, 1},
       {-0.29, 0.36, 2.55},
       {2.5664372, 0.36, -0.68786303}},
      {MappingWarp{Figure::cylindrical, {1, 0, 0}, 0, 1}, {-0.21, 0.05, 0.52}, {0.560803, 0.05, -0.17445823}},
      {MappingWarp{Figure::cylindrical, {1, 0, 0}, 0, 1},
       {-1.89, 0.07, 0.78},
       {2.0446271, 0.07, -0.89494543}},
      {MappingWarp{Figure::spherical}, {-0.29, 0.36, 2.55}, {0.26802254, 0.54436061, 2.5915632}},
      {MappingWarp{Figure::spherical}, {-0.21, 0.05, 0.52}, {0.31108647, 0.52830499, 0.56302753}},
      {MappingWarp{Figure::spherical}, {-1.89, 0.07, 0.78}, {0.43770594, 0.51089343, 2.045825}},
      {MappingWarp{Figure::spherical, {0, 1, 0}, 0, 0.5},
       {-0.29, 0.36, 2.55},
       {0.43147161, -2.5915632, 0.87632984}},
      {MappingWarp{Figure::spherical, {0, 1, 0}, 0, 0.5},
       {-0.21, 0.05, 0.52},
       {0.23342423, -0.56302753, 0.3964145}},
      {MappingWarp{Figure::spherical, {0, 1, 0}, 0, 0.5},
       {-1.89, 0.07, 0.78},
       {0.62606105, -2.045825, 0.73074282}},
      {MappingWarp{Figure::toroidal}, {-0.29, 0.36, 2.55}, {0.26802254, 0.53595283, 1.6072727}},
      {MappingWarp{Figure::toroidal}, {-0.21, 0.05, 0.52}, {0.31108647, 0.98195882, 0.44203394}},
      {MappingWarp{Figure::toroidal}, {-1.89, 0.07, 0.78}, {0.43770594, 0.51064898, 1.0469698}},
      {MappingWarp{Figure::toroidal, {0, 0, 1}, 0, 1, 2},
       {-0.29, 0.36, 2.55},
       {0.17988509, 0.39605332, 0.67115656}},
      {MappingWarp{Figure::toroidal, {0, 0, 1}, 0, 1, 2},
       {-0.21, 0.05, 0.52},
       {0.44798483, 1.4321059, 1.4400653}},
      {MappingWarp{Figure::toroidal, {0, 0, 1}, 0, 1, 2},
       {-1.89, 0.07, 0.78},
       {0.036336391, 0.054762871, 0.083015532}},
      {MappingWarp{Figure::planar}, {-0.29, 0.36, 2.55}, {-0.29, 0.36, 0}},
      {MappingWarp{Figure::planar}, {-0.21, 0.05, 0.52}, {-0.21, 0.05, 0}},
      {MappingWarp{Figure::planar}, {-1.89, 0.07, 0.78}, {-1.89, 0.07, 0}},
      {MappingWarp{Figure::planar, {0, 0.6, 0.8}, 2}, {-0.29, 0.36, 2.55}, {-0.406, -0.912, 1.816}},
      {MappingWarp{Figure::planar, {0, 0.6, 0.8}, 2}, {-0.21, 0.05, 0.52}, {-0.294, -1.16, 1.63}},
      {MappingWarp{Figure::planar, {0, 0.6, 0.8}, 2}, {-1.89, 0.07, 0.78}, {-2.646, -1.144, 1.642}},
  };
  for (const auto& known : all) {
    const Vec3d found = warped(known.warp, known.from);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(found[k], known.to[k], 1e-6) << &known - all << " axis " << k << " from " << known.from.x
                                               << " " << known.from.y << " " << known.from.z;
  }
}

// The first of the list is nearest to the pattern, so it comes last for a place.
TEST(Warps, AreUndoneFromTheLastToTheFirst) {
  const Warp repeat = RepeatWarp{{1, 0, 0}}, move = TransformWarp{Affine::translation({0.25, 0, 0})};
  const std::vector<Warp> both{repeat, move};
  EXPECT_EQ(warped(both, {1.5, 0, 0}), (Vec3d{0.75, 0, 0}));
  EXPECT_EQ(warped(std::vector<Warp>{move, repeat}, {1.875, 0, 0}), (Vec3d{1.125, 0, 0}));
}

TEST(Warps, StayFiniteAtTheirCentres) {
  const Vec3d zero{0, 0, 0};
  for (const Warp& warp : {Warp(MappingWarp{Figure::spherical}), Warp(MappingWarp{Figure::toroidal}),
                           Warp(MappingWarp{Figure::cylindrical}), Warp(BlackHoleWarp{})}) {
    const Vec3d p = warped(warp, zero);
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << warp.index();
  }
}

// As in POV-Ray a point of the next octave has omega times the displacement of lambda times the point, and
// the displacement of one octave has about the deviation 0.26 for an amount of 1.
TEST(Turbulence, IsASumOfOctaves) {
  Random random(1);
  double square = 0;
  PatternTurbulence one{{1, 1, 1}, 1, 3, 0.25}, two = one;
  two.octaves = 2;
  for (int i = 0; i < 5000; ++i) {
    const Vec3d p = random_point(random, 20);
    const Vec3d first = displaced(one, p) - p, next = displaced(one, p * 3) - p * 3;
    const Vec3d both = displaced(two, p) - p;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(both[k], first[k] + 0.25 * next[k], 1e-12);
    square += dot(first, first) / 15000;
  }
  EXPECT_NEAR(std::sqrt(square), 0.258, 0.03);
  one.amount = {0, 2, 0};
  const Vec3d moved = displaced(one, {0.5, 0.5, 0.5});
  EXPECT_EQ(moved.x, 0.5);
  EXPECT_NE(moved.y, 0.5);
}

// POV-Ray: the turbulence of marble along x with 6 octaves has the mean 1.006 and the deviation 0.281; that
// of one octave is 0.2488 where noise is 0.3744.
TEST(Turbulence, MovesLayersAlongXAlone) {
  Random random(2);
  double mean = 0, square = 0;
  for (int i = 0; i < 4000; ++i) {
    const double value = value_turbulence({}, random_point(random, 30));
    mean += value / 4000, square += value * value / 4000;
  }
  EXPECT_NEAR(mean, 1.006, 0.05);
  EXPECT_NEAR(std::sqrt(square - mean * mean), 0.281, 0.04);
  PatternTexture layers, still;
  layers.pattern = still.pattern = LayersPattern{};
  layers.turbulence.amount = {0, 1, 1};
  for (int i = 0; i < 100; ++i) {
    const Vec3d p = random_point(random, 3);
    EXPECT_EQ(pattern_color(layers, p), pattern_color(still, p));
  }
}

TEST(Turbulence, DisplacesThePlaceOfOthers) {
  Random random(3);
  PatternTexture turbulent, still;
  turbulent.pattern = still.pattern = LeopardPattern{};
  turbulent.turbulence.amount = {0.1, 0.2, 0.3};
  PatternTexture warps = still;
  warps.warps = {TurbulenceWarp{turbulent.turbulence}};
  for (int i = 0; i < 100; ++i) {
    const Vec3d p = random_point(random, 3);
    EXPECT_EQ(pattern_color(turbulent, p), pattern_color(still, displaced(turbulent.turbulence, p)));
    EXPECT_EQ(pattern_color(turbulent, p), pattern_color(warps, p));
  }
}

PatternEntry grey(double at, float value) { return {at, {value, value, value}, {}}; }

// POV-Ray shows the same of `gradient x color_map {[0 rgb 0] [.3 rgb .5] [.3 rgb 1] [1 rgb 0]}`.
TEST(Maps, AreLinearBetweenPlaces) {
  PatternTexture texture;
  texture.pattern = LinearPattern{};
  texture.map = {grey(0, 0), grey(0.3, 0.5f), grey(0.3, 1), grey(1, 0)};
  const auto at = [&](double x) { return double{pattern_color(texture, {x, 0, 0}).x}; };
  for (const auto& [x, value] : {std::pair{0.0, 0.0},
                                 {0.1, 0.166667},
                                 {0.2, 0.333333},
                                 {0.4, 0.857143},
                                 {0.5, 0.714286},
                                 {0.7, 0.428571},
                                 {0.9, 0.142857},
                                 {1.1, 0.166667}})
    EXPECT_NEAR(at(x), value, 1e-6);
  texture.map = {grey(0.2, 0), grey(0.5, 1)};
  for (const auto& [x, value] : {std::pair{0.0, 0.0}, {0.2, 0.0}, {0.3, 0.333333}, {0.5, 1.0}, {0.9, 1.0}})
    EXPECT_NEAR(at(x), value, 1e-6);
  texture.map = {grey(0.5, 0.75f)};
  EXPECT_EQ(at(0.1), 0.75);
  EXPECT_EQ(at(0.9), 0.75);
}

/// The coordinates of the place, which it keeps, as a colour of each texture.
class Places final : public PatternTextures {
 public:
  Color color(std::uint32_t texture, const Vec3d& position) const override {
    return Color(position) + Color{static_cast<float>(texture), 0, 0};
  }
  Color image(std::uint32_t texture, const Vec2f& uv) const override {
    return {uv.x, uv.y, static_cast<float>(texture)};
  }
};

// A texture in a map sees the place with all warps and the turbulence of what is around it, but for the
// turbulence of layers and rings. So does POV-Ray.
TEST(Maps, ShowTexturesWhereThePatternIs) {
  PatternTexture texture;
  texture.pattern = PlanarPattern{};
  texture.map = {{0, {}, {3}}, {1, {}, {5}}};
  texture.to_pattern = Affine::scaling({2, 2, 2});
  texture.warps = {TransformWarp{Affine::translation({1, 0, 0})}};
  texture.turbulence.amount = {0.3, 0, 0};
  const Places places;
  const Vec3d there = displaced(texture.turbulence, {3, 0.5, 0});
  Color c = pattern_color(texture, {1, 0.25, 0}, &places);
  EXPECT_NEAR(double{c.x}, there.x + 4, 1e-5);
  EXPECT_NEAR(double{c.y}, 0.5, 1e-6);
  texture.pattern = LayersPattern{};
  c = pattern_color(texture, {1, 0.25, 0}, &places);
  EXPECT_GE(c.x, 6);
  EXPECT_NEAR(double{c.y}, 0.5, 1e-6);
  EXPECT_EQ(pattern_color(texture, {1, 0.25, 0}), (Color{0, 0, 0}));
}

// POV-Ray's pigment_pattern is 0.297, 0.589 and 0.114 for red, green and blue.
TEST(Maps, BrightnessIsThatOfVideo) {
  class Primaries final : public PatternTextures {
   public:
    Color color(std::uint32_t texture, const Vec3d&) const override {
      return {texture == 0 ? 1.0f : 0.0f, texture == 1 ? 1.0f : 0.0f, texture == 2 ? 1.0f : 0.0f};
    }
    Color image(std::uint32_t, const Vec2f&) const override { return {0, 0, 0}; }
  };
  const Primaries primaries;
  const double expected[] = {0.297, 0.589, 0.114};
  for (std::uint32_t i = 0; i < 3; ++i) {
    PatternTexture texture;
    texture.pattern = TexturePattern{{i}};
    EXPECT_NEAR(double{pattern_color(texture, {0, 0, 0}, &primaries).x}, expected[i], 1e-6);
  }
}

// ---- Patterns that have colours in place of values.

TEST(Maps, WhatIsSeenThroughOthersIsFiltered) {
  PatternTexture texture;
  texture.pattern = OverPattern{{{0.5f, 0, 0.25f}, {}}, {{0.5f, 1, 0}, {}}, {{}, {2}}};
  texture.to_pattern = Affine::scaling({2, 2, 2});
  const Places places;
  const Vec3d p{0.5, 0.25, 3};
  EXPECT_EQ(pattern_color(texture, p, &places), (Color{0.5f + 0.5f * 3, 0.5f, 0.25f}));
  EXPECT_EQ(pattern_color(texture, p), (Color{0.5f, 0, 0.25f})) << "other textures are black";
  texture.pattern = OverPattern{{{}, {1}}, {{1, 1, 1}, {}}, {{}, {2}}};
  EXPECT_EQ(pattern_color(texture, p, &places), (Color{1 + 1 + 2 + 1, 1, 12}));
  // The height is the red part: of both together 2 x + 3 where x is in the pattern.
  const Vec3d slope = pattern_slope(texture, p, &places);
  EXPECT_NEAR(slope.x, 4, 1e-3);
  EXPECT_NEAR(slope.y, 0, 1e-3);
}

TEST(Maps, FunctionsOfColours) {
  PatternTexture texture;
  texture.pattern = FunctionPattern{compile_function("x^2 + y / 4 + z / 100"), {0}};
  texture.colors = {{0, 0, 0}, {1, 1, 1}};
  const Places places;
  EXPECT_NEAR(double{pattern_color(texture, {0.5, 0.25, 3}, &places).x}, 0.25 + 0.0625 + 0.03, 1e-6);
  EXPECT_EQ(pattern_color(texture, {0.5, 0.25, 3}).x, 0);
}

TEST(Maps, ImagesLieWhereTheirProjectionSays) {
  using enum ProjectedPattern::Projection;
  const Places places;
  PatternTexture texture;
  const auto expect_uv = [&](ProjectedPattern::Projection onto, const Vec3d& p, double u, double v) {
    texture.pattern = ProjectedPattern{{7}, onto};
    const Color c = pattern_color(texture, p, &places);
    EXPECT_NEAR(double{c.x}, u, 1e-6);
    EXPECT_NEAR(double{c.y}, v, 1e-6);
    EXPECT_EQ(c.z, 7);
  };
  expect_uv(planar, {0.25, -3.5, 9}, 0.25, -3.5);
  const double turn = 0.3, height = 0.2 * std::numbers::pi;
  const Vec3d across{std::cos(2 * std::numbers::pi * turn), 0, std::sin(2 * std::numbers::pi * turn)};
  expect_uv(cylindrical, across * 5 + Vec3d{0, 0.75, 0}, turn, 0.75);
  expect_uv(spherical, (across * std::cos(height) + Vec3d{0, std::sin(height), 0}) * 3, turn, 0.7);
  const double around = 0.4 * std::numbers::pi;
  expect_uv(toroidal, across * (1 + 0.25 * std::cos(around)) + Vec3d{0, 0.25 * std::sin(around), 0}, turn,
            0.2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(pattern_color(texture, {nan, 0, 0}, &places), (Color{0, 0, 0}));
}

// ---- Slopes.

/// The gradient of the first channel of a pattern's colours as differences over a fixed distance.
Vec3d rough_slope(const PatternTexture& texture, const Vec3d& p, double step) {
  Vec3d slope;
  for (int k = 0; k < 3; ++k) {
    Vec3d before = p, after = p;
    before[k] -= step, after[k] += step;
    slope[k] = double{pattern_color(texture, after).x - pattern_color(texture, before).x} / (2 * step);
  }
  return slope;
}

TEST(Slopes, AreGradientsOfSmoothPatterns) {
  Random random(4);
  const Pattern smooth[] = {LeopardPattern{}, QuiltedPattern{}, RipplesPattern{},
                            WavesPattern{},   DentsPattern{},   AgatePattern{0}};
  for (const Pattern& pattern : smooth)
    for (int i = 0; i < 30; ++i) {
      PatternTexture texture;
      texture.pattern = pattern;
      const Vec3d p = random_point(random, 2);
      bool near_an_edge = false;
      for (int k = 0; k < 3; ++k) near_an_edge |= std::abs(p[k] * 2 - std::round(p[k] * 2)) < 0.02;
      if (near_an_edge) continue;
      const Vec3d slope = pattern_slope(texture, p), expected = rough_slope(texture, p, 1e-3);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(slope[k], expected[k], 0.02 * (1 + length(expected))) << pattern.index();
    }
}

// Where a value jumps there is no slope, and no step of it.
TEST(Slopes, OfJumpsAreZero) {
  Random random(5);
  PatternTexture texture;
  const Pattern broken[] = {BrickPattern{{1, 1, 1}, 0.2}, CellsPattern{}, CubicPattern{}, HexagonPattern{}};
  for (const Pattern& pattern : broken) {
    texture.pattern = pattern;
    for (int i = 0; i < 2000; ++i)
      EXPECT_EQ(pattern_slope(texture, random_point(random, 1.0)), (Vec3d{0, 0, 0})) << pattern.index();
  }
  for (const Pattern& pattern : {Pattern(LinearPattern{}), Pattern(OnionPattern{}), Pattern(AngularPattern{}),
                                 Pattern(CracklePattern{{-1, 1, 0}, 2, 0, true})}) {
    texture.pattern = pattern;
    for (int i = 0; i < 5000; ++i) {
      const Vec3d p = random_point(random, 3);
      if (p.x * p.x + p.z * p.z < 0.25) continue;
      EXPECT_LT(length(pattern_slope(texture, p)), 1.8) << pattern.index();
    }
  }
  // A continuous wave has no jump where its period ends.
  texture.pattern = LinearPattern{};
  texture.wave.shape = WaveShape::triangle;
  EXPECT_NEAR(pattern_slope(texture, {1.25, 0, 0}).x, 2, 1e-6);
  EXPECT_NEAR(pattern_slope(texture, {1.0001, 0, 0}).x, 0, 0.3);
}

}  // namespace
}  // namespace oktett::warp_test
