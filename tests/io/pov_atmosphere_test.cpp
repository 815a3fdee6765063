// Fog, media, reflection and patterns of surfaces in POV-Ray's language: the scene files that say the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "io/pov/translate/translate.h"
#include "io/scene/pov_scene.h"
#include "io/scene/scene_file.h"
#include "io/yaml/write_yaml.h"
#include "render/picture/render.h"
#include "tests/support/temp_dir.h"

namespace oktett::pov_atmosphere_test {
namespace {

class PovAtmosphere : public testing::Test {
 protected:
  pov::TranslatedScene translate(const std::string& text) const {
    return read_pov_tree(dir.write("scene.pov", "#version 3.7;\n" + text), {}, {});
  }
  /// The value of a key of the top level in one line.
  std::string section(const std::string& text, const std::string& key) const {
    const pov::TranslatedScene scene = translate(text);
    for (std::size_t i = 0; i + 1 < scene.root->items.size(); i += 2)
      if (scene.root->items[i]->text == key) return flow_text(*scene.root->items[i + 1]);
    return "none";
  }
  std::string warnings(const std::string& text) const {
    std::string all;
    for (const Warning& w : translate(text).warnings) all += w.message + "\n";
    return all;
  }
  /// What is said of a ball behind its colour.
  std::string look(const std::string& of) const {
    const std::string text = section("sphere { 0, 1 " + of + " }", "materials");
    const std::string begin = "{material: {color: [1, 1, 1], ";
    return text.starts_with(begin) ? text.substr(begin.size(), text.size() - begin.size() - 2) : text;
  }

  test::TempDir dir;
};

TEST_F(PovAtmosphere, FogsAreFogs) {
  EXPECT_EQ(section("fog { distance 8 color rgbft <0.1, 0.3, 0.7, 0.5, 0.25> }", "fog"),
            "[{distance: 8, color: [0.1, 0.3, 0.7], filter: 0.5, transmit: 0.25}]");
  EXPECT_EQ(
      section("fog { fog_type 2 distance 8 rgb 1 fog_offset 0.5 fog_alt 2 up y rotate x*90 translate 5 }"
              " fog { distance 3 rgb 0 }",
              "fog"),
      "[{distance: 8, color: [1, 1, 1], altitude: 2, offset: 0.5, up: [0, 0, 1]}, {distance: 3, color: "
      "[0, 0, 0]}]");
  EXPECT_EQ(section("fog { rgb 1 }", "fog"), "none");
  EXPECT_EQ(section("fog { distance 1 turbulence <1, 2, 3> turb_depth 0.3 lambda 3 octaves 40 }", "fog"),
            "[{distance: 1, color: [0, 0, 0], turbulence: [1, 2, 3], noise_generator: povray_2, "
            "turbulence_depth: 0.3, octaves: 16, "
            "lambda: 3}]");
  EXPECT_EQ(warnings("fog { distance 1 turbulence 0.5 turb_depth 0.3 }"), "");
}

TEST_F(PovAtmosphere, FogDimsTheLampsThatSaySo) {
  const auto light = [&](const std::string& words) {
    return section("light_source { <0, 5, 0>, rgb 1 " + words + " }", "lights");
  };
  const std::string plain = "[{point: {position: [0, 5, 0], color: [1, 1, 1]}}]";
  EXPECT_EQ(light(""), plain);
  EXPECT_EQ(light("media_attenuation on"),
            "[{point: {position: [0, 5, 0], color: [1, 1, 1], dimmed_by_fog: true}}]");
  EXPECT_EQ(light("media_attenuation off"), plain);
  EXPECT_EQ(light("media_attenuation on media_interaction off"), plain);
}

TEST_F(PovAtmosphere, RainbowsAreRainbows) {
  EXPECT_EQ(
      section("rainbow { direction <0, -1, 1> angle 41 width 3 distance 50 arc_angle 120 falloff_angle 60 "
              "color_map { [0 rgbt <1, 0, 0, 0.5>] [1 rgbf <0, 0, 1, 0.25>] } }",
              "rainbow"),
      "[{direction: [0, -1, 1], angle: 41, width: 3, distance: 50, up: [0, 1, 0], arc: 120, falloff_arc: "
      "90, colors: [{at: 0, color: [1, 0, 0], transmit: 0.5}, {at: 1, color: [0, 0, 1], filter: "
      "0.25}]}]");
  EXPECT_EQ(section("rainbow { angle 41 }", "rainbow"), "none");
  EXPECT_NE(warnings("rainbow { angle 41 }").find("a rainbow without 'direction'"), std::string::npos);
  const Scene scene = load_scene(dir.write("bow.pov",
                                           "#version 3.7; rainbow { direction z angle 30 width 40 "
                                           "distance 3 color_map { [0 rgb 1] [1 rgb 0] } }"));
  ASSERT_EQ(scene.rainbows.size(), 1u);
  EXPECT_EQ(scene.rainbows[0].colors.size(), 2u);
}

/// `uv_mapping` of an object is that of the textures behind it.
TEST_F(PovAtmosphere, ObjectsMapTheirTexturesByUv) {
  const std::string texture = "texture { pigment { gradient x color_map { [0 rgb 0] [1 rgb 1] } } }";
  EXPECT_NE(look("uv_mapping " + texture).find("by_uv: true"), std::string::npos);
  EXPECT_NE(look("uv_mapping pigment { gradient x color_map { [0 rgb 0] [1 rgb 1] } }").find("by_uv: true"),
            std::string::npos);
  EXPECT_EQ(look(texture).find("by_uv"), std::string::npos);
  EXPECT_EQ(look("uv_mapping off " + texture).find("by_uv"), std::string::npos);
  // What moves the object before it has a texture moves patterns in space alone.
  EXPECT_NE(look("scale 2 " + texture).find("transform"), std::string::npos);
  EXPECT_EQ(look("scale 2 uv_mapping " + texture), look("uv_mapping " + texture));
}

TEST_F(PovAtmosphere, FinishesSayHowLightFallsOff) {
  EXPECT_EQ(look("pigment { rgb 1 } finish { brilliance 3 crand 0.2 }"),
            "ambient: 0.1, diffuse: 0.6, brilliance: 3, grain: 0.2");
  // Both highlights, each with its own exponent, and mirrors of another colour.
  EXPECT_EQ(look("pigment { rgb 1 } finish { phong 0.5 phong_size 20 specular 0.25 roughness 0.1 reflection "
                 "rgb <0.5, 0.25, 0> }"),
            "ambient: 0.1, diffuse: 0.6, specular: 0.5, phong: 20, specular_blinn: 0.25, blinn: 10, "
            "reflection: 0.5, reflection_color: [1, 0.5, 0]");
  // As parts of the light, of 1 (measured in POV-Ray by what a plane sends back at once).
  EXPECT_EQ(look("pigment { rgb 1 } finish { diffuse albedo 0.25 brilliance 3 }"),
            "ambient: 0.1, diffuse: 0.5, brilliance: 3");
  EXPECT_EQ(look("pigment { rgb 1 } finish { phong_size 39 phong albedo 0.01 }"),
            "ambient: 0.1, diffuse: 0.6, specular: 0.2, phong: 39");
  EXPECT_EQ(look("pigment { rgb 1 } finish { specular albedo 0.14 roughness 0.25 }"),
            "ambient: 0.1, diffuse: 0.6, specular_blinn: 0.12000000000000001, blinn: 4");
  EXPECT_EQ(look("pigment { rgb 1 } finish { brilliance 1 crand 0 specular 0 }"),
            "ambient: 0.1, diffuse: 0.6");
}

// The side from which the normal points away, here of a sphere that is cut open.
TEST_F(PovAtmosphere, InsidesHaveTheirOwnTexture) {
  const std::string ball =
      "sphere { 0, 1 pigment { rgb <1, 0, 0> } interior_texture { pigment { rgb <0, 1, 0> } } }";
  const std::string materials = section(ball, "materials");
  EXPECT_NE(materials.find("color: [0, 1, 0]"), std::string::npos) << materials;
  EXPECT_NE(materials.find("back: material"), std::string::npos) << materials;
  EXPECT_EQ(warnings(ball), "");
  const Scene scene = load_scene(dir.write("back.pov", "#version 3.7; " + ball));
  ASSERT_EQ(scene.materials.size(), 2u);
  const std::uint32_t front = scene.objects.at(0).material;
  ASSERT_NE(scene.materials[front].back, kNoId);
  EXPECT_EQ(scene.materials[front].color, (Color{1, 0, 0}));
  EXPECT_EQ(scene.materials[scene.materials[front].back].color, (Color{0, 1, 0}));
}

// In POV-Ray 3.7.0.10 `trace` finds these heights: x grows along x, y against z.
TEST_F(PovAtmosphere, HeightFieldsOfFunctionsAreMeshes) {
  const auto heights = [&](const std::string& text) {
    const pov::TranslatedScene scene = translate(text);
    EXPECT_EQ(scene.meshes.size(), 1u);
    return scene.meshes.empty() ? nullptr : scene.meshes.begin()->second;
  };
  const auto at = [](const TriangleMesh& mesh, double x, double z) {
    for (const Vec3f& v : mesh.positions)
      if (std::abs(v.x - x) < 1e-5 && std::abs(v.z - z) < 1e-5) return static_cast<double>(v.y);
    ADD_FAILURE() << "no corner at " << x << ", " << z;
    return 0.0;
  };
  const auto field = heights("height_field { function 5, 4 { x*0.5 + y*y*0.3 + 0.05 } }");
  ASSERT_TRUE(field);
  EXPECT_EQ(field->triangle_count(), 24u);
  EXPECT_NEAR(at(*field, 0, 0), 0.35, 2e-5);
  EXPECT_NEAR(at(*field, 0, 1), 0.05, 2e-5);
  EXPECT_NEAR(at(*field, 0.5, 1 / 3.0), 0.43333, 2e-5);
  EXPECT_NEAR(at(*field, 1, 1), 0.55, 2e-5);
  // The grey of the colours.
  const auto grey = heights(
      "height_field { function 4, 4 { pigment { gradient x color_map { [0 rgb <1, 0, 0>] [1 rgb <0, 1, 0.5>] "
      "} "
      "} } }");
  ASSERT_TRUE(grey);
  EXPECT_NEAR(at(*grey, 1 / 3.0, 1 / 3.0), 0.41343, 2e-4);
  EXPECT_NEAR(at(*grey, 2 / 3.0, 0), 0.52953, 2e-4);
  // A sum without end in sight is none, nor is a function without values.
  for (const char* const bad : {"sum(i, 1, 1e9, x)", "1/(x - x)"}) {
    const std::string text = std::string("height_field { function 9, 9 { ") + bad + " } }";
    EXPECT_TRUE(translate(text).meshes.empty()) << bad;
    EXPECT_NE(warnings(text).find("has no value somewhere, or takes too many steps"), std::string::npos)
        << bad;
  }
  // Below the water nothing is seen, and no sides.
  const auto wet = heights("height_field { function 2, 2 { x } smooth water_level 0.25 }");
  ASSERT_TRUE(wet);
  float least = 1;
  for (const Vec3f& v : wet->positions) least = std::min(least, v.y);
  EXPECT_NEAR(least, 0.25, 1e-6);
  // What is cut is closed by sides and a bottom.
  const auto solid = heights("intersection { height_field { function 3, 3 { 0.5 } } sphere { 0.5, 1 } }");
  ASSERT_TRUE(solid);
  EXPECT_EQ(solid->triangle_count(), 8u + 16 + 8);
}

// Beyond the unit square an image that is not repeated lets all light pass.
TEST_F(PovAtmosphere, ImagesThatAreNotRepeatedEnd) {
  dir.write("grey.ppm", "P3\n1 1\n255\n128 128 128\n");
  const std::string ball = "sphere { 0, 1 pigment { image_map { ppm \"grey.ppm\" once } } }";
  EXPECT_EQ(warnings(ball), "");
  const std::string materials = section(ball, "materials");
  EXPECT_NE(materials.find("opacity: {function: {f: "), std::string::npos) << materials;
  EXPECT_NE(materials.find("map: [[0, 1], [1, 0]]"), std::string::npos) << materials;
}

// Whether the numbers of an image are decoded depends on the kind of the file, its gamma and the version.
TEST_F(PovAtmosphere, NumbersOfImagesAreDecodedAsInPovRay) {
  dir.write("grey.img", "P3\n1 1\n255\n128 128 128\n");
  const auto decoded = [&](const std::string& settings, const std::string& kind, const std::string& gamma) {
    const std::string map = "image_map { " + kind + " \"grey.img\" " + gamma + " }";
    return section(settings + " sphere { 0, 1 pigment { " + map + " } }", "materials").find("color_space") ==
           std::string::npos;
  };
  for (const char* kind : {"png", "jpeg", "tga", "bmp", "gif"}) EXPECT_TRUE(decoded("", kind, "")) << kind;
  for (const char* kind : {"ppm", "pgm", "tiff"}) EXPECT_FALSE(decoded("", kind, "")) << kind;
  EXPECT_FALSE(decoded("", "png", "gamma 1.0"));
  EXPECT_TRUE(decoded("", "ppm", "gamma 2.2"));
  EXPECT_TRUE(decoded("", "ppm", "gamma srgb"));
  EXPECT_FALSE(decoded("#version 3.6; global_settings { assumed_gamma 1 }", "png", ""));
  EXPECT_FALSE(decoded("global_settings { assumed_gamma 2.2 }", "png", ""));
  EXPECT_FALSE(decoded("global_settings { assumed_gamma srgb }", "png", ""));
}

// Without `interpolate` each pixel is a square; heights are blended always.
TEST_F(PovAtmosphere, ImagesAreSquaresUnlessTheyAreInterpolated) {
  dir.write("grey.ppm", "P3\n1 1\n255\n128 128 128\n");
  const auto nearest = [&](const std::string& look) {
    return section("sphere { 0, 1 " + look + " }", "materials").find("filter: nearest") != std::string::npos;
  };
  EXPECT_TRUE(nearest("pigment { image_map { ppm \"grey.ppm\" } }"));
  EXPECT_TRUE(nearest("pigment { image_pattern { ppm \"grey.ppm\" } }"));
  EXPECT_FALSE(nearest("pigment { image_map { ppm \"grey.ppm\" interpolate 2 } }"));
  EXPECT_FALSE(nearest("normal { bump_map { ppm \"grey.ppm\" } }"));
}

TEST_F(PovAtmosphere, ImagesByUvAreMoved) {
  dir.write("grey.ppm", "P3\n1 1\n255\n128 128 128\n");
  const auto look = [&](const std::string& moves) {
    return section("sphere { 0, 1 pigment { uv_mapping image_map { ppm \"grey.ppm\" } " + moves + " } }",
                   "materials");
  };
  EXPECT_EQ(look("").find("projected"), std::string::npos);
  const std::string moved = look("scale 0.25");
  EXPECT_NE(moved.find("projected: {of: {file: "), std::string::npos) << moved;
  EXPECT_NE(moved.find("{transform: {scale: 0.25}}"), std::string::npos) << moved;
  EXPECT_NE(moved.find("by_uv: true"), std::string::npos) << moved;
}

/// Where POV-Ray's u and v begin and which way they run.
TEST_F(PovAtmosphere, ShapesHaveTheirOwnUv) {
  dir.write("grey.ppm", "P3\n1 1\n255\n128 128 128\n");
  const std::string image = "pigment { uv_mapping image_map { ppm \"grey.ppm\" } } }";
  for (const auto& [shape, lies] :
       {std::pair{"sphere { 0, 1 ", "scale: [1, 1], offset: [0.5, 0]"},
        {"torus { 1, 0.25 ", "scale: [-1, -1], offset: [1, 1]"},
        {"lathe { linear_spline 3 <0, 0>, <1, 1>, <0, 2> ", "scale: [-1, 1], offset: [0.75, 0]"},
        {"sor { 4 <0, -1>, <1, 0>, <1, 1>, <0, 2> ", "scale: [-1, 1], offset: [0.75, 0]"}})
    EXPECT_NE(section(shape + image, "materials").find(lies), std::string::npos)
        << section(shape + image, "materials");
  EXPECT_EQ(section("cylinder { 0, y, 1 " + image, "materials").find("offset"), std::string::npos);
  const std::string pattern = section(
      "sphere { 0, 1 pigment { uv_mapping gradient x color_map { [0 rgb 0] [1 rgb 1] } } }", "materials");
  EXPECT_NE(pattern.find("warps: [{repeat: {width: [1, 0, 0]}}]"), std::string::npos) << pattern;
}

TEST_F(PovAtmosphere, DefaultsNeedNoHash) {
  EXPECT_EQ(section("default { finish { ambient 0.5 } } sphere { 0, 1 }", "materials"),
            "{material: {color: [0, 0, 0], ambient: 0.5, diffuse: 0.6}}");
  EXPECT_EQ(warnings("default { finish { ambient 0.5 } } sphere { 0, 1 }"), "");
}

TEST_F(PovAtmosphere, OnlyHollowSolidsAreFullOfFog) {
  const std::string ball = "sphere { 0, 1 hollow }";
  EXPECT_EQ(section(ball, "objects").find("hollow"), std::string::npos);
  EXPECT_NE(section("fog { distance 1 } " + ball, "objects").find("hollow: true"), std::string::npos);
  EXPECT_EQ(section("fog { distance 1 } sphere { 0, 1 hollow off }", "objects").find("hollow"),
            std::string::npos);
}

TEST_F(PovAtmosphere, ReflectionGrowsWithTheAngle) {
  const std::string plain = "ambient: 0.1, diffuse: 0.6, ";
  EXPECT_EQ(look("pigment { rgb 1 } finish { reflection { 0.1, 0.9 falloff 3 } }"),
            plain + "reflection: 0.1, reflection_grazing: 0.9, reflection_falloff: 3");
  EXPECT_EQ(look("pigment { rgb 1 } finish { reflection { 0.1, 0.9 fresnel on } } interior { ior 1.5 }"),
            plain + "reflection: 0.1, reflection_grazing: 0.9, reflection_falloff: fresnel, ior: 1.5");
  // One colour is that at grazing angles.
  EXPECT_EQ(look("pigment { rgb 1 } finish { reflection { 0.9 fresnel on } } interior { ior 1.5 }"),
            plain + "reflection_grazing: 0.9, reflection_falloff: fresnel, ior: 1.5");
  EXPECT_EQ(
      look("pigment { rgbt 1 } finish { reflection 0.25 conserve_energy } interior { ior 1.5 }"),
      "ambient: 0, diffuse: 0, reflection: 0.25, conserve_energy: true, transparency: 1, filter: [1, 1, "
      "1], fresnel: false, ior: 1.5");
  EXPECT_EQ(warnings("sphere { 0, 1 finish { reflection { 0.5 exponent 2 } } }"),
            "'exponent of reflection' of a finish has no meaning here, and is left out\n");
}

TEST_F(PovAtmosphere, InteriorsAreMedia) {
  const auto media = [&](const std::string& interior, const char* hollow = "hollow") {
    return section("sphere { 0, 1 pigment { rgbt 1 } interior { " + interior + " } scale 2 " + hollow + " }",
                   "media");
  };
  EXPECT_EQ(media("media { emission 0.5 absorption <1, 2, 3> }"),
            "{medium: {emission: [0.5, 0.5, 0.5], absorption: [1, 2, 3]}}");
  EXPECT_EQ(media("media { emission 0.5 }", ""), "none");
  EXPECT_EQ(media("media { emission 0.5 } media { emission 1 absorption 2 }"),
            "{medium: {emission: [1.5, 1.5, 1.5], absorption: [2, 2, 2]}}");
  // A place shows the light there times the scattering, and not a part of it for each direction.
  EXPECT_EQ(media("media { scattering { 1, 0.5 extinction 1 } }"),
            "{medium: {scattering: [2, 2, 2], extinction: 0.25}}");
  EXPECT_EQ(
      media("media { emission 1 density { spherical } density { rgb 2 } }"),
      "{medium: {emission: [2, 2, 2], map_density: {spherical: {map: [[0, [0, 0, 0]], [1, [1, 1, 1]]]}}, "
      "transform: {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0]}}}");
  // Several patterns multiply each other.
  EXPECT_NE(
      media("media { emission 1 density { spherical } density { planar } }")
          .find(
              "map_density: {over: {color: [0, 0, 0], filter: {spherical: {map: [[0, [0, 0, 0]], [1, [1, 1, "
              "1]]]}}, under: {planar: {map: "),
      std::string::npos);
  EXPECT_EQ(media("fade_distance 2 fade_power 2 fade_color <0.5, 0, 1>", ""),
            "{medium: {fade: {distance: 2, power: 2, color: [0.5, 0, 1]}}}");
  EXPECT_EQ(media("fade_distance 2 fade_power 1001 fade_color <0.5, 0, 1>", ""),
            "{medium: {absorption: [0.25, 0.5, 0]}}");
  EXPECT_EQ(section("media { absorption 0.1 }", "medium"), "medium");
}

TEST_F(PovAtmosphere, PatternsAskTheSurface) {
  const auto color = [&](const std::string& pigment) {
    const std::string text = section("sphere { 0, 1 pigment { " + pigment + " } }", "materials");
    return text.substr(0, text.find(", map:"));
  };
  EXPECT_EQ(color("slope { y }"), "{material: {color: {slope: {direction: [0, 1, 0]");
  EXPECT_EQ(color("slope { -x, 0.25, 0.75 altitude 2*y, -1, 1 }"),
            "{material: {color: {slope: {direction: [-1, 0, 0], low: 0.25, high: 0.75, altitude: [0, 2, 0], "
            "altitude_low: -1, altitude_high: 1");
  EXPECT_TRUE(color("aoi").starts_with("{material: {color: {incidence: {map: [[0, [0, 0, 0]], "))
      << color("aoi");
}

/// Squares of a grid of places in the plane z = 0.3, coloured by which side of a solid they are on.
TEST_F(PovAtmosphere, ObjectsArePatternsOfTheirInsides) {
  struct Case {
    const char* solid;
    bool (*inside)(double x, double y, double z);
  };
  const Case cases[] = {
      {"sphere { <0.2, 0, 0>, 0.7 }",
       [](double x, double y, double z) { return (x - 0.2) * (x - 0.2) + y * y + z * z < 0.49; }},
      {"box { -0.5, <0.3, 0.6, 0.4> translate x*0.25 }",
       [](double x, double y, double z) {
         return x > -0.25 && x < 0.55 && y > -0.5 && y < 0.6 && z > -0.5 && z < 0.4;
       }},
      {"difference { sphere { 0, 0.8 } plane { x, 0.1 } }",
       [](double x, double y, double z) { return x * x + y * y + z * z < 0.64 && x > 0.1; }},
      {"cone { -x, 0.9, x, 0.1 scale <1, 1, 2> }",
       [](double x, double y, double z) {
         const double r = 0.5 - 0.4 * x;
         return std::abs(x) < 1 && y * y + z * z / 4 < r * r;
       }},
      {"torus { 0.6, 0.35 rotate x*90 inverse }", [](double x, double y, double z) {
         const double d = std::hypot(x, y) - 0.6;
         return d * d + z * z > 0.35 * 0.35;
       }}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.solid);
    Scene scene = load_scene(dir.write(
        "scene.pov",
        std::string(
            "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { orthographic location <0, 0, "
            "-5> direction z up 2.4*y right 2.4*x }\nplane { -z, -0.3 pigment { object { ") +
            c.solid + " rgb <0.25, 0, 0> rgb <0.75, 0, 0> } } finish { ambient 1 diffuse 0 } }\n"));
    constexpr std::uint32_t kSize = 22;
    scene.film.width = scene.film.height = kSize, scene.integrator.samples = 1;
    const Picture picture = render(scene, {}).picture;
    for (std::uint32_t k = 0; k < kSize * kSize; ++k) {
      const double x = ((k % kSize + 0.5) / kSize - 0.5) * 2.4, y = (0.5 - (k / kSize + 0.5) / kSize) * 2.4;
      EXPECT_EQ(picture.find("R")->values[k], c.inside(x, y, 0.3) ? 0.75f : 0.25f) << x << ' ' << y;
    }
  }
  EXPECT_EQ(warnings("sphere { 0, 1 pigment { object { text { ttf \"a.ttf\" \"b\" 1, 0 } rgb 1 rgb 0 } } }"),
            "pattern 'object' has no meaning here; one colour stands for it\n");
}

/// A density that is drawn on a plane at z = 0.5 shows its values and blends the last one into the first.
TEST_F(PovAtmosphere, DensityFilesArePatterns) {
  dir.write("ramp.df3", std::string("\0\4\0\1\0\1\0\63\146\314", 10));
  for (const bool smooth : {false, true}) {
    const Scene scene = load_scene(dir.write(
        "scene.pov", std::string("#version 3.7;\nglobal_settings { assumed_gamma 1 }\n"
                                 "camera { orthographic location <0.5, 0.5, -5> direction z up y*0.01 "
                                 "right x }\nplane { -z, -0.5 pigment { density_file df3 "
                                 "\"ramp.df3\" interpolate ") +
                         (smooth ? "1" : "0") + " } finish { ambient 1 diffuse 0 } }\n"));
    Scene small = scene;
    small.film.width = 20, small.film.height = 1, small.integrator.samples = 1;
    const Picture picture = render(small, {}).picture;
    const double values[] = {0, 51 / 255.0, 102 / 255.0, 204 / 255.0, 0};
    for (std::uint32_t x = 0; x < 20; ++x) {
      const double at = (x + 0.5) / 20 * 4, part = at - std::floor(at);
      const auto i = static_cast<std::size_t>(at);
      const double want = smooth ? values[i] * (1 - part) + values[i + 1] * part : values[i];
      EXPECT_NEAR(picture.find("R")->values[x], want, 1e-5) << x;
    }
  }
}

}  // namespace
}  // namespace oktett::pov_atmosphere_test
