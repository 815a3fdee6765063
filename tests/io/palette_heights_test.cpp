// Height fields of images with a palette, in scene files.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/image/heights.h"
#include "kernels/heights/height_grid.h"
#include "tests/io/palette_png.h"
#include "tests/io/scene_test_support.h"

namespace oktett::palette_heights_test {
namespace {

using test::expect_starts;
using test::PalettePng;
using test::SceneFiles;

const std::string kScene = "objects: [{height_field: {file: a.png, palette: true}}]";

std::vector<double> heights_of(const SceneFiles& files, const std::string& text = kScene) {
  const Scene scene = files.load_v1(text);
  const auto& shape = std::get<HeightFieldShape>(test::shape_of<ExactShape>(scene, 0).form);
  std::vector<double> heights;
  for (std::uint32_t j = 0; j < shape.grid->rows(); ++j)
    for (std::uint32_t i = 0; i < shape.grid->columns(); ++i)
      heights.push_back(shape.grid->at(i, j) * shape.grid->unit());
  return heights;
}

TEST(PaletteHeights, AreTheNumbersOfTheColours) {
  for (const int depth : {1, 2, 4, 8})
    for (const bool interlaced : {false, true}) {
      SCOPED_TRACE(testing::Message() << depth << " bits, interlaced " << interlaced);
      PalettePng png{11, 9, depth, std::size_t{1} << depth, {}, interlaced};
      std::vector<double> expected;
      for (unsigned i = 0; i < 99; ++i) {
        png.numbers.push_back((i * 37 + i / 11) % (1u << depth));
        expected.push_back(png.numbers.back() / 256.0);
      }
      const SceneFiles files;
      EXPECT_TRUE(has_palette(files.dir.write("a.png", png.file())));
      EXPECT_EQ(heights_of(files), expected);
    }
}

TEST(PaletteHeights, ErrorsHaveTheirPlace) {
  const auto error = [](const std::string& file, const std::string& scene = kScene) {
    const SceneFiles files;
    files.dir.write("a.png", file);
    return files.error_v1(scene);
  };
  const std::string at = "scene.yaml:2:33: 'a.png': ";
  const PalettePng good;
  EXPECT_EQ(error(good.file()), "no error");
  expect_starts(error(PalettePng{.color_type = 0}.file()), at + "the image has no palette");
  expect_starts(error("GIF89a"), at + "is no PNG image, of which alone palettes are read");
  expect_starts(error(PalettePng{1, 4}.file()),
                at + "the image has 1 x 4 pixels, expected 2 to 32768 along each side");
  PalettePng large{32769, 2};
  large.numbers.resize(2 * 32769);
  expect_starts(error(large.header() + large.palette() + test::png_chunk("IDAT", "")),
                at + "the image has 32769 x 2 pixels, expected 2 to 32768 along each side");
  PalettePng many{32768, 32768};
  expect_starts(error(many.header() + many.palette() + test::png_chunk("IDAT", "")),
                at + "the image has 32768 x 32768 pixels, expected at most 268435456 in all");
  // Three of four colours, and of 256.
  expect_starts(error(PalettePng{.colors = 3}.file()),
                at + "pixel (1, 1) has the colour 3 of a palette of 3");
  expect_starts(error(PalettePng{.depth = 2, .colors = 2}.file()),
                at + "pixel (0, 1) has the colour 2 of a palette of 2");
  expect_starts(error(good.header() + test::png_chunk("IDAT", test::stored_by_zlib(good.pixels())) +
                      test::png_chunk("IEND", "")),
                at + "cannot read the image: ");
  expect_starts(error(good.header() + good.palette() + test::png_chunk("IDAT", "no zlib") +
                      test::png_chunk("IEND", "")),
                at + "cannot read the image: ");
  expect_starts(error("", "objects: [{height_field: {function: x, palette: true}}]"),
                "scene.yaml:2:49: a height field from a function has no 'palette'");
  expect_starts(error(good.file(), "objects: [{height_field: {file: b.png, palette: true}}]"),
                "scene.yaml:2:33: 'b.png': no such file");
  expect_starts(error(good.file(), "objects: [{height_field: {file: a.png, palette: 3}}]"),
                "scene.yaml:2:49: expected true or false");
}

TEST(PaletteHeights, CutAndChangedFilesAreErrors) {
  const std::string whole = PalettePng{5, 3, 4, 16, std::vector<unsigned>(15, 9)}.file();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const SceneFiles files;
    files.dir.write("a.png", whole.substr(0, size));
    expect_starts(files.error_v1(kScene), "scene.yaml:2:33: 'a.png': ");
  }
  // A changed byte is found by a check sum, or stands in a name of a chunk that may be skipped.
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x11);
    const SceneFiles files;
    files.dir.write("a.png", changed);
    const std::string error = files.error_v1(kScene);
    EXPECT_NE(error, "no error") << "byte " << i;
  }
}

TEST(PaletteHeights, OtherFilesHaveNone) {
  const SceneFiles files;
  EXPECT_FALSE(has_palette(files.dir.write("grey.png", PalettePng{.color_type = 0}.file())));
  EXPECT_FALSE(has_palette(files.dir.write("text.png", "no image")));
  EXPECT_FALSE(has_palette(files.dir.write("short.png", PalettePng{}.file().substr(0, 25))));
  EXPECT_FALSE(has_palette((files.dir.path() / "gone.png").string()));
}

TEST(PaletteHeights, AreWrittenAsHeights) {
  const SceneFiles files;
  files.dir.write("a.png", PalettePng{}.file());
  EXPECT_EQ(heights_of(files), (std::vector<double>{0, 1 / 256.0, 2 / 256.0, 3 / 256.0}));
  const Scene scene = files.load_v1(kScene);
  EXPECT_FALSE(std::get<HeightFieldShape>(test::shape_of<ExactShape>(scene, 0).form).palette);
}

}  // namespace
}  // namespace oktett::palette_heights_test
