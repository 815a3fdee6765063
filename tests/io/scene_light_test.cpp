/// \file Lights and principled materials in scene files.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "io/image/image.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_light_test {
namespace {

using namespace test;

/// Expects the error that the file gives to hold `text`.
void expect_error(const std::string& file, const std::string& text) {
  const std::string error = SceneFiles().error_v1(file);
  EXPECT_NE(error.find(text), std::string::npos) << error;
}

TEST(SceneLight, ReadsLampsWithoutArea) {
  const Scene scene = SceneFiles().load_v1(
      "lights:\n"
      "  - point: {position: [1, 2, 3], intensity: [3, 6, 9]}\n"
      "  - spot: {position: [0, 5, 0], at: [0, 1, 3], color: [1, 2, 3], outer_angle: 20}\n"
      "  - spot: {position: [0, 5, 0], direction: [0, -2, 0], inner_angle: 5, outer_angle: 6}\n"
      "  - directional: {direction: [1, -1, 0], irradiance: [1, 1, 1], angle: 0.5}\n"
      "  - sky: {sun: [0, 1, 2], turbidity: 4, ground: [0.1, 0.2, 0.3], color: [1, 1, 1]}\n");
  ASSERT_EQ(scene.lights.size(), 5u);
  const auto& point = std::get<PointLight>(scene.lights[0]);
  EXPECT_NEAR(static_cast<double>(point.color.y), 6 / std::numbers::pi, 1e-6);
  EXPECT_TRUE(point.falloff);
  const auto& spot = std::get<SpotLight>(scene.lights[1]);
  EXPECT_EQ(spot.direction, (Vec3d{0, -4, 3}));
  EXPECT_EQ(spot.color, (Color{1, 2, 3}));
  EXPECT_EQ(spot.outer_angle, 20);
  EXPECT_EQ(spot.inner_angle, 15);
  EXPECT_EQ(std::get<SpotLight>(scene.lights[2]).inner_angle, 5);
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[3]).angle, 0.5);
  EXPECT_NEAR(static_cast<double>(std::get<DirectionalLight>(scene.lights[3]).color.x), 1 / std::numbers::pi,
              1e-6);
  const auto& sky = std::get<SkyLight>(scene.lights[4]);
  EXPECT_EQ(sky.sun, (Vec3d{0, 1, 2}));
  EXPECT_EQ(sky.turbidity, 4);
  EXPECT_EQ(sky.ground, (Color{0.1f, 0.2f, 0.3f}));
}

TEST(SceneLight, ReadsFadesAndLightsWithoutShadows) {
  const Scene scene = SceneFiles().load_v1(
      "lights:\n"
      "  - point: {position: [1, 2, 3], fade: {distance: 4, power: 3}}\n"
      "  - spot: {position: [0, 5, 0], fade: {distance: 2}, tightness: 5, shadows: false}\n"
      "  - directional: {highlights: false, dimmed_by_fog: true, from: [1, 2, 3], fade: {distance: 5}, beam: "
      "{outer_radius: 2}}\n"
      "  - point: {position: [1, 2, 3]}\n");
  ASSERT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).fade, (LightFade{4, 3}));
  EXPECT_FALSE(std::get<PointLight>(scene.lights[0]).falloff);
  const auto& spot = std::get<SpotLight>(scene.lights[1]);
  EXPECT_EQ(spot.fade, (LightFade{2, 2}));
  EXPECT_EQ(spot.tightness, 5);
  EXPECT_FALSE(spot.falloff);
  EXPECT_FALSE(scene.light_traits[1].shadows);
  EXPECT_TRUE(scene.light_traits[1].highlights);
  EXPECT_FALSE(scene.light_traits[2].highlights);
  EXPECT_FALSE(scene.light_traits[1].dimmed_by_fog);
  EXPECT_TRUE(scene.light_traits[2].dimmed_by_fog);
  const auto& far = std::get<DirectionalLight>(scene.lights[2]);
  EXPECT_EQ(far.from, (Vec3d{1, 2, 3}));
  EXPECT_EQ(far.fade, (LightFade{5, 2}));
  EXPECT_EQ(far.beam, (LightBeam{2, 0, 0}));
  EXPECT_FALSE(std::get<PointLight>(scene.lights[3]).fade.fades());
  expect_error("lights: [point: {position: [1, 2, 3], fade: {power: 3}}]", "a fade needs 'distance'");
  expect_error("lights: [point: {position: [1, 2, 3], fade: {distance: 3}, falloff: true}]",
               "expected 'fade' or 'falloff', not both");
  expect_error("lights: [point: {position: [1, 2, 3], fade: {distance: 3}, power: [1, 1, 1]}]",
               "expected 'fade' or 'power', not both");
  expect_error("lights: [directional: {beam: {outer_radius: 1}}]",
               "'beam' counts from a place: 'from' is missing");
  expect_error("lights: [directional: {from: [0, 0, 0], beam: {outer_radius: 1, inner_radius: 2}}]",
               "'inner_radius' is greater than 'outer_radius'");
  expect_error("lights: [spot: {position: [1, 2, 3], tightness: -1}]", "expected a number of at least 0");
  expect_error("lights: [spot: {position: [1, 2, 3], tightness: 1, power: [1, 1, 1]}]",
               "expected 'tightness' or 'power', not both");
  const Scene path =
      SceneFiles().load_v1("integrator: {kind: path}\nlights: [directional: {shadows: false}]\n");
  ASSERT_EQ(path.warnings.size(), 1u);
  EXPECT_NE(to_string(path.warnings[0]).find("all light of 'path' has shadows"), std::string::npos);
}

// A lamp with an area is an object that glows. Its power is pi * area * radiance.
TEST(SceneLight, LampsWithAnAreaAreObjects) {
  const Scene scene = SceneFiles().load_v1(
      "lights:\n"
      "  - sphere: {center: [1, 2, 3], radius: 2, power: [10, 20, 30]}\n"
      "  - disk: {center: [0, 1, 0], radius: 0.5, radiance: [5, 6, 7]}\n"
      "  - rectangle: {corner: [0, 0, 0], u: [2, 0, 0], v: [0, 0, 3], power: [6, 6, 6]}\n");
  EXPECT_TRUE(scene.lights_given);
  EXPECT_TRUE(scene.lights.empty());
  ASSERT_EQ(scene.objects.size(), 3u);
  const auto emission = [&](std::size_t i) { return scene.materials.at(scene.objects[i].material).emission; };
  EXPECT_NEAR(static_cast<double>(emission(0).y), 20 / (std::numbers::pi * 16 * std::numbers::pi), 1e-6);
  EXPECT_EQ(emission(1), (Color{5, 6, 7}));
  EXPECT_NEAR(static_cast<double>(emission(2).x), 1 / std::numbers::pi, 1e-6);
  EXPECT_EQ(std::get<DiskShape>(scene.objects[1].shape).normal, (Vec3d{0, -1, 0}));
  EXPECT_EQ(std::get<PolygonShape>(scene.objects[2].shape).vertices[2], (Vec3d{2, 0, 3}));
  EXPECT_FALSE(scene.materials[scene.objects[1].material].emits_behind);
}

// The power of a spot is the integral of its intensity over its cone, which fades by t^2 (3 - 2 t).
TEST(SceneLight, PowerOfSpots) {
  for (const auto& [inner, outer] : {std::pair{20.0, 50.0}, {0.0, 180.0}, {30.0, 30.0}}) {
    const Scene scene = SceneFiles().load_v1(fmt::format(
        "lights: [{{spot: {{position: [0, 0, 0], power: [1, 2, 3], inner_angle: {}, outer_angle: {}}}}}]\n",
        inner, outer));
    const auto& light = std::get<SpotLight>(scene.lights.at(0));
    const double degree = std::numbers::pi / 180, from = std::cos(outer * degree),
                 to = std::cos(inner * degree);
    double flux = 0;
    const int steps = 100000;
    for (int i = 0; i < steps; ++i) {
      const double cosine = -1 + (i + 0.5) * 2 / steps;
      const double t = cosine >= to ? 1 : cosine <= from ? 0 : (cosine - from) / (to - from);
      flux += t * t * (3 - 2 * t) * 2 * std::numbers::pi * 2 / steps;
    }
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(static_cast<double>(light.color[k]) * std::numbers::pi * flux, k + 1, 1e-3) << inner;
  }
  expect_error("lights: [{spot: {position: [0, 0, 0], power: [1, 1, 1], color: [1, 1, 1]}}]\n",
               "not two of them");
}

TEST(SceneLight, ReadsEnvironments) {
  SceneFiles files;
  Picture picture;
  picture.width = 4, picture.height = 2;
  for (const char* name : {"R", "G", "B"}) {
    PicturePlane& plane = picture.planes.emplace_back();
    plane.name = name, plane.type = PlaneType::single_float;
    for (int i = 0; i < 8; ++i)
      plane.values.push_back(static_cast<float>(10 * i) + (name[0] == 'G' ? 1.0f : 0.0f));
  }
  write_image(files.dir.file("sky.exr"), picture);
  const Scene scene =
      files.load_v1("lights: [{environment: {file: sky.exr, rotate: 90, color: [1, 2, 3]}}]\n");
  const auto& light = std::get<EnvironmentLight>(scene.lights.at(0));
  EXPECT_EQ(light.rotation, 90);
  EXPECT_EQ(light.color, (Color{1, 2, 3}));
  ASSERT_EQ(light.picture->width, 4u);
  ASSERT_EQ(light.picture->height, 2u);
  EXPECT_EQ(light.picture->pixels[5], (Color{50, 51, 50}));
}

TEST(SceneLight, ErrorsSayWhatIsExpected) {
  expect_error("lights: [{lamp: {}}]\n", "unknown key 'lamp' in a light");
  expect_error("lights: [{point: {position: [0, 0, 0]}, sky: {}}]\n", "expected one of point");
  expect_error("lights: [{point: {position: [0, 0, 0], color: [1, 1, 1], intensity: [1, 1, 1]}}]\n",
               "expected 'color' or 'intensity'");
  expect_error("lights: [{point: {position: [0, 0, 0], color: [-1, 1, 1]}}]\n", "at least 0");
  expect_error("lights: [{spot: {position: [0, 0, 0], at: [0, 0, 0]}}]\n", "stands where it points to");
  expect_error("lights: [{spot: {position: [0, 0, 0], inner_angle: 50}}]\n", "greater than 'outer_angle'");
  expect_error("lights: [{sphere: {center: [0, 0, 0], radius: 0}}]\n", "greater than 0");
  expect_error("lights: [{sphere: {center: [0, 0, 0], power: [1, 1, 1], radiance: [1, 1, 1]}}]\n",
               "expected 'radiance' or 'power'");
  expect_error("lights: [{rectangle: {corner: [0, 0, 0], u: [1, 0, 0], v: [1, 1, 0]}}]\n", "perpendicular");
  expect_error("lights: [{rectangle: {corner: [0, 0, 0], u: [0, 0, 0], v: [1, 1, 0]}}]\n",
               "must not be zero");
  expect_error("lights: [{environment: {file: missing.exr}}]\n", "missing.exr");
  expect_error("lights: [{sky: {turbidity: 20}}]\n", "from 2 to 10");
  SceneFiles files;
  files.dir.write("broken.exr", "no picture");
  EXPECT_THROW(files.load_v1("lights: [{environment: {file: broken.exr}}]\n"), Error);
}

TEST(SceneMaterial, ReadsPrincipledOnes) {
  SceneFiles files;
  files.dir.write("a.png", "x"), files.dir.write("b.png", "x");
  const Scene scene = files.load_v1(
      "materials:\n"
      "  all:\n"
      "    principled: {base_color: [0.1, 0.2, 0.3], metallic: 0.25, roughness: {file: a.png, gain: 0.5},\n"
      "      specular: 0.75, ior: 1.25, transmission: 0.5, thin: true, coat: 1, coat_roughness: 0.125,\n"
      "      coat_ior: 1.75, sheen: 0.375, sheen_color: {file: b.png}, sheen_roughness: 0.625,\n"
      "      specular_color: [0.5, 2, 0], specular_weight: 0.375,\n"
      "      anisotropy: 0.25, anisotropy_rotation: 30, map_anisotropy: a.png, iridescence: {file: a.png},\n"
      "      iridescence_ior: 1.75, iridescence_thickness: 300,\n"
      "      map_coat_normal: b.png, coat_normal_scale: 0.5, eta: [1, 2, 3], k: [4, 5, 6]}\n"
      "    emission: [1, 1, 0]\n"
      "    emits: front\n");
  const Material& m = scene.materials.at(0);
  ASSERT_TRUE(m.principled);
  const PrincipledParameters& p = m.principled->parameters;
  EXPECT_EQ(p.base_color, (Color{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(p.metallic, 0.25f);
  EXPECT_EQ(p.roughness, 1);
  EXPECT_EQ(scene.textures.at(m.principled->roughness_texture).path, files.dir.file("a.png"));
  EXPECT_EQ(scene.textures.at(m.principled->roughness_texture).gain, 0.5f);
  EXPECT_EQ(p.specular, 0.75f);
  EXPECT_EQ(p.specular_color, (Color{0.5f, 2, 0}));
  EXPECT_EQ(p.specular_weight, 0.375f);
  EXPECT_EQ(scene.textures.at(m.principled->coat_normal_texture).path, files.dir.file("b.png"));
  EXPECT_EQ(m.principled->coat_normal_scale, 0.5f);
  EXPECT_FALSE(m.principled->even_coat);
  EXPECT_EQ(p.anisotropy, 0.25f);
  EXPECT_EQ(m.principled->anisotropy_rotation, 30);
  EXPECT_EQ(scene.textures.at(m.principled->anisotropy_direction_texture).path, files.dir.file("a.png"));
  EXPECT_EQ(scene.textures.at(m.principled->iridescence_texture).path, files.dir.file("a.png"));
  EXPECT_EQ(p.iridescence, 1);
  EXPECT_EQ(p.iridescence_ior, 1.75f);
  EXPECT_EQ(p.iridescence_thickness, 300);
  EXPECT_EQ(p.ior, 1.25f);
  EXPECT_EQ(p.transmission, 0.5f);
  EXPECT_TRUE(p.thin);
  EXPECT_EQ(p.coat, 1);
  EXPECT_EQ(p.coat_roughness, 0.125f);
  EXPECT_EQ(p.coat_ior, 1.75f);
  EXPECT_EQ(p.sheen, 0.375f);
  EXPECT_EQ(p.sheen_color, (Color{1, 1, 1}));
  EXPECT_EQ(scene.textures.at(m.principled->sheen_color_texture).path, files.dir.file("b.png"));
  EXPECT_EQ(p.sheen_roughness, 0.625f);
  ASSERT_TRUE(p.conductor);
  EXPECT_EQ(p.conductor->eta, (Color{1, 2, 3}));
  EXPECT_EQ(p.conductor->k, (Color{4, 5, 6}));
  EXPECT_EQ(m.emission, (Color{1, 1, 0}));
  EXPECT_FALSE(m.emits_behind);
}

/// The rows of the published tables on both sides of 630, 532 and 467 nm.
struct MeasuredMetal {
  const char* name;
  Conductor below, above;  ///< by wavelength
};
constexpr MeasuredMetal kMeasured[] = {
    {"gold",
     {{0.21f, 0.62f, 1.38f}, {3.272f, 2.081f, 1.914f}},
     {{0.14f, 0.43f, 1.31f}, {3.697f, 2.455f, 1.849f}}},
    {"silver",
     {{0.06f, 0.05f, 0.04f}, {4.152f, 3.324f, 2.657f}},
     {{0.05f, 0.06f, 0.05f}, {4.483f, 3.586f, 2.869f}}},
    {"copper",
     {{0.3f, 1.18f, 1.24f}, {3.205f, 2.608f, 2.397f}},
     {{0.22f, 1.02f, 1.25f}, {3.747f, 2.577f, 2.483f}}},
    {"aluminium",
     {{1.366f, 0.8734f, 0.6079f}, {7.4052f, 6.2418f, 5.3676f}},
     {{1.5724f, 1.0728f, 0.7278f}, {7.7354f, 6.7839f, 5.7781f}}},
    {"iron", {{2.88f, 2.86f, 2.59f}, {3.05f, 2.91f, 2.77f}}, {{2.92f, 2.95f, 2.67f}, {3.1f, 2.93f, 2.82f}}},
    {"nickel",
     {{1.99f, 1.85f, 1.73f}, {4.02f, 3.42f, 2.95f}},
     {{1.99f, 1.92f, 1.78f}, {4.26f, 3.61f, 3.09f}}},
    {"chromium",
     {{3.17f, 2.94f, 2.33f}, {3.3f, 3.33f, 3.14f}},
     {{3.09f, 3.18f, 2.51f}, {3.34f, 3.33f, 3.24f}}},
    {"titanium",
     {{2.67f, 2.44f, 2.27f}, {3.72f, 3.3f, 3.04f}},
     {{2.76f, 2.54f, 2.32f}, {3.84f, 3.43f, 3.1f}}}};

TEST(SceneMaterial, MetalsLieBetweenTheRowsOfTheirTables) {
  for (const MeasuredMetal& measured : kMeasured) {
    const Scene scene =
        SceneFiles().load_v1(std::string("materials: {a: {principled: {metal: ") + measured.name + "}}}\n");
    const Material& m = scene.materials.at(0);
    const PrincipledParameters& p = m.principled->parameters;
    ASSERT_TRUE(p.conductor);
    EXPECT_EQ(p.metallic, 1);
    EXPECT_EQ(p.base_color, m.color);
    for (int c = 0; c < 3; ++c) {
      SCOPED_TRACE(std::string(measured.name) + std::to_string(c));
      const auto expect_between = [](float x, float a, float b) {
        EXPECT_GE(x, std::min(a, b) - 5e-4f);
        EXPECT_LE(x, std::max(a, b) + 5e-4f);
      };
      expect_between(p.conductor->eta[c], measured.below.eta[c], measured.above.eta[c]);
      expect_between(p.conductor->k[c], measured.below.k[c], measured.above.k[c]);
      const float n = p.conductor->eta[c], k = p.conductor->k[c];
      EXPECT_NEAR(m.color[c], ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k), 1e-5f);
    }
  }
  const Scene other = SceneFiles().load_v1(
      "materials: {a: {principled: {metal: gold, metallic: 0.5, base_color: [1, 0, 0]}}}\n");
  EXPECT_EQ(other.materials.at(0).color, (Color{1, 0, 0}));
  EXPECT_EQ(other.materials.at(0).principled->parameters.metallic, 0.5f);
}

TEST(SceneLight, HasAGroup) {
  SceneFiles files;
  const Scene scene = files.load_v1(
      "lights:\n"
      "  - point: {position: [0, 1, 0], light_group: key}\n"
      "  - sky: {}\n"
      "  - spot: {position: [0, 1, 0], light_group: default}\n"
      "  - directional: {light_group: rim,\n"
      "      motion: [{time: 0, transform: []}, {time: 1, transform: {rotate: [0, 0, 90]}}]}\n"
      "  - sphere: {center: [0, 3, 0], light_group: key}\n"
      "materials: {a: {emission: [1, 1, 1], light_group: a-1_B}, b: {}}\n");
  ASSERT_EQ(scene.lights.size(), 4u);
  ASSERT_EQ(scene.light_traits.size(), 4u);
  EXPECT_EQ(scene.light_traits[0].group, "key");
  EXPECT_EQ(scene.light_traits[1].group, "");
  EXPECT_EQ(scene.light_traits[2].group, "");
  EXPECT_EQ(scene.light_traits[3].group, "rim");
  EXPECT_NE(scene.light_traits[3].motion, nullptr);
  EXPECT_EQ(scene.materials[scene.objects.at(0).material].light_group, "key");
  std::set<std::string> groups;
  for (const Material& m : scene.materials) groups.insert(m.light_group);
  EXPECT_EQ(groups, (std::set<std::string>{"", "key", "a-1_B"}));
}

TEST(SceneLight, IntensityAndPowerAreThoseOfFalloff) {
  expect_error("lights: [{point: {position: [0, 0, 0], power: [1, 1, 1], falloff: false}}]\n",
               "'power' is that of a light that falls off; expected 'falloff: true', or 'color'");
  expect_error("lights: [{point: {position: [0, 0, 0], intensity: [1, 1, 1], falloff: false}}]\n",
               "'intensity' is that of a light that falls off");
  EXPECT_EQ(SceneFiles()
                .load_v1("lights: [{point: {position: [0, 0, 0], power: [1, 1, 1], falloff: true}}]\n")
                .lights.size(),
            1u);
}

TEST(SceneLight, RefusesOddGroups) {
  for (const char* name : {"a.b", "'a b'", "''", "\u00e4", "a/b"})
    expect_error(std::string("lights: [{point: {position: [0, 0, 0], light_group: ") + name + "}}]\n",
                 "letters, digits");
  std::string many = "lights:\n";
  for (int i = 1; i <= 64; ++i)
    many += "  - point: {position: [0, 0, 0], light_group: g" + std::to_string(i) + "}\n";
  expect_error(many, "more than 63 light groups");
  const auto named = [](std::size_t length) {
    return "lights: [{point: {position: [0, 0, 0], light_group: " + std::string(length, 'g') + "}}]\n";
  };
  // EXR files hold names of up to 255 characters, and a layer is light_NAME.R.
  EXPECT_EQ(SceneFiles().load_v1(named(247)).light_traits.at(0).group, std::string(247, 'g'));
  expect_error(named(248), "a light group's name has at most 247 characters");
  expect_error("lights: [{point: {position: [0, 0, 0], group: a}}]\n", "unknown key 'group'");
  expect_error("materials: {a: {light_group: [a]}}\n", "expected text");
}

TEST(SceneMaterial, RoughnessAndMetallicMakeItPrincipled) {
  const Scene scene = SceneFiles().load_v1(
      "materials:\n  a: {color: [1, 0, 0], ior: 1.25, transparency: 0.5, metallic: 0.75}\n  b: {color: [1, "
      "0, 0]}\n");
  ASSERT_TRUE(scene.materials[0].principled);
  const PrincipledParameters& p = scene.materials[0].principled->parameters;
  EXPECT_EQ(p.base_color, (Color{1, 0, 0}));
  EXPECT_EQ(p.metallic, 0.75f);
  EXPECT_EQ(p.ior, 1.25f);
  EXPECT_EQ(p.transmission, 0.5f);
  EXPECT_FALSE(scene.materials[1].principled);
}

// An index of refraction makes a metal, by name or by numbers.
TEST(SceneMaterial, EtaAndKMakeItMetal) {
  const auto read = [](const std::string& keys) {
    return SceneFiles().load_v1("materials: {a: {principled: {" + keys + "}}}\n");
  };
  const std::string copper = "eta: [0.275, 1.116, 1.248], k: [3.373, 2.596, 2.465]";
  EXPECT_EQ(read(copper).materials[0], read("metal: copper").materials[0]);
  EXPECT_EQ(read(copper).materials[0].principled->parameters.metallic, 1);
  EXPECT_EQ(read(copper + ", metallic: 0.5").materials[0].principled->parameters.metallic, 0.5f);
  EXPECT_TRUE(read(copper + ", metallic: 0.5").warnings.empty());
  const Scene none = read(copper + ", metallic: 0");
  ASSERT_EQ(none.warnings.size(), 1u);
  EXPECT_NE(to_string(none.warnings[0]).find(":2:"), std::string::npos);
  EXPECT_NE(none.warnings[0].message.find("without metal"), std::string::npos);
}

TEST(SceneMaterial, WarnsOfKeysOfMaterialsWithoutEffect) {
  const auto warnings = [](const std::string& material) {
    SceneFiles files;
    files.dir.write("x.png", "");
    return files.warnings_v1("materials: {m: {" + material + "}}\nobjects: [{sphere: {}, material: m}]\n");
  };
  const std::string no_effect = " has no effect: ";
  EXPECT_EQ(warnings("map_emission: x.png"), "scene.yaml:2:31: warning: 'map_emission'" + no_effect +
                                                 "'emission', which it multiplies, is black\n");
  EXPECT_EQ(warnings("emits: front"),
            "scene.yaml:2:24: warning: 'emits'" + no_effect + "'emission' is black\n");
  EXPECT_EQ(warnings("light_group: a"),
            "scene.yaml:2:30: warning: 'light_group'" + no_effect + "'emission' is black\n");
  EXPECT_EQ(warnings("map_specular: x.png"), "scene.yaml:2:31: warning: 'map_specular'" + no_effect +
                                                 "'specular', 'reflection' and 'transparency' are 0\n");
  EXPECT_EQ(warnings("bump_scale: 2"),
            "scene.yaml:2:29: warning: 'bump_scale'" + no_effect + "there is no 'map_bump'\n");
  for (const char* used :
       {"emission: [1, 1, 1], map_emission: x.png, emits: front, light_group: a",
        "specular: 0.5, map_specular: x.png", "reflection: {file: x.png}, map_specular: x.png",
        "map_bump: x.png, bump_scale: 2"})
    EXPECT_EQ(warnings(used), "") << used;
}

TEST(SceneMaterial, ErrorsOfPrincipledOnes) {
  expect_error("materials: {a: {principled: {rough: 1}}}\n", "unknown key 'rough'");
  expect_error("materials: {a: {principled: {ior: 0}}}\n", "0.25");
  expect_error("materials: {a: {principled: {roughness: 2}}}\n", "from 0 to 1");
  expect_error("materials: {a: {principled: {base_color: [-1, 0, 0]}}}\n", "at least 0");
  expect_error("materials: {a: {principled: {eta: [1, 1, 1]}}}\n", "both 'eta' and 'k'");
  expect_error("materials: {a: {principled: {metal: tin}}}\n", "titanium");
  expect_error("materials: {a: {principled: {metal: gold, eta: [1, 1, 1], k: [1, 1, 1]}}}\n", "not both");
  expect_error("materials: {a: {principled: {eta: [1, 0, 1], k: [1, 1, 1]}}}\n", "greater than 0");
  expect_error("materials: {a: {principled: {}, phong: 3}}\n", "'phong' has no meaning beside 'principled'");
  expect_error("materials: {a: {emits: left}}\n", "front");
  expect_error("materials: {a: {principled: {roughness: {file: missing.png}}}}\n", "missing.png");
}

}  // namespace
}  // namespace oktett::scene_light_test
