/// \file Lens, filter, tone and samples in scene files.

#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_film_test {
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
  expect_starts(error("integrator: {cutoff: 2}\n"), "scene.yaml:2:22: expected a number from 0 to 1");
  expect_starts(error("integrator: {clamp: -1}\n"), "scene.yaml:2:21: expected a number of at least 0");
}

// Each is named with what it lacks; settings that are switched off are none.
TEST(SceneFilm, WarnsOfSettingsWithoutEffect) {
  const auto warnings = [](const std::string& integrator) {
    return SceneFiles().warnings_v1("integrator: {" + integrator + "}\n");
  };
  const std::string no_effect = " has no effect: ";
  EXPECT_EQ(warnings("kind: ao, depth: 3"),
            "scene.yaml:2:31: warning: 'depth'" + no_effect +
                "it is for 'whitted' and 'path', but the integrator is 'ao'\n");
  EXPECT_EQ(warnings("kind: path, cutoff: 0.01"), "scene.yaml:2:34: warning: 'cutoff'" + no_effect +
                                                      "it is for 'whitted', but the integrator is 'path'\n");
  EXPECT_EQ(warnings("ao_radius: 1"), "scene.yaml:2:25: warning: 'ao_radius'" + no_effect +
                                          "it is for 'ao', but the integrator is 'whitted'\n");
  EXPECT_EQ(warnings("caustics: true"), "scene.yaml:2:24: warning: 'caustics'" + no_effect +
                                            "it is for 'path', but the integrator is 'whitted'\n");
  EXPECT_EQ(warnings("kind: path, light_samples: 9"),
            "scene.yaml:2:41: warning: 'light_samples'" + no_effect +
                "it is for 'whitted', but the integrator is 'path'\n");
  EXPECT_EQ(warnings("kind: path, penumbra_factor: 4"),
            "scene.yaml:2:43: warning: 'penumbra_factor'" + no_effect +
                "it is for 'whitted', but the integrator is 'path'\n");
  EXPECT_EQ(warnings("penumbra_factor: 4"),
            "scene.yaml:2:31: warning: 'penumbra_factor'" + no_effect + "there are no 'light_samples'\n");
  EXPECT_EQ(warnings("max_samples: 64"),
            "scene.yaml:2:27: warning: 'max_samples'" + no_effect + "there is no 'error'\n");
  EXPECT_EQ(warnings("samples: 9, error: 0.1, max_samples: 17"),
            "scene.yaml:2:33: warning: 'error'" + no_effect +
                "pixels get 9 samples or at least twice as many, but 'max_samples' is 17\n");
  for (const char* used :
       {"kind: path, depth: 3, caustics: {photons: 9}", "depth: 3, light_samples: 9, penumbra_factor: 2",
        "kind: ao, ao_radius: 1", "samples: 9, error: 0.1, max_samples: 18",
        "kind: wire, ao_radius: 0, caustics: false, light_samples: 0, error: 0"})
    EXPECT_EQ(warnings(used), "") << used;
}

// Whitted's model shows lamps of some size, but they light something only with points on them.
TEST(SceneFilm, WarnsOfLampsThatLightNothing) {
  const auto warnings = [](const std::string& integrator, const std::string& lamp) {
    return SceneFiles().warnings_v1("integrator: {" + integrator + "}\nlights: [{" + lamp +
                                    "}]\nobjects: [{plane: {}}]\n");
  };
  const std::string idle =
      "warning: the light lights nothing: 'whitted' needs 'light_samples' for lights of some size\n";
  const std::string sphere = "sphere: {center: [0, 4, 0]}", point = "point: {position: [0, 4, 0]}";
  EXPECT_EQ(warnings("", sphere), "scene.yaml:3:19: " + idle);
  EXPECT_EQ(warnings("", "disk: {center: [0, 4, 0], radius: 1}"), "scene.yaml:3:17: " + idle);
  EXPECT_EQ(warnings("light_samples: 4", sphere), "");
  EXPECT_EQ(warnings("kind: path", sphere), "");
  EXPECT_EQ(warnings("kind: normal", sphere), "");
  EXPECT_EQ(warnings("", point), "");
}

TEST(SceneFilm, WarnsOfCameraSettingsWithoutEffect) {
  const auto warnings = [](const std::string& camera) {
    return SceneFiles().warnings_v1("camera: {" + camera + "}\n");
  };
  const std::string no_effect = " has no effect: ";
  EXPECT_EQ(warnings("projection: orthographic, fov: 30"),
            "scene.yaml:2:41: warning: 'fov'" + no_effect + "an orthographic view has a 'height'\n");
  EXPECT_EQ(warnings("height: 3"),
            "scene.yaml:2:18: warning: 'height'" + no_effect + "a perspective view has a 'fov'\n");
  for (const char* used : {"fov: 30", "projection: orthographic, height: 3", "aperture: 0, focus: 3",
                           "f_number: 2, focus: [0, 0, 0]"})
    EXPECT_EQ(warnings(used), "") << used;
}

TEST(SceneFilm, ReadsAdaptiveSampling) {
  const Scene scene = SceneFiles().load_v1("integrator: {error: 0.02, max_samples: 500}\n");
  EXPECT_EQ(scene.integrator.error, 0.02);
  EXPECT_EQ(scene.integrator.max_samples, 500u);
  expect_starts(SceneFiles().error_v1("integrator: {error: 2}\n"), "scene.yaml:2:21: expected a number");
  expect_starts(SceneFiles().error_v1("integrator: {max_samples: 0}\n"),
                "scene.yaml:2:27: expected a whole number from 1 to 65536");
}

TEST(SceneFilm, ReadsLightSamples) {
  EXPECT_EQ(SceneFiles().load_v1("integrator: {light_samples: 9}\n").integrator.light_samples, 9u);
  EXPECT_EQ(SceneFiles().load_v1("integrator: {}\n").integrator.light_samples, 0u);
  expect_starts(SceneFiles().error_v1("integrator: {light_samples: 1025}\n"),
                "scene.yaml:2:29: expected a whole number from 0 to 1024");
  EXPECT_EQ(SceneFiles().load_v1("integrator: {penumbra_factor: 16}\n").integrator.penumbra_factor, 16u);
  EXPECT_EQ(SceneFiles().load_v1("integrator: {}\n").integrator.penumbra_factor, 4u);
  expect_starts(SceneFiles().error_v1("integrator: {penumbra_factor: 3}\n"),
                "scene.yaml:2:31: expected 1, 2, 4, 8 or 16, found 3");
}

TEST(SceneFilm, ReadsMotions) {
  const Scene scene = SceneFiles().load_v1(
      "camera: {shutter: [0, 0.5], motion: [{time: 0, transform: []}, {time: 1, transform: {translate: [1, "
      "0, 0]}}]}\n"
      "lights:\n"
      "  - point: {position: [0, 1, 0]}\n"
      "  - point: {position: [0, 1, 0], motion: [{time: 0, transform: []}, {time: 1, transform: {translate: "
      "[0, 2, 0]}}]}\n"
      "  - sphere: {center: [0, 0, 0], radius: 1, motion: [{time: 0, transform: []}, {time: 2, transform: "
      "{scale: 3}}]}\n"
      "objects:\n"
      "  - group:\n"
      "      - sphere: {}\n"
      "        transform: {scale: 2}\n"
      "      - sphere: {}\n"
      "        motion: [{time: 0, transform: {translate: [5, 0, 0]}}, {time: 1, transform: []}]\n"
      "    motion: [{time: 0, transform: {translate: [0, 0, 1]}}, {time: 1, transform: {translate: [0, 0, "
      "3]}}]\n"
      "  - sphere: {}\n"
      "    motion: [{time: 7, transform: {scale: 4}}]\n"
      "  - sphere: {}\n"
      "    motion: [{time: 0, transform: {scale: 0.5}}, {time: 1, transform: {scale: 2}}, {time: 2, "
      "transform: {scale: 0.5}}]\n");
  EXPECT_EQ(scene.camera.shutter[1], 0.5);
  ASSERT_NE(scene.camera.motion, nullptr);
  EXPECT_EQ(scene.camera.motion->at(0.5), Affine::translation({0.5, 0, 0}));
  ASSERT_EQ(scene.light_traits.size(), 2u);
  EXPECT_EQ(scene.light_traits[0].motion, nullptr);
  EXPECT_EQ(scene.light_traits[1].motion->at(1), Affine::translation({0, 2, 0}));
  ASSERT_EQ(scene.objects.size(), 5u);
  EXPECT_EQ(scene.objects[4].motion->at(1), Affine::scaling({2, 2, 2}));
  EXPECT_EQ(scene.objects[0].motion->at(2), Affine::scaling({3, 3, 3}));
  EXPECT_EQ(scene.objects[1].motion->at(1), Affine::translation({0, 0, 3}) * Affine::scaling({2, 2, 2}));
  EXPECT_EQ(scene.objects[1].transform, Affine::translation({0, 0, 1}) * Affine::scaling({2, 2, 2}));
  EXPECT_EQ(scene.objects[2].motion->at(0), Affine::translation({5, 0, 1}));
  EXPECT_EQ(scene.objects[2].motion->at(1), Affine::translation({0, 0, 3}));
  // A single key is a transform.
  EXPECT_EQ(scene.objects[3].motion, nullptr);
  EXPECT_EQ(scene.objects[3].transform, Affine::scaling({4, 4, 4}));
}

TEST(SceneFilm, BadMotionsAreErrors) {
  const auto error = [](const std::string& motion) {
    return SceneFiles().error_v1("objects:\n  - sphere: {}\n    motion: " + motion + "\n");
  };
  expect_starts(error("[]"), "scene.yaml:4:13: a motion needs at least one key");
  expect_starts(error("{time: 0}"), "scene.yaml:4:13: expected a list for motion");
  expect_starts(error("[{time: 0}]"), "scene.yaml:4:14: a key of a motion needs 'transform'");
  expect_starts(error("[{time: 1, transform: []}, {time: 1, transform: []}]"),
                "scene.yaml:4:47: the times of a motion must ascend: expected more than 1");
  expect_starts(error("[{time: 0, transform: {scale: 0}}]"), "scene.yaml:4:35: the transform is singular");
  expect_starts(error("[{time: 0, transform: []}, {time: 1, transform: {scale: -1}}]"),
                "scene.yaml:4:61: a motion cannot turn a thing into its mirror image");
  expect_starts(
      SceneFiles().error_v1("objects:\n  - sphere: {}\n    transform: {scale: 2}\n    motion: []\n"),
      "scene.yaml:5:13: expected 'transform' or 'motion', not both");
  const std::string moving = "motion: [{time: 0, transform: []}, {time: 1, transform: {scale: 2}}]";
  expect_starts(SceneFiles().error_v1("define:\n  a:\n    sphere: {}\n    " + moving + "\n"),
                "scene.yaml:5:13: what is in a prototype cannot move by itself");
  expect_starts(SceneFiles().error_v1("objects:\n  - union:\n      - sphere: {}\n        " + moving + "\n"),
                "scene.yaml:5:17: what is in a combination cannot move by itself");
  expect_starts(SceneFiles().error_v1("camera: {shutter: [1, 0]}\n"),
                "scene.yaml:2:19: the shutter closes before it opens");
}

}  // namespace
}  // namespace oktett::scene_film_test
