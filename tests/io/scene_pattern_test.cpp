/// \file Patterns of scene files: maps, waves, turbulence, warps and textures within them.

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "io/scene/readers.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_pattern_test {
namespace {

using test::SceneFiles;

class ScenePattern : public testing::Test {
 protected:
  ScenePattern() { files.dir.write("a.png", ""); }
  /// The texture of this text as the colour of a material.
  Texture texture(const std::string& text) {
    scene = files.load_v1("materials: {m: {color: {" + text + "}}}");
    return scene.textures.at(scene.materials.at(0).color_texture);
  }
  PatternTexture pattern(const std::string& text) { return texture(text).pattern.value(); }
  void expect(const std::string& text, const std::string& part) {
    const std::string error = files.error_v1("materials: {m: {color: {" + text + "}}}");
    EXPECT_NE(error.find(part), std::string::npos) << text << "\n" << error;
    EXPECT_EQ(error.find("scene.yaml:2:"), 0u) << error;
  }

  SceneFiles files;
  Scene scene;
};

TEST_F(ScenePattern, EachKindIsRead) {
  std::size_t kinds = 0;
  files.dir.write("a.grid", "oktett density grid 1\nsize 2 2 2\nvalues text\n0 0 0 0 1 1 1 1\n");
  visit_patterns([&]<class P>(const P& usual) {
    std::string keys;
    if constexpr (std::is_same_v<P, FunctionPattern>) keys = "f: x";
    if constexpr (std::is_same_v<P, TexturePattern>) keys = "of: {noise: }";
    if constexpr (std::is_same_v<P, ProjectedPattern>) keys = "of: {file: a.png}";
    if constexpr (std::is_same_v<P, VoxelPattern>) keys = "file: a.grid";
    if constexpr (std::is_same_v<P, OverPattern>) keys = "color: 0.25, filter: [0, 0.5, 1], under: {noise: }";
    const PatternTexture read = pattern(std::string(P::kShapeInfo.key) + ": {" + keys + "}");
    EXPECT_TRUE(std::holds_alternative<P>(read.pattern)) << P::kShapeInfo.key;
    if (keys.empty()) {
      EXPECT_EQ(read.pattern, Pattern(usual)) << P::kShapeInfo.key;
    }
    EXPECT_EQ(read.wave, Wave{});
    ++kinds;
  });
  EXPECT_EQ(kinds, std::variant_size_v<Pattern>);
}

TEST_F(ScenePattern, PatternsWithoutValuesAreRead) {
  const PatternTexture over = pattern("over: {color: 0.25, filter: [0, 0.5, 1], under: {noise: }}");
  const auto& o = std::get<OverPattern>(over.pattern);
  EXPECT_EQ(o.color, (PatternColor{{0.25f, 0.25f, 0.25f}, {}}));
  EXPECT_EQ(o.filter, (PatternColor{{0, 0.5f, 1}, {}}));
  ASSERT_LT(o.under.texture.index, scene.textures.size());
  const PatternTexture image =
      pattern("projected: {of: {file: a.png}, onto: spherical, transform: {scale: 2}}");
  EXPECT_EQ(std::get<ProjectedPattern>(image.pattern).projection, ProjectedPattern::Projection::spherical);
  const PatternTexture function = pattern("function: {f: x^2, of: {noise: }}");
  EXPECT_LT(std::get<FunctionPattern>(function.pattern).texture.index, scene.textures.size());
  expect("over: {color: 1, filter: 1}", "under");
  expect("over: {color: 1, filter: 1, under: 0, map: [[0, 1]]}", "map");
  expect("projected: {}", "of");
  expect("projected: {of: {file: a.png}, wave: sine}", "wave");
}

TEST_F(ScenePattern, MapsAreRead) {
  const PatternTexture t =
      pattern("onion: {map: [[0, [1, 0, 0]], [0.25, 0.5], [0.25, '#ffffff'], [1, {noise: {size: 3}}]]}");
  ASSERT_EQ(t.map.size(), 4u);
  EXPECT_EQ(t.map[0], (PatternEntry{0, {1, 0, 0}, {}}));
  EXPECT_EQ(t.map[1], (PatternEntry{0.25, {0.5f, 0.5f, 0.5f}, {}}));
  EXPECT_EQ(t.map[2], (PatternEntry{0.25, {1, 1, 1}, {}}));
  ASSERT_LT(t.map[3].texture.index, scene.textures.size());
  const NoisePattern expected{3};
  EXPECT_EQ(scene.textures[t.map[3].texture.index].pattern->pattern, Pattern(expected));
  EXPECT_EQ(t.colors.size(), 2u);
}

TEST_F(ScenePattern, ColoursMayBeTextures) {
  const PatternTexture t = pattern("hexagon: {colors: [[1, 0, 0], {file: a.png}, 0.25]}");
  ASSERT_EQ(t.map.size(), 3u);
  EXPECT_EQ(t.map[1].at, 0.5);
  EXPECT_FALSE(scene.textures.at(t.map[1].texture.index).path.empty());
  EXPECT_EQ(t.map[2], (PatternEntry{1, {0.25f, 0.25f, 0.25f}, {}}));
  // The same textures are one.
  const PatternTexture twice = pattern("checker: {colors: [{noise: }, {noise: }]}");
  EXPECT_EQ(twice.map[0].texture, twice.map[1].texture);
}

TEST_F(ScenePattern, WavesTurbulenceAndWarpsAreRead) {
  PatternTexture t = pattern(
      "layers: {wave: poly, exponent: 3, frequency: -2, phase: 0.5, turbulence: {amount: [1, 2, 3], octaves: "
      "4, "
      "lambda: 3, omega: 0.25}}");
  EXPECT_EQ(t.wave, (Wave{WaveShape::poly, 3, -2, 0.5}));
  EXPECT_EQ(t.turbulence, (PatternTurbulence{{1, 2, 3}, 4, 3, 0.25}));
  EXPECT_EQ(pattern("granite: {turbulence: 0.5}").turbulence.amount, (Vec3d{0.5, 0.5, 0.5}));
  EXPECT_EQ(pattern("granite: {turbulence: [0, 1, 0]}").turbulence.amount, (Vec3d{0, 1, 0}));
  t = pattern(
      "checker: {warps: [{repeat: {width: [0, 2, 0], flip: [1, 0, 0]}}, {black_hole: {radius: 3, inverse: "
      "true}},"
      " {turbulence: 0.5}, {planar: {orientation: [0, 2, 0], distance: 4}}, {cylindrical: }, {spherical: "
      "{exponent: 1}}, {toroidal: {major_radius: 2}}, {transform: {translate: [1, 0, 0]}}]}");
  using Figure = MappingWarp::Figure;
  ASSERT_EQ(t.warps.size(), 8u);
  EXPECT_EQ(t.warps[0], Warp(RepeatWarp{{0, 2, 0}, {0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(t.warps[1], Warp(BlackHoleWarp{{0, 0, 0}, 3, 1, 2, true}));
  EXPECT_EQ(t.warps[2], Warp(TurbulenceWarp{{{0.5, 0.5, 0.5}}}));
  EXPECT_EQ(t.warps[3], Warp(MappingWarp{Figure::planar, {0, 1, 0}, 4}));
  EXPECT_EQ(t.warps[4], Warp(MappingWarp{Figure::cylindrical}));
  EXPECT_EQ(t.warps[5], Warp(MappingWarp{Figure::spherical, {0, 0, 1}, 0, 1}));
  EXPECT_EQ(t.warps[6], Warp(MappingWarp{Figure::toroidal, {0, 0, 1}, 0, 0, 2}));
  EXPECT_EQ(warped(t.warps[7], {3, 0, 0}), (Vec3d{2, 0, 0}));
}

TEST_F(ScenePattern, FiltersMayBeTextures) {
  scene = files.load_v1(
      "materials: {m: {transparency: {cells: }, filter: {onion: }}, n: {transparency: 1, filter: [1, 0, "
      "0]}}");
  const Material &m = scene.materials.at(0), &n = scene.materials.at(1);
  EXPECT_EQ(m.filter, (Color{1, 1, 1}));
  EXPECT_TRUE(scene.textures.at(m.filter_texture).pattern);
  EXPECT_TRUE(scene.textures.at(m.transparency_texture).pattern);
  EXPECT_EQ(n.filter, (Color{1, 0, 0}));
  EXPECT_EQ(n.filter_texture, kNoId);
}

TEST_F(ScenePattern, ErrorsSayWhatIsWrong) {
  expect("onion: {map: []}", "expected 1 to 256 places, found 0");
  expect("onion: {map: [[0.5, 1], [0.25, 0]]}", "must ascend: expected at least 0.5");
  expect("onion: {map: [[1.5, 1]]}", "from 0 to 1");
  expect("onion: {map: [[0.5]]}", "expected [place, color], found 1 items");
  expect("onion: {map: [3]}", "expected a list for a place of the map");
  expect("onion: {map: [[0, -1]]}", "at least 0");
  expect("onion: {map: [[0, {marbel: }]]}", "did you mean 'marble'?");
  expect("onion: {map: [[0, 1]], colors: [1]}", "expected 'colors' or 'map', not both");
  expect("onion: {wave: sinus}", "sine");
  expect("onion: {turbulence: {octaves: 0}}", "whole number from 1 to 16");
  expect("onion: {warps: [{repeat: {width: [1, 1, 0]}}]}", "expected one number that is not 0");
  expect("onion: {warps: [{repeat: {width: [1, 0, 0]}, transform: }]}", "expected one warp, found 2");
  expect("onion: {warps: [{spherica: }]}", "did you mean 'spherical'?");
  expect("onion: {warps: [{transform: {scale: 0}}]}", "singular");
  expect("onion: {warps: [{planar: {orientation: [0, 0, 0]}}]}", "must not be zero");
  expect("function: {f: 'x +'}", "bad function");
  expect("function: {}", "'f'");
  expect("brightness: {}", "'of'");
  expect("linear: {direction: [0, 0, 0]}", "must not be zero");
}

TEST_F(ScenePattern, NestingHasAnEnd) {
  std::string text = "noise: ";
  for (unsigned i = 1; i < kMostNestedTextures; ++i) text = "onion: {map: [[0, {" + text + "}]]}";
  EXPECT_TRUE(texture(text).pattern);
  text = "onion: {map: [[0, {" + text + "}]]}";
  expect(text, "more than 16 of them in each other");
  // Few textures that are shown very often.
  std::string many = "noise: ";
  for (int i = 0; i < 4; ++i) {
    std::string map;
    for (int k = 0; k < 10; ++k) map += (k ? ", [1, {" : "[1, {") + many + "}]";
    many = "onion: {map: [" + map + "]}";
  }
  expect(many, "at most 4096 are allowed");
}

}  // namespace
}  // namespace oktett::scene_pattern_test
