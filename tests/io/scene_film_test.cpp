/// \file Lens, filter, tone and samples in scene files.

#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett {
namespace {

using namespace test;

TEST(SceneFilm, ReadsTheLens) {
  Camera camera = SceneFiles().load_v1("camera: {aperture: 0.1, focus: 3}\n").camera;
  EXPECT_EQ(camera.aperture, 0.1);
  EXPECT_EQ(camera.focus, 3);
  EXPECT_FALSE(camera.focus_at);
  camera = SceneFiles().load_v1("camera: {from: [0, 0, 9], f_number: 2.8, focus: [1, 2, 3]}\n").camera;
  EXPECT_EQ(camera.f_number, 2.8);
  EXPECT_EQ(camera.focus_at, (Vec3d{1, 2, 3}));
}

TEST(SceneFilm, ReadsFilterToneAndClamp) {
  const Scene scene = SceneFiles().load_v1(
      "film: {filter: gaussian, filter_radius: 2, tone: filmic, exposure: -1.5}\n"
      "integrator: {kind: wire, clamp: 10}\n");
  EXPECT_EQ(scene.film.filter, FilterKind::gaussian);
  EXPECT_EQ(scene.film.filter_radius, 2);
  EXPECT_EQ(scene.film.tone, (Tone{ToneKind::filmic, -1.5}));
  EXPECT_EQ(scene.integrator.kind, IntegratorKind::wire);
  EXPECT_EQ(scene.integrator.clamp, 10);
}

TEST(SceneFilm, BadLensesAndFiltersAreErrors) {
  const auto error = [](const std::string& text) { return SceneFiles().error_v1(text); };
  expect_starts(error("camera: {aperture: -1}\n"), "scene.yaml:2:20: expected a number of at least 0");
  expect_starts(error("camera: {f_number: 0}\n"), "scene.yaml:2:20: expected a number greater than 0");
  expect_starts(error("camera: {aperture: 1, f_number: 2}\n"),
                "scene.yaml:2:9: expected 'aperture' or 'f_number', not both");
  expect_starts(error("camera: {projection: orthographic, f_number: 2}\n"),
                "scene.yaml:2:46: an orthographic view has no f-number");
  expect_starts(error("camera: {aperture: 1, focus: 0}\n"), "scene.yaml:2:30: expected a number greater");
  expect_starts(error("camera: {aperture: 1, focus: [0, 0, 6]}\n"),
                "scene.yaml:2:30: the point in focus does not lie before the camera");
  expect_starts(error("camera: {focus: [0, 1]}\n"), "scene.yaml:2:17: expected 3 numbers, found 2");
  expect_starts(error("film: {filter: gausian}\n"),
                "scene.yaml:2:16: expected box or tent or gaussian or blackman_harris, found 'gausian'; did "
                "you mean 'gaussian'?");
  expect_starts(error("film: {filter_radius: 0}\n"), "scene.yaml:2:23: expected a number");
  expect_starts(error("film: {filter_radius: 17}\n"), "scene.yaml:2:23: expected a number");
  expect_starts(error("film: {tone: sepia}\n"), "scene.yaml:2:14: expected srgb or filmic");
  expect_starts(error("film: {exposure: 65}\n"), "scene.yaml:2:18: expected a number");
  expect_starts(error("integrator: {clamp: -1}\n"), "scene.yaml:2:21: expected a number of at least 0");
}

}  // namespace
}  // namespace oktett
