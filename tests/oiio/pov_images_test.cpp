#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/scene/pov_scene.h"
#include "tests/io/pov_pixel.h"
#include "tests/oiio/image_support.h"
#include "tests/support/temp_dir.h"

// Images in POV-Ray's scenes. What was seen by running POV-Ray 3.7.0.10 stands below.

namespace oktett::pov_images_test {
namespace {

using test::TempDir;
using Bytes = std::vector<std::uint8_t>;

/// The colour of the middle of a picture that looks along z.
Vec3f middle(const TempDir& dir, const std::string& text) {
  return test::pixel_of(dir.write(
      "scene.pov",
      "#version 3.7; global_settings { assumed_gamma 1 } camera { location -9*z look_at 0 angle 1 } "
      "plane { -z, -3 pigment { rgb <1, 1, .5> } finish { ambient 1 diffuse 0 } } " +
          text));
}

TEST(PovImages, AlphaLetsLightPass) {
  const TempDir dir;
  test::write_pixels(dir.file("clear.png"), 1, 1, 4, Bytes{204, 102, 51, 64});
  test::write_pixels(dir.file("opaque.png"), 1, 1, 4, Bytes{204, 102, 51, 255});
  const std::string glows = " finish { ambient 1 diffuse 0 } no_shadow } ";
  const auto expect = [&](const std::string& text, const Vec3f& seen) {
    const Vec3f shown = middle(dir, text);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(shown[k], seen[k], 1e-4f) << text;
  };
  const auto image = [](const std::string& words) {
    return "image_map { png \"clear.png\" " + words + " } ";
  };
  const Vec3f seen{0.8260929f, 0.6193485f, 0.2950485f};
  expect("box { -1, 1 pigment { " + image("") + "}" + glows, seen);
  expect("box { -1, 1 pigment { " + image("interpolate 2") + "}" + glows, seen);
  expect("box { -1, 1 pigment { " + image("once") + " translate -.5 }" + glows, seen);
  expect("sphere { 0, 1 pigment { uv_mapping " + image("") + "}" + glows, seen);
  expect(
      "sphere { 0, 1 pigment { checker pigment { " + image("") + "} pigment { rgb z } translate .3 }" + glows,
      seen);
  expect("box { -1, 1 pigment { image_map { png \"opaque.png\" } }" + glows,
         {0.60383f, 0.1328756f, 0.0331121f});
  expect("box { -1, 1 pigment { " + image("filter all .2") + "}" + glows,
         {0.8140841f, 0.6135653f, 0.2884566f});
  expect("box { -1, 1 pigment { " + image("transmit all .2") + "}" + glows,
         {0.9606317f, 0.9138476f, 0.453605f});
  const std::string lamp = "light_source { <0, 0, -9> 1 } ", scatters = " finish { ambient 0 diffuse 1 } } ";
  expect(lamp + "box { -1, 1 texture { pigment { rgb x }" + scatters + "texture { pigment { " + image("") +
             "}" + scatters + "}",
         {0.9005722f, 0.033341f, 0.0083163f});
  expect(
      "box { -1, 1 pigment { image_pattern { png \"clear.png\" use_alpha } color_map { [0 rgb x] [1 rgb y] } "
      "}" +
          glows,
      {0.2509804f, 0.7490196f, 0});
}

TEST(PovImages, ColoursAreHighAndLowBytesOfHeights) {
  const TempDir dir;
  test::write_pixels(dir.file("heights.png"), 2, 3, 3,
                     Bytes{1, 2, 0, 3, 4, 9, 5, 6, 1, 255, 255, 0, 0, 7, 0, 7, 0, 3});
  const auto heights = [&](const std::string& words) {
    const Scene scene = load_scene(
        dir.write("scene.pov", "#version 3.7; height_field { png \"heights.png\" " + words + " }"));
    return *std::get<MeshShape>(scene.objects.at(0).shape).mesh;
  };
  const TriangleMesh mesh = heights("");
  EXPECT_EQ(mesh.triangle_count(), 4u);
  const std::vector<Vec3f> expected{{0, 7, 0},       {1, 1792, 0}, {0, 1286, 0.5f},
                                    {1, 65535, .5f}, {0, 258, 1},  {1, 772, 1}};
  ASSERT_EQ(mesh.positions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(mesh.positions[i].x, expected[i].x);
    EXPECT_NEAR(mesh.positions[i].y * 65535, expected[i].y, 0.01f);
    EXPECT_EQ(mesh.positions[i].z, expected[i].z);
  }
  EXPECT_EQ(heights("smooth").normals.size(), expected.size());
}

}  // namespace
}  // namespace oktett::pov_images_test
