#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "kernels/heights/height_grid.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_heights_test {
namespace {

using test::expect_starts;
using test::SceneFiles;

const HeightFieldShape& form_of(const Scene& scene, std::size_t i) {
  return std::get<HeightFieldShape>(test::shape_of<ExactShape>(scene, i).form);
}

/// Writes numbers of type T as an image file that stores them as they are.
template <class T>
void write_pixels(const SceneFiles& files, const std::string& name, int width, int height, int channels,
                  OIIO::TypeDesc type, const std::vector<T>& pixels) {
  const std::string path = (files.dir.path() / name).string();
  auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out);
  OIIO::ImageSpec spec(width, height, channels, type);
  // Or else the writer divides by alpha.
  spec.attribute("oiio:UnassociatedAlpha", 1);
  ASSERT_TRUE(out->open(path, spec));
  ASSERT_TRUE(out->write_image(type, pixels.data()));
  ASSERT_TRUE(out->close());
}

TEST(SceneHeights, FunctionsAreSampled) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - height_field: {function: \"x + 10*z\", samples: [5, 3], size: [4, 2, 8]}\n"
      "  - height_field: {function: \"2\"}\n"
      "  - height_field: {function: \"sin(x)*exp(-z^2)\", samples: 19, interpolation: triangles, base: -1, "
      "walk: spans, normals: central}\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.objects.size(), 3u);
  const HeightFieldShape &a = form_of(scene, 0), &b = form_of(scene, 1), &c = form_of(scene, 2);
  EXPECT_EQ(a.grid->columns(), 5u);
  EXPECT_EQ(a.grid->rows(), 3u);
  EXPECT_EQ(a.size, (Vec3d{4, 2, 8}));
  EXPECT_TRUE(a.open);
  EXPECT_EQ(a.walk, HeightWalk::pyramid);
  EXPECT_EQ(a.grid->interpolation(), HeightInterpolation::bilinear);
  for (std::uint32_t j = 0; j < 3; ++j)
    for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(a.grid->at(i, j), (i - 2.0) + 10 * (4.0 * j - 4));
  EXPECT_EQ(b.grid->columns(), 512u);
  EXPECT_EQ(b.grid->greatest(), 2);
  EXPECT_EQ(b.size, (Vec3d{2, 1, 2}));
  EXPECT_FALSE(c.open);
  EXPECT_EQ(c.base, -1);
  EXPECT_EQ(c.walk, HeightWalk::spans);
  EXPECT_EQ(c.grid->interpolation(), HeightInterpolation::triangles);
  EXPECT_EQ(test::shape_of<ExactShape>(scene, 2).normals, NormalMethod::central);
  for (std::uint32_t j = 0; j < 19; ++j)
    for (std::uint32_t i = 0; i < 19; ++i) {
      const double x = i / 9.0 - 1, z = j / 9.0 - 1;
      EXPECT_NEAR(c.grid->at(i, j), std::sin(x) * std::exp(-z * z), 1e-7);
    }
}

TEST(SceneHeights, ImagesKeepTheirNumbers) {
  const SceneFiles files;
  write_pixels<std::uint16_t>(files, "words.png", 3, 2, 1, OIIO::TypeDesc::UINT16, {0, 1, 2, 65535, 400, 77});
  write_pixels<std::uint8_t>(files, "bytes.png", 2, 2, 1, OIIO::TypeDesc::UINT8, {0, 1, 128, 255});
  write_pixels<std::uint8_t>(files, "grey.png", 2, 2, 3, OIIO::TypeDesc::UINT8,
                             {0, 0, 0, 1, 1, 1, 128, 128, 128, 255, 255, 255});
  write_pixels<std::uint16_t>(files, "alpha.png", 2, 2, 2, OIIO::TypeDesc::UINT16,
                              {9, 0, 8, 65535, 7, 1, 6, 100});
  write_pixels<std::uint16_t>(files, "words.tif", 2, 2, 1, OIIO::TypeDesc::UINT16, {5, 6, 7, 60000});
  write_pixels<float>(files, "floats.exr", 2, 2, 1, OIIO::TypeDesc::FLOAT, {-1e6f, 0.25f, 1e-9f, 3});
  write_pixels<float>(files, "floats.tif", 2, 2, 1, OIIO::TypeDesc::FLOAT, {-2, 0.25f, 1e-9f, 3});
  const Scene scene = files.load_v1(
      "objects: [{height_field: {file: words.png}}, {height_field: {file: bytes.png}}, {height_field: {file: "
      "grey.png}}, {height_field: {file: alpha.png}}, {height_field: {file: words.tif}}, {height_field: "
      "{file: floats.exr, interpolation: nearest, walk: cells}}, {height_field: {file: floats.tif}}]");
  const std::vector<std::vector<double>> expected = {
      {0, 1, 2, 65535, 400, 77}, {0, 257, 128 * 257, 65535}, {0, 257, 128 * 257, 65535}, {9, 8, 7, 6},
      {5, 6, 7, 60000},          {-1e6, 0.25, 1e-9f, 3},     {-2, 0.25, 1e-9f, 3}};
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const HeightGrid& grid = *form_of(scene, k).grid;
    EXPECT_EQ(grid.unit(), k < 5 ? 1.0 / 65535 : 1);
    ASSERT_EQ(std::size_t{grid.columns()} * grid.rows(), expected[k].size());
    for (std::uint32_t i = 0; i < expected[k].size(); ++i)
      EXPECT_EQ(grid.at(i % grid.columns(), i / grid.columns()), expected[k][i]) << k << " " << i;
  }
  EXPECT_EQ(form_of(scene, 5).grid->interpolation(), HeightInterpolation::nearest);
  EXPECT_EQ(form_of(scene, 5).walk, HeightWalk::cells);
}

TEST(SceneHeights, ErrorsHaveTheirPlace) {
  const SceneFiles files;
  write_pixels<std::uint8_t>(files, "colour.png", 2, 2, 3, OIIO::TypeDesc::UINT8,
                             {0, 0, 0, 1, 1, 1, 128, 127, 128, 255, 255, 255});
  write_pixels<std::uint8_t>(files, "thin.png", 7, 1, 1, OIIO::TypeDesc::UINT8, {1, 2, 3, 4, 5, 6, 7});
  write_pixels<std::uint8_t>(files, "wide.png", 32769, 2, 1, OIIO::TypeDesc::UINT8,
                             std::vector<std::uint8_t>(2 * 32769));
  write_pixels<float>(files, "nan.exr", 3, 2, 1, OIIO::TypeDesc::FLOAT,
                      {0, 1, 2, 3, std::numeric_limits<float>::quiet_NaN(), 5});
  write_pixels<float>(files, "inf.exr", 2, 2, 3, OIIO::TypeDesc::FLOAT,
                      std::vector<float>(12, -std::numeric_limits<float>::infinity()));
  write_pixels<float>(files, "tall.exr", 2, 2, 1, OIIO::TypeDesc::FLOAT, {0, 1, 2, 3e38f});
  write_pixels<std::uint16_t>(files, "words.png", 2, 2, 1, OIIO::TypeDesc::UINT16,
                              {13107, 65535, 65535, 65535});
  files.dir.write("text.png", "not an image");
  const struct {
    std::string text, error;
  } kCases[] = {
      {"{}", "scene.yaml:2:12: height_field needs 'file' or 'function'"},
      {"3", "scene.yaml:2:26: expected a map for height_field, found '3'"},
      {"{file: words.png, function: x}", "scene.yaml:2:54: height_field has either 'file' or 'function'"},
      {"{file: words.png, samples: 3}", "scene.yaml:2:53: a height field from a file has no 'samples'"},
      {"{fiel: words.png}", "scene.yaml:2:27: unknown key 'fiel' in height_field; did you mean 'file'?"},
      {"{file: gone.png}", "scene.yaml:2:33: 'gone.png': "},
      {"{file: text.png}", "scene.yaml:2:33: 'text.png': cannot read the image: "},
      {"{file: colour.png}",
       "scene.yaml:2:33: 'colour.png': the image is not grey: red, green and blue differ at pixel (0, 1)"},
      {"{file: thin.png}",
       "scene.yaml:2:33: 'thin.png': the image has 7 x 1 pixels, expected 2 to 32768 along each side"},
      {"{file: wide.png}",
       "scene.yaml:2:33: 'wide.png': the image has 32769 x 2 pixels, expected 2 to 32768 along each side"},
      {"{file: nan.exr}", "scene.yaml:2:33: 'nan.exr': pixel (1, 1) is not a finite number"},
      {"{file: inf.exr}", "scene.yaml:2:33: 'inf.exr': pixel (0, 0) is not a finite number"},
      {"{file: tall.exr}",
       "scene.yaml:2:12: the heights are from 0 to 3e+38; expected a magnitude of at most"},
      {"{function: \"x + *\"}", "scene.yaml:2:42: bad function: "},
      {"{function: \"x + y\"}",
       "scene.yaml:2:37: the function of a height field is one of x and z, not of y"},
      {"{function: \"y\"}", "scene.yaml:2:37: the function of a height field is one of x and z, not of y"},
      {"{function: \"1/x\", samples: 3}",
       "scene.yaml:2:37: the function has no finite value at x = 0, z = -1"},
      {"{function: \"sqrt(z)\", samples: 5, size: [2, 1, 4]}",
       "scene.yaml:2:37: the function has no finite value at x = -1, z = -2"},
      {"{function: \"1e30*x\"}", "scene.yaml:2:37: the function has no finite value at x = -1, z = -1"},
      {"{function: x, samples: 1}", "scene.yaml:2:49: expected a whole number from 2 to 32768, found '1'"},
      {"{function: x, samples: [9, 32769]}", "scene.yaml:2:53: expected a whole number from 2 to 32768"},
      {"{function: x, samples: [9]}", "scene.yaml:2:49: expected 2 numbers, found 1"},
      {"{function: x, samples: 32768}", "scene.yaml:2:49: expected at most 268435456 samples in all"},
      {"{function: x, size: [1, -1, 1]}", "scene.yaml:2:46: the size must not be negative"},
      {"{function: x, interpolation: cubic}",
       "scene.yaml:2:55: expected nearest or triangles or bilinear, found 'cubic'"},
      {"{function: x, walk: run}", "scene.yaml:2:46: expected pyramid or cells or spans, found 'run'"},
      {"{function: x, samples: 3, base: -1}",
       "scene.yaml:2:58: the base must be below all heights, of which the least is -1"},
      {"{file: words.png, base: 0.3}",
       "scene.yaml:2:50: the base must be below all heights, of which the least is 0.2"},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.text);
    expect_starts(files.error_v1("objects: [{height_field: " + c.text + "}]"), c.error);
  }
}

TEST(SceneHeights, DegenerateOnesAreSkipped) {
  const SceneFiles files;
  for (const auto& [size, axis] : {std::pair{"[0, 1, 1]", "x"}, {"[1, 0, 1]", "y"}, {"[1, 1, 0]", "z"}}) {
    const Scene scene =
        files.load_v1(std::string("objects: [{height_field: {function: \"1\", size: ") + size + "}}]");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(files.without_directory(to_string(scene.warnings[0])),
              std::string("scene.yaml:2:12: warning: the size of the height field is zero along ") + axis +
                  "; the object is skipped");
    EXPECT_TRUE(scene.objects.empty());
  }
}

}  // namespace
}  // namespace oktett::scene_heights_test
