#include "render/film/film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/render/test_scenes.h"
#include "tests/support/limits.h"

namespace oktett::film_test {
namespace {

using namespace test;

TEST(Film, DataLayersDescribeTheNearestSurface) {
  Scene scene = bare_scene(31);
  scene.camera.from = {0, 0, 5};
  add_object(scene, PlaneShape{{0, 0, 1}, -20}, add_material(scene, diffuse({0.1f, 0.2f, 0.3f})));
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({0.5f, 0.6f, 0.7f})));
  const Picture p = run(scene).picture;
  EXPECT_NEAR(value(p, "Z", 15, 15), 4, 1e-6f);
  // Depth counts along the view axis, not along the ray: a plane across the view is equally deep everywhere.
  EXPECT_NEAR(value(p, "Z", 0, 0), 25, 1e-5f);
  EXPECT_NEAR(value(p, "Z", 30, 7), 25, 1e-5f);
  EXPECT_NEAR(length(position(p, 15, 15) - Vec3f{0, 0, 1}), 0, 1e-6f);
  EXPECT_NEAR(value(p, "N.Z", 15, 15), 1, 1e-6f);
  EXPECT_EQ(value(p, "Albedo.G", 15, 15), 0.6f);
  EXPECT_EQ(value(p, "Albedo.B", 0, 0), 0.3f);
  EXPECT_EQ(id(p, "geomID.I", 15, 15), 1u);
  EXPECT_EQ(id(p, "geomID.I", 0, 0), 0u);
  EXPECT_EQ(id(p, "primID.I", 15, 15), 0u);
  EXPECT_EQ(value(p, "Variance.R", 15, 15), 0);
}

// Who fills a picture by hand need not place it.
TEST(Picture, StandsAtTheCornerOfItsFrame) {
  const Picture p;
  EXPECT_TRUE(p.x == 0 && p.y == 0);
}

TEST(Film, EmptyPixelsSaySo) {
  const Picture p = run(bare_scene(3)).picture;
  EXPECT_EQ(value(p, "Z", 1, 1), kInf);
  EXPECT_EQ(value(p, "N.X", 1, 1), 0);
  EXPECT_EQ(value(p, "A", 1, 1), 0);
  EXPECT_EQ(id(p, "primID.I", 1, 1), kNoId);
  EXPECT_EQ(id(p, "geomID.I", 1, 1), kNoId);
}

TEST(Film, PlanesFollowTheConventions) {
  const Picture all = run(bare_scene(2)).picture;
  std::vector<std::string> names;
  for (const PicturePlane& plane : all.planes) {
    names.push_back(plane.name);
    const bool is_id = plane.name.ends_with("ID.I"),
               beauty = plane.name.size() == 1 && plane.name.find_first_of("RGBA") == 0;
    EXPECT_EQ(plane.type, is_id    ? PlaneType::unsigned_int
                          : beauty ? PlaneType::half_float
                                   : PlaneType::single_float);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"R",        "G",          "B",          "A",         "Z",
                                             "N.X",      "N.Y",        "N.Z",        "Ng.X",      "Ng.Y",
                                             "Ng.Z",     "P.X",        "P.Y",        "P.Z",       "Albedo.R",
                                             "Albedo.G", "Albedo.B",   "u",          "v",         "primID.I",
                                             "geomID.I", "Variance.R", "Variance.G", "Variance.B"}));
  EXPECT_EQ(run(bare_scene(2), [](RenderOptions& o) { o.data_layers = false; }).picture.planes.size(), 4u);
}

// Half a pixel covered: alpha is the covered fraction over black, and 1 over a background that gives light.
TEST(Film, AlphaIsCoverage) {
  Scene scene = bare_scene(1);
  scene.integrator.samples = 16;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 1;
  add_object(scene, BoxShape{{0, -5, -1}, {5, 5, 1}}, add_material(scene, glowing({1, 1, 1})));
  Picture p = run(scene).picture;
  EXPECT_EQ(value(p, "A", 0, 0), 0.5f);
  EXPECT_EQ(value(p, "R", 0, 0), 0.5f);
  EXPECT_EQ(value(p, "N.Z", 0, 0), 0.5f);
  EXPECT_EQ(value(p, "P.Z", 0, 0), 1);
  EXPECT_EQ(value(p, "Z", 0, 0), 4);
  scene.background = {0.5f, 0, 0};
  p = run(scene).picture;
  EXPECT_EQ(value(p, "A", 0, 0), 1);
  EXPECT_EQ(value(p, "R", 0, 0), 0.75f);
  // Eight samples of 1 and eight of 0.5: variance of the mean = (1/16) * (16/15) * (1/4)^2.
  EXPECT_NEAR(value(p, "Variance.R", 0, 0), 1 / 240.0f, 1e-7f);
}

SampleBatch samples_of(const std::vector<float>& values) {
  SampleBatch s;
  for (std::size_t i = 0; i < values.size(); ++i) {
    s.pixel.push_back(0), s.number.push_back(static_cast<std::uint32_t>(i)), s.key.push_back(0);
    s.offset.push_back({0.4f - 0.1f * static_cast<float>(i), 0}), s.color.push_back({values[i], 0, 0});
    s.alpha.push_back(1), s.spawned.push_back(0);
    FirstHit first;
    first.found = true, first.primitive = static_cast<std::uint32_t>(i), first.object = 7;
    s.first.push_back(first);
  }
  return s;
}

TEST(Film, BadSamplesAreLeftOutAndReported) {
  const SampleBatch s = samples_of({1, std::nanf(""), 3, kInf});
  PixelSum pixel;
  int bad = 0;
  for (std::size_t i = 0; i < s.size(); ++i) bad += add_to_pixel(pixel, s, i) ? 0 : 1;
  EXPECT_EQ(bad, 2);
  EXPECT_EQ(pixel.good, 2u);
  EXPECT_EQ(pixel.color[0], 4);
}

TEST(Film, TilesOfOneSampleEachLeaveBadSamplesBlack) {
  const SampleBatch s = samples_of({1, std::nanf(""), 3, kInf, -kInf, 2});
  FilmFormat format;
  format.window = {0, 0, 8, 1}, format.full_width = 8, format.full_height = 1, format.data_layers = false;
  for (const Isa isa : available_isas()) {
    TileColors tile;
    tile.begin(8);
    EXPECT_EQ(tile.set(1, s, isa), 3u);
    tile.clear(0, 1), tile.set(7, PixelSum{});
    Picture picture = make_picture(format);
    tile.copy_to(picture, {0, 0, 8, 1}, {0, 1, 2, 3, 4, 5, 6, 7});
    const float red[] = {0, 1, 0, 3, 0, 0, 2, 0}, alpha[] = {0, 1, 0, 1, 0, 0, 1, 0};
    for (std::uint32_t x = 0; x < 8; ++x) {
      EXPECT_EQ(value(picture, "R", x, 0), red[x]) << x;
      EXPECT_EQ(value(picture, "A", x, 0), alpha[x]) << x;
    }
  }
}

// Without holes alpha is set before the rays are traced, with holes it is summed. Both give the same.
TEST(Film, AlphaOverABackgroundThatGivesLight) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path, IntegratorKind::albedo})
    for (const bool layers : {false, true})
      for (const float opacity : {1.0f, 0.25f}) {
        Scene scene = bare_scene(5);
        scene.integrator.kind = kind, scene.integrator.samples = 4;
        Material material = diffuse({0.5f, 0.5f, 0.5f});
        material.opacity = opacity;
        add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, material));
        scene.background = {0.5f, 0, 0};
        const Picture p = run(scene, [&](RenderOptions& o) { o.data_layers = layers; }).picture;
        EXPECT_EQ(value(p, "A", 0, 0), 1);
        // Flat integrators send no ray through holes.
        EXPECT_EQ(value(p, "A", 2, 2), kind == IntegratorKind::albedo ? opacity : 1);
      }
}

// The variance of the mean: sum of (x - mean)^2 over n (n - 1).
TEST(Film, VarianceIsThatOfTheMean) {
  const auto variance = [](const std::vector<float>& values) {
    const SampleBatch s = samples_of(values);
    PixelSum pixel;
    for (std::size_t i = 0; i < s.size(); ++i) add_to_pixel(pixel, s, i);
    FilmFormat format;
    format.window = {0, 0, 1, 1}, format.full_width = format.full_height = 1, format.data_layers = true;
    Picture picture = make_picture(format);
    write_pixel(picture, 0, 0, pixel);
    return value(picture, "Variance.R", 0, 0);
  };
  EXPECT_EQ(variance({5}), 0);
  EXPECT_EQ(variance({1, 3}), 1);
  EXPECT_EQ(variance({1, 3, 5}), 8 / 6.0f);
  EXPECT_EQ(variance({2, 2, 2, 2}), 0);
}

TEST(Film, IdsAreThoseOfTheSampleNearestToTheCentre) {
  const SampleBatch s = samples_of({1, 1, 1, 1, 1, 1, 1, 1});  // offsets 0.4, 0.3, ..., -0.3
  PixelSum pixel;
  for (std::size_t i = 0; i < s.size(); ++i) add_to_pixel(pixel, s, i);
  EXPECT_EQ(pixel.primitive, 4u);
  EXPECT_EQ(pixel.object, 7u);
  // Of two that are equally near, the first.
  SampleBatch two = samples_of({1, 1});
  two.offset[0] = {0.25f, 0}, two.offset[1] = {0, -0.25f};
  PixelSum tie;
  for (std::size_t i = 0; i < 2; ++i) add_to_pixel(tie, two, i);
  EXPECT_EQ(tie.primitive, 0u);
}

}  // namespace
}  // namespace oktett::film_test
