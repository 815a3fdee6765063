/// \file What EXR files say beside their pixels: windows, primaries and cubes; and which numbers are sRGB.

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/image/heights.h"
#include "io/image/image.h"
#include "io/image/texture.h"
#include "tests/support/temp_dir.h"

namespace oktett::exr_meaning_test {
namespace {

using test::TempDir;

constexpr Vec2f kNoChange{0, 0};

/// Writes an image of three channels, whose pixels are `color(x, y)`.
std::string write(const std::string& path, OIIO::ImageSpec spec,
                  const std::function<Color(int, int)>& color) {
  std::vector<float> numbers;
  for (int y = 0; y < spec.height; ++y)
    for (int x = 0; x < spec.width; ++x) {
      const Color c = color(x, y);
      numbers.insert(numbers.end(), {c.x, c.y, c.z});
    }
  auto output = OIIO::ImageOutput::create(path);
  EXPECT_TRUE(output && output->open(path, spec) && output->write_image(OIIO::TypeFloat, numbers.data()) &&
              output->close())
      << OIIO::geterror();
  return path;
}

OIIO::ImageSpec float_spec(int width, int height) { return {width, height, 3, OIIO::TypeFloat}; }

Color red(int, int) { return {1, 0, 0}; }

Texture texture_of(const std::string& path) {
  Texture texture;
  texture.path = path;
  texture.lookup = kClampedTexture;
  return texture;
}

// ---- Windows.

struct Windows {
  int x, y, width, height;                      ///< of the data
  int full_x, full_y, full_width, full_height;  ///< of what is displayed
};

TEST(ExrWindows, TheDisplayWindowIsTheImageAndBlackWhereThereIsNoData) {
  const TempDir dir;
  const Windows cases[] = {{0, 0, 8, 8, 0, 0, 16, 8},      // the left half
                           {8, 0, 8, 8, 0, 0, 16, 8},      // the right half
                           {3, 2, 7, 5, 0, 0, 16, 8},      // within
                           {-3, -2, 24, 13, 0, 0, 16, 8},  // more than is shown
                           {-3, 4, 9, 13, 0, 0, 16, 8},    // across a corner
                           {12, 9, 8, 8, 10, 5, 16, 8},    // an origin elsewhere
                           {20, 20, 4, 4, 0, 0, 16, 8}};   // nothing of it is shown
  for (const Windows& w : cases) {
    OIIO::ImageSpec spec = float_spec(w.width, w.height);
    spec.x = w.x, spec.y = w.y;
    spec.full_x = w.full_x, spec.full_y = w.full_y, spec.full_width = w.full_width;
    spec.full_height = w.full_height;
    const auto number = [](int x, int y) { return Color{1 + 0.01f * x, 1 + 0.01f * y, 2}; };
    const std::string path = write(dir.file("a.exr"), spec, number);
    const EnvironmentPicture environment = read_environment_image(path);
    ASSERT_EQ(environment.width, static_cast<unsigned>(w.full_width));
    ASSERT_EQ(environment.height, static_cast<unsigned>(w.full_height));
    const ImageTextures textures({texture_of(path)});
    EXPECT_TRUE(textures.warnings().empty());
    for (int y = 0; y < w.full_height; ++y)
      for (int x = 0; x < w.full_width; ++x) {
        const int i = x + w.full_x - w.x, j = y + w.full_y - w.y;
        const bool inside = i >= 0 && j >= 0 && i < w.width && j < w.height;
        const Color want = inside ? number(i, j) : Color{0, 0, 0};
        EXPECT_EQ(environment.pixels[static_cast<std::size_t>(y * w.full_width + x)], want) << x << " " << y;
        const Vec2f uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(w.full_width),
                       1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(w.full_height)};
        EXPECT_NEAR(length(textures.color(0, uv, kNoChange, kNoChange) - want), 0, 2e-5) << x << " " << y;
      }
    EXPECT_THROW(read_heights(path, 1000, 1000000), Error);
  }
}

TEST(ExrWindows, AFrameTooLargeForMemoryIsRefused) {
  const TempDir dir;
  OIIO::ImageSpec spec = float_spec(2, 2);
  spec.full_width = spec.full_height = 1 << 29;
  const std::string path = write(dir.file("a.exr"), spec, red);
  EXPECT_THROW(read_environment_image(path), Error);
  EXPECT_EQ(ImageTextures({texture_of(path)}).warnings().size(), 1u);
}

// ---- Primaries.

std::string write_primaries(const TempDir& dir, const std::array<float, 8>& xy,
                            const std::function<Color(int, int)>& color) {
  OIIO::ImageSpec spec = float_spec(4, 2);
  spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy.data());
  return write(dir.file("a.exr"), spec, color);
}

constexpr std::array<float, 8> kAp0{0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f};
constexpr std::array<float, 8> kAp1{0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f};
constexpr std::array<float, 8> kRec2020{0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f};
constexpr std::array<float, 8> kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};

// The matrices that ACES and ITU-R BT.2087 publish; those of ACES with its adaptation by CAT02 differ in the
// third digit.
TEST(ExrPrimaries, LightBecomesThatOfRec709) {
  const TempDir dir;
  struct Case {
    std::array<float, 8> xy;
    Color of_red, of_green, of_blue;
    float error;
  };
  const Case cases[] = {{kAp0,
                         {2.5216f, -0.2765f, -0.0152f},
                         {-1.1341f, 1.3727f, -0.1530f},
                         {-0.3876f, -0.0962f, 1.1684f},
                         0.002f},
                        {kAp1,
                         {1.7051f, -0.1302f, -0.0240f},
                         {-0.6217f, 1.1408f, -0.1290f},
                         {-0.0833f, -0.0106f, 1.1529f},
                         0.002f},
                        {kRec2020,
                         {1.6605f, -0.1246f, -0.0182f},
                         {-0.5876f, 1.1329f, -0.1006f},
                         {-0.0728f, -0.0083f, 1.1187f},
                         2e-4f},
                        {kRec709, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0}};
  for (const Case& c : cases)
    for (const auto& [stored, want] : {std::pair{Color{1, 0, 0}, c.of_red},
                                       {Color{0, 1, 0}, c.of_green},
                                       {Color{0, 0, 1}, c.of_blue},
                                       {Color{1, 1, 1}, Color{1, 1, 1}}}) {
      const Color color = stored, expected = want;
      const std::string path = write_primaries(dir, c.xy, [&](int, int) { return color; });
      const auto near = [&](const Color& got) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], expected[k], std::max(c.error, 2e-6f));
      };
      near(read_environment_image(path).pixels[3]);
      const Picture picture = read_image(path);
      near({picture.find("R")->values[1], picture.find("G")->values[1], picture.find("B")->values[1]});
      const ImageTextures textures({texture_of(path)});
      const Vec2f wide{8, 0};
      near(textures.color(0, {0.5f, 0.5f}, kNoChange, kNoChange));
      near(textures.color(0, {0.5f, 0.5f}, wide, {0, 8}));
      // Normals and other numbers are no light.
      EXPECT_EQ(textures.normal(0, {0.5f, 0.5f}, kNoChange, kNoChange), stored);
    }
}

TEST(ExrPrimaries, ThoseOfNoColoursAreRefused) {
  const TempDir dir;
  for (const std::array<float, 8>& xy : {std::array<float, 8>{},
                                         {0.3f, 0.3f, 0.3f, 0.3f, 0.3f, 0.3f, 0.3f, 0.3f},
                                         {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3f, 0}}) {
    const std::string path = write_primaries(dir, xy, red);
    try {
      read_environment_image(path);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()),
                path + ": its chromaticities are not those of red, green, blue and white");
    }
    EXPECT_EQ(ImageTextures({texture_of(path)}).warnings().size(), 1u);
  }
}

// ---- Cubes.

/// The corners of the cube that OpenEXR's ImfEnvmap.h shows in the corners of each face: upper left and
/// right, lower left and right. Bits of a number: +x, +y, +z.
constexpr int kCorners[6][4] = {{3, 7, 1, 5}, {6, 2, 4, 0}, {6, 7, 2, 3},
                                {0, 1, 4, 5}, {7, 6, 5, 4}, {2, 3, 0, 1}};

Vec3d corner(int number) {
  return {number & 1 ? 1.0 : -1.0, number & 2 ? 1.0 : -1.0, number & 4 ? 1.0 : -1.0};
}

TEST(ExrCubes, FacesLieAlongTheAxesOfTheWorld) {
  const TempDir dir;
  constexpr int kSize = 9;
  OIIO::ImageSpec spec = float_spec(kSize, 6 * kSize);
  spec.attribute("textureformat", "CubeFace Environment");
  // Each place of the cube has the colour of its position.
  const std::string path = write(dir.file("cube.exr"), spec, [](int x, int y) {
    const int* corners = kCorners[y / kSize];
    const double right = x / (kSize - 1.0), down = y % kSize / (kSize - 1.0);
    const Vec3d above = corner(corners[0]) * (1 - right) + corner(corners[1]) * right;
    const Vec3d below = corner(corners[2]) * (1 - right) + corner(corners[3]) * right;
    return Color(above * (1 - down) + below * down) + Color{2, 2, 2};
  });
  const EnvironmentPicture picture = read_environment_image(path);
  ASSERT_EQ(picture.width, 4u * kSize);
  ASSERT_EQ(picture.height, 2u * kSize);
  for (std::uint32_t y = 0; y < picture.height; ++y)
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const Vec3d d(environment_direction((x + 0.5) / picture.width, (y + 0.5) / picture.height));
      const double longest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
      const Color want = Color(d / longest) + Color{2, 2, 2};
      EXPECT_NEAR(length(picture.pixels[y * picture.width + x] - want), 0, 1e-5) << x << " " << y;
    }
}

// ---- Integers.

TEST(IntegerImages, EightAndSixteenBitsOfTiffAndPngAgree) {
  const TempDir dir;
  const Color stored{0.2f, 0.5f, 0.8f};
  for (const char* name : {"a.png", "a.tif"})
    for (const OIIO::TypeDesc& type : {OIIO::TypeUInt8, OIIO::TypeUInt16}) {
      const std::string path =
          write(dir.file(name), OIIO::ImageSpec(4, 4, 3, type), [&](int, int) { return stored; });
      const EnvironmentPicture environment = read_environment_image(path);
      const ImageTextures textures({texture_of(path)});
      for (int k = 0; k < 3; ++k) {
        const double v = static_cast<double>(stored[k]), linear = std::pow((v + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(static_cast<double>(environment.pixels[5][k]), linear, 0.005) << name;
        EXPECT_NEAR(static_cast<double>(textures.color(0, {0.5f, 0.5f}, kNoChange, kNoChange)[k]), linear,
                    0.005);
        EXPECT_NEAR(textures.normal(0, {0.5f, 0.5f}, kNoChange, kNoChange)[k], stored[k], 0.002f);
      }
    }
  // Floats are linear.
  const std::string path =
      write(dir.file("f.tif"), OIIO::ImageSpec(4, 4, 3, OIIO::TypeFloat), [&](int, int) { return stored; });
  EXPECT_EQ(read_environment_image(path).pixels[0], stored);
}

// ---- Light beyond half.

TEST(LargeLight, IsKept) {
  const TempDir dir;
  Picture picture;
  picture.width = picture.full_width = 2, picture.height = picture.full_height = 1;
  for (const char* name : {"R", "G", "B", "A"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(2, 0.25f), {}});
  picture.planes[1].values[1] = 3e8f;
  write_image(dir.file("a.exr"), picture);
  for (const char* name : {"R", "G", "B"})
    EXPECT_EQ(read_image(dir.file("a.exr")).find(name)->values[1], picture.find(name)->values[1]);
  EXPECT_EQ(read_environment_image(dir.file("a.exr")).pixels[1], (Color{0.25f, 3e8f, 0.25f}));
}

// ---- Sixteen bits out.

TEST(WritePng16, HoldsTheNearestNumbers) {
  const TempDir dir;
  Picture picture;
  picture.width = picture.full_width = 64, picture.height = picture.full_height = 3;
  for (const char* name : {"R", "G", "B", "A"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(64 * 3, 1.0f), {}});
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 64 * 3; ++i)
      picture.planes[k].values[i] = static_cast<float>(i + k) / 180.0f - 0.02f;
  write_image16(dir.file("a.png"), picture);
  const auto input = OIIO::ImageInput::open(dir.file("a.png"));
  ASSERT_TRUE(input) << OIIO::geterror();
  ASSERT_EQ(input->spec().format, OIIO::TypeUInt16);
  ASSERT_EQ(input->spec().nchannels, 4);
  std::vector<std::uint16_t> words(64 * 3 * 4);
  ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeUInt16, words.data()));
  for (std::size_t i = 0; i < 64 * 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double v = std::clamp(static_cast<double>(picture.planes[k].values[i]), 0.0, 1.0);
      const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
      EXPECT_NEAR(words[4 * i + k], encoded * 65535, 0.51) << i;
      EXPECT_EQ(words[4 * i + 3], 65535);
    }
  EXPECT_THROW(write_image16(dir.file("a.exr"), picture), Error);
}

TEST(WritePng16, DepthIsInSteps) {
  const TempDir dir;
  Picture picture;
  picture.width = picture.full_width = 5, picture.height = picture.full_height = 1;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  picture.planes.push_back({"Z", PlaneType::single_float, Column<float>(5), {}});
  std::ranges::copy(std::array{1.0f, 12.3456f, 65.0f, kInf, 1e-9f}, picture.planes[0].values.begin());
  EXPECT_NEAR(depth_unit(picture), 1e-3, 1e-18);
  for (const double unit : {depth_unit(picture), 0.5, 1e-4}) {
    write_depth(dir.file("z.png"), picture, unit);
    const auto input = OIIO::ImageInput::open(dir.file("z.png"));
    ASSERT_TRUE(input) << OIIO::geterror();
    ASSERT_EQ(input->spec().nchannels, 1);
    EXPECT_NEAR(std::stod(std::string(input->spec().get_string_attribute("depthUnit"))), unit, 1e-12);
    std::vector<std::uint16_t> words(5);
    ASSERT_TRUE(input->read_image(0, 0, 0, 1, OIIO::TypeUInt16, words.data()));
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(words[i],
                std::min(65535.0, std::round(static_cast<double>(picture.planes[0].values[i]) / unit)));
    EXPECT_EQ(words[3], 0);
    EXPECT_EQ(words[4], 1);
  }
  picture.planes[0].values[2] = 65.535f;
  EXPECT_NEAR(depth_unit(picture), 1e-2, 1e-17);
  std::ranges::fill(picture.planes[0].values, kInf);
  EXPECT_EQ(depth_unit(picture), 1);
}

}  // namespace
}  // namespace oktett::exr_meaning_test
