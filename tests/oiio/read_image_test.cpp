/// \file Reading image files: damaged, cut short, foreign and lying ones.

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/image/image.h"
#include "tests/oiio/image_support.h"
#include "tests/support/temp_dir.h"

namespace oktett::read_image_test {
namespace {

namespace fs = std::filesystem;
using test::color_picture;
using test::float_plane;
using test::kind_of;
using test::TempDir;

TEST(ReadImage, GreyGivesThreeColours) {
  const TempDir dir;
  OIIO::ImageSpec spec(2, 1, 1, OIIO::TypeUInt8);
  const std::uint8_t bytes[2] = {0, 128};
  auto output = OIIO::ImageOutput::create("a.png");
  ASSERT_TRUE(output->open(dir.file("a.png"), spec) && output->write_image(OIIO::TypeUInt8, bytes) &&
              output->close());
  const Picture picture = read_image(dir.file("a.png"));
  ASSERT_EQ(picture.planes.size(), 3u);
  for (const char* name : {"R", "G", "B"}) EXPECT_NEAR(picture.find(name)->values[1], 0.2158605f, 1e-6f);
}

TEST(ReadImage, MissingOrForeignFilesAreErrors) {
  const TempDir dir;
  EXPECT_EQ(kind_of([&] { read_image(dir.file("missing.png")); }), ErrorKind::io);
  EXPECT_EQ(kind_of([&] { read_image(dir.path().string()); }), ErrorKind::io);
  EXPECT_EQ(kind_of([&] { read_image("/dev/null"); }), ErrorKind::io);
  for (const char* name : {"a.png", "a.exr", "a.jpg", "a.tif", "a.hdr", "a.bmp", "a.txt"}) {
    EXPECT_EQ(kind_of([&] { read_image(dir.write(name, "this is no image")); }), ErrorKind::io) << name;
    EXPECT_EQ(kind_of([&] { read_image(dir.write(name, "")); }), ErrorKind::io) << name;
  }
}

// Files cut off anywhere, or with a byte changed, either read as something or throw Error; nothing else
// happens.
TEST(ReadImage, DamagedFilesAreErrorsOrPictures) {
  const TempDir dir;
  Picture picture = color_picture(16, 16, 0, 0.5f, 0.25f, 1);
  picture.planes[0] = float_plane("R", PlaneType::half_float, 256, 0, 0.003f);
  for (const char* name : {"a.exr", "a.tif", "a.hdr", "a.tga", "a.bmp"}) {
    write_image(dir.file(name), picture);
    const std::string whole = test::file_content(dir.file(name));
    std::size_t refused = 0;
    for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 40) {
      try {
        read_image(dir.write(std::string("cut-") + name, whole.substr(0, length)));
      } catch (const Error&) {
        ++refused;
      }
      std::string changed = whole;
      changed[length] = static_cast<char>(changed[length] ^ 0x55);
      try {
        read_image(dir.write(std::string("changed-") + name, changed));
      } catch (const Error&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 20u) << name;
  }
}

// What a file lacks is not shown as black.
TEST(ReadImage, TruncatedTiffsAreErrors) {
  const TempDir dir;
  for (const char* compression : {"none", "zip", "lzw"})
    for (const int tile : {0, 64}) {
      const std::string path = dir.file("a.tif");
      OIIO::ImageSpec spec(256, 128, 3, OIIO::TypeFloat);
      spec.attribute("compression", compression);
      spec.tile_width = spec.tile_height = tile;
      std::vector<float> numbers(256 * 128 * 3);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = 1 + std::sin(static_cast<float>(i * i % 9973));
      const auto output = OIIO::ImageOutput::create(path);
      ASSERT_TRUE(output->open(path, spec) && output->write_image(OIIO::TypeFloat, numbers.data()) &&
                  output->close());
      EXPECT_EQ(read_image(path).find("R")->values[1], numbers[3]);
      fs::resize_file(path, fs::file_size(path) / 2);
      std::string message;
      try {
        read_image(path);
      } catch (const Error& error) {
        message = error.what();
      }
      EXPECT_EQ(message.find(path + ": cannot read the image: "), 0u) << compression << ": " << message;
    }
}

// A header of a few bytes must not make the reader reserve memory for what it claims.
TEST(ReadImage, ClaimedSizesAreBounded) {
  const TempDir dir;
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n";
  EXPECT_EQ(kind_of([&] { read_image(dir.write("a.hdr", header)); }), ErrorKind::io);
  // OpenEXR would ask for the 1.9 GB of this text.
  const std::string attribute("\x76\x2f\x31\x01\x02\0\0\0text\0string\0\0\0\0\x70short\0", 30);
  try {
    read_image(dir.write("a.exr", attribute));
    ADD_FAILURE() << "is read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("longer than the file"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace oktett::read_image_test
