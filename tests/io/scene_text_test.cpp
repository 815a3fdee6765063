/// \file Letters of fonts, by the numbers of a font that systems often have.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "accel/point_query.h"
#include "io/font/font.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_text_test {
namespace {

using test::expect_starts;
using test::SceneFiles;
using test::shape_of;

const std::string kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

bool can_test() { return can_read_fonts() && std::filesystem::exists(kFont); }

std::string text(const std::string& words, const std::string& more = "") {
  return "objects: [{text: {font: " + kFont + ", text: \"" + words + "\"" + more + "}}]";
}

struct Extent {
  double lo_x = HUGE_VAL, hi_x = -HUGE_VAL, lo_y = HUGE_VAL, hi_y = -HUGE_VAL;
};
Extent extent(const PrismShape& shape) {
  Extent e;
  for (const PlaneOutline& outline : shape.outlines)
    for (const FlatPoint& p : outline)
      e = {std::min(e.lo_x, p.x), std::max(e.hi_x, p.x), std::min(e.lo_y, p.z), std::max(e.hi_y, p.z)};
  return e;
}

const PrismShape& prism(const Scene& scene) { return std::get<PrismShape>(shape_of<ExactShape>(scene).form); }

/// Widths and kerning of the font, in units of 1/2048: an A is 1368 wide, a V 1384 from -0; after an A
/// follows what is 1401 - 131 farther.
TEST(SceneText, LettersFollowEachOther) {
  if (!can_test()) GTEST_SKIP() << "no FreeType or no " << kFont;
  const Scene one = SceneFiles().load_v1(text("A"));
  EXPECT_TRUE(one.warnings.empty());
  EXPECT_EQ(prism(one).axis, PrismShape::Axis::z);
  EXPECT_EQ(prism(one).outlines.size(), 2u);
  const Extent a = extent(prism(one));
  EXPECT_NEAR(a.lo_x, 0, 1e-12);
  EXPECT_NEAR(a.hi_x, 1368 / 2048.0, 1e-12);
  EXPECT_NEAR(a.lo_y, 0, 1e-12);
  EXPECT_NEAR(a.hi_y, 1493 / 2048.0, 1e-12);
  const Extent two = extent(prism(SceneFiles().load_v1(text("AV"))));
  EXPECT_NEAR(two.hi_x, (1401 - 131 + 1368) / 2048.0, 1e-12);
  const Extent apart = extent(prism(SceneFiles().load_v1(text("AV", ", advance: [0.5, 0.25, 0]"))));
  EXPECT_NEAR(apart.hi_x, two.hi_x + 0.5, 1e-12);
  EXPECT_NEAR(apart.hi_y, a.hi_y + 0.25, 1e-12);
}

/// The hole of an O is outside, the ring inside, between 0 and the thickness.
TEST(SceneText, LettersHaveHoles) {
  if (!can_test()) GTEST_SKIP() << "no FreeType or no " << kFont;
  const Scene scene = SceneFiles().load_v1(text("O", ", thickness: 0.25"));
  const auto accel = build_accel({{shape_of<ExactShape>(scene), {}}});
  const Extent e = extent(prism(scene));
  const auto middle = static_cast<float>((e.lo_x + e.hi_x) / 2);
  const float y = 0.36f;
  EXPECT_FALSE(inside(*accel, Vec3f{middle, y, 0.1f}));
  EXPECT_TRUE(inside(*accel, Vec3f{0.04f, y, 0.1f}));
  EXPECT_FALSE(inside(*accel, Vec3f{0.04f, y, 0.3f}));
  EXPECT_FALSE(inside(*accel, Vec3f{0.04f, y, -0.1f}));
  std::vector<Hit> hits;
  all_hits(*accel, {{-1, y, 0.1f}, 0, {1, 0, 0}, std::numeric_limits<float>::infinity()}, hits);
  EXPECT_EQ(hits.size(), 4u);
}

TEST(SceneText, WhatIsMissing) {
  if (!can_test()) GTEST_SKIP() << "no FreeType or no " << kFont;
  const Scene strange = SceneFiles().load_v1(text("a\\U000F0000"));
  ASSERT_EQ(strange.warnings.size(), 1u);
  EXPECT_NE(strange.warnings[0].message.find("U+F0000"), std::string::npos);
  const Scene empty = SceneFiles().load_v1(text(" "));
  EXPECT_EQ(empty.warnings.size(), 1u);
  EXPECT_TRUE(empty.objects.empty());
  SceneFiles files;
  files.dir.write("no.ttf", "this is no font");
  expect_starts(files.error_v1("objects: [{text: {font: no.ttf, text: a}}]"), "scene.yaml:2:25");
}

}  // namespace
}  // namespace oktett::scene_text_test
