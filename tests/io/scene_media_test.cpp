/// \file Media, interiors and priorities in scene files.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "io/volume/vdb_file.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_media_test {
namespace {

using namespace test;

void expect_error(const std::string& file, const std::string& text) {
  const std::string error = SceneFiles().error_v1(file);
  EXPECT_NE(error.find(text), std::string::npos) << error;
}

TEST(SceneMedia, ReadsMediaAndInteriors) {
  const Scene scene = SceneFiles().load_v1(
      "media:\n"
      "  smoke: {absorption: [1, 2, 3], scattering: [4, 5, 6], density: 0.5, anisotropy: -0.3}\n"
      "  flame: {emission: [1, 0.5, 0]}\n"
      "  fog: {scattering: [0.1, 0.1, 0.1]}\n"
      "medium: fog\n"
      "materials:\n"
      "  box: {surface: false, interior: smoke}\n"
      "  hole: {surface: false}\n"
      "  glass: {principled: {transmission: 1}, interior: flame, priority: 7}\n"
      "  bottle: {transparency: 1, attenuation_color: [0.5, 1, 0.25], attenuation_distance: 2}\n"
      "objects: [{sphere: {}, material: box}]\n");
  ASSERT_EQ(scene.media.size(), 4u);
  EXPECT_EQ(scene.media[0].name, "smoke");
  EXPECT_EQ(scene.media[0].absorption, (Color{0.5f, 1, 1.5f}));
  EXPECT_EQ(scene.media[0].scattering, (Color{2, 2.5f, 3}));
  EXPECT_EQ(scene.media[0].anisotropy, -0.3f);
  EXPECT_EQ(scene.media[1].emission, (Color{1, 0.5f, 0}));
  EXPECT_EQ(scene.medium, 2u);
  EXPECT_FALSE(scene.materials[0].surface);
  EXPECT_EQ(scene.materials[0].interior, 0u);
  EXPECT_EQ(scene.materials[0].priority, kNoPriority);
  EXPECT_EQ(scene.materials[1].interior, kNoId);
  EXPECT_EQ(scene.materials[2].interior, 1u);
  EXPECT_EQ(scene.materials[2].priority, 7);
  EXPECT_TRUE(scene.materials[2].surface);
  const Medium& bottle = scene.media[scene.materials[3].interior];
  EXPECT_FLOAT_EQ(bottle.absorption.x, std::log(2.0f) / 2);
  EXPECT_EQ(bottle.absorption.y, 0);
  EXPECT_FLOAT_EQ(bottle.absorption.z, std::log(4.0f) / 2);
}

TEST(SceneMedia, ReportsBadMedia) {
  expect_error("media: {a: {absorption: [-1, 0, 0]}}\n", "2:26: expected a number of at least 0");
  expect_error("media: {a: {scattering: [.nan, 0, 0]}}\n", "2:26");
  expect_error("media: {a: {scattering: [1, 1]}}\n", "2:25");
  expect_error("media: {a: {density: -2}}\n", "at least 0");
  expect_error("media: {a: {anisotropy: 1}}\n", "from -0.999 to 0.999, found");
  expect_error("media: {a: {scattering: [1e6, 0, 0], density: 1e6}}\n", "at most 1e+09");
  expect_error("media: {a: {absorbtion: [1, 1, 1]}}\n", "absorption");
  expect_error("media: {a: {}}\nmedium: b\n", "3:9: unknown medium 'b'");
  expect_error("media: {smoke: {}}\nmaterials: {m: {surface: false, interior: smok}}\n",
               "did you mean 'smoke'?");
  expect_error("media: {a: {emission: [1, 1, 1], absorption: [1, 0, 1]}}\nmedium: a\n", "infinitely bright");
}

TEST(SceneMedia, ReportsBadInteriors) {
  const std::string media = "media: {a: {}}\nmaterials:\n";
  expect_error(media + "  m: {interior: a}\n", "no light enters this material");
  expect_error(media + "  m: {priority: 1}\n", "4:17: no light enters");
  expect_error(media + "  m: {transparency: 1, priority: -1}\n", "0 to 1000000");
  expect_error(media + "  m: {principled: {transmission: 1, thin: true}, interior: a}\n",
               "thin glass has no inside");
  expect_error(media + "  m: {surface: false, color: [1, 1, 1]}\n",
               "'color' has no meaning beside 'surface: false'");
  expect_error(media + "  m: {transparency: 1, attenuation_color: [1, 1, 1]}\n", "attenuation_distance");
  expect_error(media + "  m: {transparency: 1, attenuation_color: [1, 0, 1], attenuation_distance: 1}\n",
               "greater than 0 and at most 1");
  expect_error(media + "  m: {transparency: 1, attenuation_color: [1, 2, 1], attenuation_distance: 1}\n",
               "greater than 0 and at most 1");
  expect_error(media + "  m: {transparency: 1, attenuation_color: [1, 1, 1], attenuation_distance: 0}\n",
               "greater than 0");
  expect_error(
      media + "  m: {transparency: 1, interior: a, attenuation_color: [1, 1, 1], attenuation_distance: 1}\n",
      "either an 'interior' or an attenuation");
}

// A medium needs a solid to be in.
TEST(SceneMedia, OnlySolidsHaveAnInterior) {
  const std::string head =
      "media: {a: {}}\nmaterials: {m: {surface: false, interior: a}, g: {transparency: 1, priority: 1}}\n";
  for (const char* flat : {"disk: {}", "polygon: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}",
                           "triangle: {}", "cylinder: {open: true}"})
    for (const char* material : {"m", "g"})
      expect_error(head + "objects:\n  - {" + flat + ", material: " + material + "}\n",
                   "has no inside; only solids can have a material with an interior");
  expect_error(head + "define: {d: {disk: {}}}\nobjects: [{instance: d, material: m}]\n", "in prototype 'd'");
  SceneFiles files;
  files.dir.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string error = files.error_v1(head + "objects: [{mesh: {file: sheet.obj}, material: m}]\n");
  EXPECT_NE(error.find("the mesh is not closed: 3 open edges"), std::string::npos) << error;
}

/// The error for a medium with a grid file of this content.
std::string grid_error(const std::string& content) {
  SceneFiles files;
  files.dir.write("smoke.grid", content);
  return files.error_v1("media: {a: {grid: smoke.grid}}\n");
}

std::string header(const std::string& size, const std::string& values) {
  return "oktett density grid 1\nsize " + size + "\nvalues " + values + "\n";
}

std::string floats(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

TEST(SceneMedia, ReadsGridsAndNoise) {
  SceneFiles files;
  files.dir.write("a.grid", header("2 3 2", "text") + "0 1 2 3 4 5\n6 7 8 9 10 11\n");
  files.dir.write("b.grid", header("2 2 2", "float32") + floats({0, 1, 2, 3, 4, 5, 6, 7}));
  const Scene scene = files.load_v1(
      "media:\n"
      "  a: {grid: a.grid, scattering: [1, 1, 1], density: 2, bounds: {min: [0, 0, 0], max: [1, 2, 3]}}\n"
      "  b: {grid: b.grid, transform: {translate: [5, 0, 0]}}\n"
      "  c: {noise: {size: 8, threshold: 0, seed: 3}}\n"
      "medium: a\n");
  const Medium& a = scene.media[0];
  ASSERT_NE(a.grid, nullptr);
  EXPECT_EQ(a.grid->at({1, 2, 1}), 11);
  EXPECT_EQ(a.grid->at({0, 1, 0}), 2);
  EXPECT_EQ(a.scattering, (Color{2, 2, 2}));
  EXPECT_EQ(a.grid_place.point({1, 1, 1}), (Vec3d{1, 2, 3}));
  EXPECT_EQ(scene.media[1].grid->at({0, 0, 1}), 4);
  EXPECT_EQ(scene.media[1].grid_place.point({0.5, 0.5, 1}), (Vec3d{5, 0, 1}));
  EXPECT_GT(scene.media[2].grid->at({3, 4, 5}), 0);
}

// Light may enter wherever a texture leaves less than all of the surface to metal.
TEST(SceneMedia, TexturedMetalMayHaveAnInterior) {
  const std::string attenuation = "attenuation_color: [0.5, 0.9, 0.9], attenuation_distance: 1";
  SceneFiles files;
  const Scene scene = files.load_v1(
      "materials:\n  m: {principled: {transmission: 1, metallic: {noise: {}, "
      "gain: 0.5}}, " +
      attenuation + "}\n");
  EXPECT_EQ(scene.materials[0].interior, 0u);
  EXPECT_EQ(scene.materials[0].transparency, 1);
  expect_error("materials:\n  m: {principled: {transmission: 1, metallic: 1}, " + attenuation + "}\n",
               "no light enters this material");
}

TEST(SceneMedia, ReportsBadGrids) {
  const auto expect = [](const std::string& content, const std::string& error) {
    expect_starts(grid_error(content), error);
  };
  expect("", "smoke.grid:1: the file ends here");
  expect("oktett density grid 2\n", "smoke.grid:1: expected the line 'oktett density grid 1'");
  expect("oktett density grid 1\n", "smoke.grid:2: the file ends here");
  for (const char* size :
       {"2 2", "2 2 2 2", "1 2 2", "2 2 5000", "2 2 -2", "2  2 2", "2 2 99999999999", "a b c"})
    expect(header(size, "text"), "smoke.grid:2: expected 'size NX NY NZ', three numbers from 2 to 4096");
  expect(header("4096 4096 4096", "text"), "smoke.grid:2: a grid has at most 268435456 values");
  expect(header("2 2 2", "float64"), "smoke.grid:3: expected 'values float32' or 'values text'");
  expect(header("2 2 2", "text") + "0 1 2 3\n4 5 6", "smoke.grid:5: expected 8 values, found 7");
  expect(header("512 512 512", "text") + "0 1", "smoke.grid:4: expected 134217728 values, found 2");
  expect(header("2 2 2", "text") + "0 1 2 3 4 5 6 7\n8", "smoke.grid:5: expected 8 values, found more");
  expect(header("2 2 2", "text") + "0 1\nx 3 4 5 6 7", "smoke.grid:5: expected a number");
  expect(header("2 2 2", "text") + "0 1 2 -3 4 5 6 7",
         "smoke.grid:4: the value at x 1, y 1, z 0 is -3; expected a density from 0 to 1e+09");
  expect(header("2 2 2", "text") + "0 1 2 3 4 5 nan 7", "smoke.grid:4: the value at x 0, y 1, z 1 is nan");
  expect(header("2 2 2", "text") + "0 1e999 2 3 4 5 6 7", "smoke.grid:4: the value at x 1, y 0, z 0 is inf");
  expect(header("2 2 2", "float32") + floats({0, 1, 2, 3, 4, 5, 6}),
         "smoke.grid:3: expected 32 bytes of values after this line, found 28");
  expect(header("2 2 2", "float32") + floats({0, 1, 2, 3, 4, 5, 6, 7, 8}), "smoke.grid:3: expected 32 bytes");
  expect(header("2 2 2", "float32") + floats({0, 1, 2, NAN, 4, 5, 6, 7}),
         "smoke.grid:3: the value at x 1, y 1, z 0 is nan");
  expect(header("2 2 2", "float32") + floats({0, 1, 2, 3, 4, 5, 6, 1e30f}), "smoke.grid:3: the value at x 1");
}

TEST(SceneMedia, ReportsBadPlacesAndNoise) {
  expect_error("media: {a: {grid: none.grid}}\n", "none.grid");
  expect_error("media: {a: {bounds: {}}}\n",
               "only a medium with a 'grid', 'noise' or 'map_density' has a place");
  for (const std::string flat : {"[0, 1, 1]", "[1, 0, 1]", "[1, 1, 0]"})
    expect_error("media: {a: {noise: {}, bounds: {min: [0, 0, 0], max: " + flat + "}}}\n",
                 "'min' below 'max'");
  expect_error("media: {a: {noise: {}, transform: {scale: 0}}}\n", "2:35");
  expect_error("media: {a: {noise: {}, grid_name: density}}\n",
               "2:35: only a 'grid' that is an OpenVDB file");
  expect_error("media: {a: {noise: {size: 1}}}\n", "2 to 512");
  expect_error("media: {a: {noise: {threshold: 1}}}\n", "less than 1");
  expect_error("media: {a: {noise: {octaves: 13}}}\n", "1 to 12");
}

// What such files hold is tested with OpenVDB, which not every build has.
TEST(SceneMedia, FilesOfOpenVdbNeedItsLibrary) {
  SceneFiles files;
  files.dir.write("smoke.VDB", "no file of OpenVDB");
  expect_starts(files.error_v1("media: {a: {grid: smoke.VDB}}\n"),
                can_read_vdb() ? "smoke.VDB: cannot be read as an OpenVDB file: "
                               : "smoke.VDB: is an OpenVDB file, and this program is built without OpenVDB");
}

}  // namespace
}  // namespace oktett::scene_media_test
