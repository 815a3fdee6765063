#include "io/image/image.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/image/color.h"
#include "tests/oiio/image_support.h"
#include "tests/support/limits.h"
#include "tests/support/temp_dir.h"

namespace oktett::image_test {
namespace {

namespace fs = std::filesystem;
using test::color_picture;
using test::float_plane;
using test::kind_of;
using test::TempDir;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The bytes of an 8-bit image as they stand in the file.
std::vector<std::uint8_t> raw_bytes(const std::string& path) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  auto input = OIIO::ImageInput::open(path, &config);
  EXPECT_TRUE(input) << OIIO::geterror();
  if (!input) return {};
  std::vector<std::uint8_t> bytes(input->spec().image_pixels() *
                                  static_cast<std::size_t>(input->spec().nchannels));
  EXPECT_TRUE(input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeDesc::UINT8, bytes.data()));
  return bytes;
}

// All planes come back under their names with their types; halves, floats and ids exactly.
TEST(Exr, RoundTripKeepsTypesAndNumbers) {
  const TempDir dir;
  Picture picture = color_picture(7, 5, 0.25f, 0.5f, 2, 1);
  picture.planes.push_back(float_plane("Z", PlaneType::single_float, 35, 1.1f, 0.3f));
  picture.planes.push_back(float_plane("N.X", PlaneType::single_float, 35, -0.7f, 0.01f));
  PicturePlane ids{"primID.I", PlaneType::unsigned_int, {}, Column<std::uint32_t>(35)};
  for (std::uint32_t i = 0; i < 35; ++i) ids.ids[i] = 0xffffffffu - i * 0x1234567u;
  picture.planes.push_back(ids);
  write_image(dir.file("a.exr"), picture);

  const Picture back = read_image(dir.file("a.exr"));
  EXPECT_EQ(back.width, 7u);
  EXPECT_EQ(back.height, 5u);
  ASSERT_EQ(back.planes.size(), picture.planes.size());
  for (const PicturePlane& plane : picture.planes) {
    const PicturePlane* read = back.find(plane.name);
    ASSERT_NE(read, nullptr) << plane.name;
    EXPECT_EQ(read->type == PlaneType::unsigned_int, plane.type == PlaneType::unsigned_int);
    for (std::size_t i = 0; i < 35; ++i) {
      if (plane.type == PlaneType::unsigned_int) {
        EXPECT_EQ(read->ids[i], plane.ids[i]);
      } else {
        EXPECT_EQ(read->values[i], plane.values[i]) << plane.name << " " << i;
      }
    }
  }
  auto input = OIIO::ImageInput::open(dir.file("a.exr"));
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.channelformat(spec.channelindex("R")), OIIO::TypeHalf);
  EXPECT_EQ(spec.channelformat(spec.channelindex("A")), OIIO::TypeHalf);
  EXPECT_EQ(spec.channelformat(spec.channelindex("Z")), OIIO::TypeFloat);
  EXPECT_EQ(spec.channelformat(spec.channelindex("primID.I")), OIIO::TypeUInt32);
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
}

// Pictures taller than one batch of rows are whole, at heights around the batch.
TEST(Exr, RowsAreCompleteAtAnyHeight) {
  const TempDir dir;
  for (const std::uint32_t height : {1u, 63u, 64u, 65u, 130u}) {
    Picture picture = color_picture(3, height, 0, 0, 0, 1);
    picture.planes[1] = float_plane("G", PlaneType::single_float, 3 * height, 0, 1);
    write_image(dir.file("a.exr"), picture);
    const Picture back = read_image(dir.file("a.exr"));
    const PicturePlane* green = back.find("G");
    ASSERT_NE(green, nullptr);
    for (std::size_t i = 0; i < 3 * height; ++i) ASSERT_EQ(green->values[i], static_cast<float>(i));
  }
}

TEST(Exr, CropKeepsItsPlaceInTheFrame) {
  const TempDir dir;
  Picture picture = color_picture(4, 3, 1, 1, 1, 1);
  picture.x = 10, picture.y = 20, picture.full_width = 64, picture.full_height = 48;
  write_image(dir.file("a.exr"), picture);
  const Picture back = read_image(dir.file("a.exr"));
  EXPECT_EQ(back.x, 10u);
  EXPECT_EQ(back.y, 20u);
  EXPECT_EQ(back.width, 4u);
  EXPECT_EQ(back.height, 3u);
  EXPECT_EQ(back.full_width, 64u);
  EXPECT_EQ(back.full_height, 48u);
}

TEST(Exr, NonFiniteAndLargeNumbersAreKept) {
  const TempDir dir;
  Picture picture = color_picture(4, 1, 0, 0, 0, 1);
  picture.planes[0].values[0] = kNaN;
  picture.planes[0].values[1] = kInf;
  picture.planes[0].values[2] = -kInf;
  picture.planes[0].values[3] = 1e9f;
  write_image(dir.file("a.exr"), picture);
  const Picture back = read_image(dir.file("a.exr"));
  const PicturePlane& red = *back.find("R");
  EXPECT_TRUE(std::isnan(red.values[0]));
  EXPECT_EQ(red.values[1], kInf);
  EXPECT_EQ(red.values[2], -kInf);
  EXPECT_EQ(red.values[3], 1e9f);
}

TEST(Exr, MetadataIsWritten) {
  const TempDir dir;
  ImageMetadata metadata;
  metadata.software = "oktett 1.2.3";
  metadata.command_line = "oktett render a.yaml";
  metadata.scene = "a.yaml";
  metadata.samples = 16;
  metadata.render_seconds = 1.5;
  metadata.camera = camera_matrices(Camera{}, 20, 10);
  metadata.origin = {432100.25, 5411000, -300};
  write_image(dir.file("a.exr"), color_picture(2, 2, 1, 1, 1, 1), metadata);
  // As OpenEXR stores three doubles: name, type, number of bytes.
  std::string origin("origin\0v3d\0\x18\0\0\0", 15);
  for (int k = 0; k < 3; ++k)
    origin.append(reinterpret_cast<const char*>(&metadata.origin[k]), sizeof(double));
  EXPECT_NE(test::file_content(dir.file("a.exr")).find(origin), std::string::npos);
  const OIIO::ImageSpec spec = OIIO::ImageInput::open(dir.file("a.exr"))->spec();
  EXPECT_EQ(spec.get_string_attribute("Software"), metadata.software);
  EXPECT_EQ(spec.get_string_attribute("commandLine"), metadata.command_line);
  EXPECT_EQ(spec.get_string_attribute("scene"), "a.yaml");
  EXPECT_EQ(spec.get_int_attribute("samples"), 16);
  EXPECT_EQ(spec.get_float_attribute("renderSeconds"), 1.5f);
  const std::pair<const char*, const Matrix4*> matrices[] = {
      {"worldToCamera", &metadata.camera->world_to_camera}, {"worldToNDC", &metadata.camera->world_to_ndc}};
  for (const auto& [name, expected] : matrices) {
    const auto* attribute = spec.find_attribute(name, OIIO::TypeMatrix);
    ASSERT_NE(attribute, nullptr) << name;
    for (std::size_t i = 0; i < 16; ++i)
      EXPECT_EQ(static_cast<const float*>(attribute->data())[i], (*expected)[i]);
  }
}

// Every 8-bit value that sRGB can name survives linear light and back.
TEST(Srgb, EightBitValuesSurviveTheRoundTrip) {
  for (int v = 0; v < 256; ++v) EXPECT_EQ(linear_to_srgb8(srgb_to_linear(static_cast<float>(v) / 255)), v);
  EXPECT_NEAR(linear_to_srgb(0.18f), 0.46135613f, 1e-6f);
  EXPECT_NEAR(srgb_to_linear(0.5f), 0.21404114f, 1e-6f);
}

// The rounded curve, by the formula of the standard in double, at floats from the smallest to 1; on a step of
// the curve either side is right.
TEST(Srgb, EightBitValuesAreTheRoundedCurve) {
  for (std::uint32_t bits = 0; bits <= 0x3f800000; bits += 251) {
    const float linear = std::bit_cast<float>(bits);
    const double v = linear;
    const double encoded = 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
    ASSERT_LE(std::abs(linear_to_srgb8(linear) - encoded), 0.5001) << linear;
  }
}

TEST(Png, HoldsSrgbDividedByAlpha) {
  const TempDir dir;
  write_image(dir.file("a.png"), color_picture(2, 1, 0.18f, 0.09f, 0.5f, 0.5f));
  const std::vector<std::uint8_t> bytes = raw_bytes(dir.file("a.png"));
  const auto encoded = [](double v) { return std::lround(255 * (1.055 * std::pow(v, 1 / 2.4) - 0.055)); };
  ASSERT_EQ(bytes.size(), 8u);
  for (std::size_t pixel = 0; pixel < 2; ++pixel) {
    EXPECT_EQ(bytes[pixel * 4], encoded(0.36));
    EXPECT_EQ(bytes[pixel * 4 + 1], encoded(0.18));
    EXPECT_EQ(bytes[pixel * 4 + 2], 255);
    EXPECT_EQ(bytes[pixel * 4 + 3], 128);
  }
}

TEST(Png, NonFiniteNumbersBecomeZero) {
  const TempDir dir;
  Picture picture = color_picture(1, 1, kNaN, kInf, -1, 1);
  write_image(dir.file("a.png"), picture);
  EXPECT_EQ(raw_bytes(dir.file("a.png")), (std::vector<std::uint8_t>{0, 0, 0, 255}));
  picture = color_picture(1, 1, 1, 1, 1, kNaN);
  write_image(dir.file("a.png"), picture);
  EXPECT_EQ(raw_bytes(dir.file("a.png"))[3], 0);
}

TEST(Png, ReadsBackAsLinearPremultipliedLight) {
  const TempDir dir;
  write_image(dir.file("a.png"), color_picture(3, 2, 0.2f, 0.4f, 0.1f, 0.5f));
  const Picture back = read_image(dir.file("a.png"));
  EXPECT_NEAR(back.find("R")->values[4], 0.2f, 0.003f);
  EXPECT_NEAR(back.find("G")->values[4], 0.4f, 0.003f);
  EXPECT_NEAR(back.find("A")->values[4], 0.5f, 0.003f);
}

TEST(WriteImage, DropsPlanesAndAlphaThatAFormatCannotHold) {
  const TempDir dir;
  Picture picture = color_picture(4, 4, 0.5f, 0.25f, 0.125f, 1);
  picture.planes.push_back(float_plane("Z", PlaneType::single_float, 16, 0, 1));
  for (const char* name :
       {"a.png", "a.jpg", "a.jpeg", "a.tif", "a.tiff", "a.hdr", "a.bmp", "a.tga", "A.PNG"}) {
    check_output(dir.file(name));
    EXPECT_FALSE(keeps_all_planes(name));
    write_image(dir.file(name), picture);
    const Picture back = read_image(dir.file(name));
    EXPECT_LE(back.planes.size(), 4u) << name;
    EXPECT_NEAR(back.find("R")->values[5], 0.5f, 0.02f) << name;
    EXPECT_NEAR(back.find("B")->values[5], 0.125f, 0.02f) << name;
  }
  EXPECT_TRUE(keeps_all_planes("a.exr"));
}

TEST(CheckOutput, RefusesWhatCannotBeWritten) {
  const TempDir dir;
  const std::string plain = dir.write("plain", "x");
  const auto kind = [](const std::string& path) { return kind_of([&] { check_output(path); }); };
  EXPECT_EQ(kind(""), ErrorKind::bad_input);
  EXPECT_EQ(kind("-"), ErrorKind::bad_input);
  EXPECT_EQ(kind(dir.file("a")), ErrorKind::bad_input);
  EXPECT_EQ(kind(dir.file("a.xyz")), ErrorKind::bad_input);
  EXPECT_EQ(kind(dir.file("a.null")), ErrorKind::bad_input);
  EXPECT_EQ(kind(dir.file("missing/a.png")), ErrorKind::io);
  EXPECT_EQ(kind(plain + "/a.png"), ErrorKind::io);
  EXPECT_EQ(kind("/proc/a.png"), ErrorKind::io);
  EXPECT_EQ(kind(dir.path().string()), ErrorKind::io);
  EXPECT_EQ(kind(dir.path().string() + "/"), ErrorKind::io);
  fs::create_directory(dir.path() / "directory.png");
  EXPECT_EQ(kind(dir.file("directory.png")), ErrorKind::io);
  EXPECT_EQ(test::file_count(dir), 2u);
}

// Writers that make no file: for them the format is an unknown one.
TEST(CheckOutput, RefusesWritersThatMakeNoFile) {
  const TempDir dir;
  std::string without;
  for (const char* extension : {"null", "term"}) {
    if (OIIO::ImageOutput::create(std::string("a.") + extension) == nullptr)
      without += std::string(" ") + extension;
    const std::string path = dir.file(std::string("a.") + extension);
    EXPECT_EQ(kind_of([&] { check_output(path); }), ErrorKind::bad_input) << path;
    EXPECT_EQ(kind_of([&] { write_image(path, color_picture(4, 4, 1, 1, 1, 1)); }), ErrorKind::bad_input)
        << path;
  }
  EXPECT_EQ(test::file_count(dir), 0u);
  if (!without.empty()) GTEST_SKIP() << "OpenImageIO has no writers that would be refused:" << without;
}

TEST(CheckOutput, NamesKnownFormats) {
  try {
    check_output("a.xyz");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(".exr"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find(".png"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find(".ppm"), std::string::npos);
  }
}

TEST(CheckOutput, LeavesAnExistingFileAlone) {
  const TempDir dir;
  const std::string path = dir.write("a.png", "old");
  check_output(path);
  EXPECT_EQ(test::file_content(path), "old");
  EXPECT_EQ(test::file_count(dir), 1u);
}

// A failure after writing began: the format cannot hold the picture.
TEST(WriteImage, FailureLeavesTheOldFileAndNoTemporary) {
  const TempDir dir;
  const std::string path = dir.write("a.ico", "old");
  EXPECT_EQ(kind_of([&] { write_image(path, color_picture(1000, 1, 1, 1, 1, 1)); }), ErrorKind::io);
  EXPECT_EQ(test::file_content(path), "old");
  EXPECT_EQ(test::file_count(dir), 1u);
  EXPECT_EQ(kind_of([&] { write_image(dir.file("missing/a.png"), color_picture(1, 1, 1, 1, 1, 1)); }),
            ErrorKind::io);
}

TEST(WriteImage, FollowsSymbolicLinks) {
  const TempDir dir;
  fs::create_directory(dir.path() / "real");
  fs::create_symlink("real/a.png", dir.path() / "a.png");
  write_image(dir.file("a.png"), color_picture(1, 1, 1, 1, 1, 1));
  EXPECT_TRUE(fs::is_symlink(dir.path() / "a.png"));
  EXPECT_TRUE(fs::is_regular_file(dir.path() / "real" / "a.png"));
}

TEST(WriteImage, RefusesPlanesOfWrongSize) {
  const TempDir dir;
  Picture picture = color_picture(2, 2, 1, 1, 1, 1);
  picture.planes[1].values.resize_uninitialized(3);
  EXPECT_THROW(write_image(dir.file("a.exr"), picture), Error);
  EXPECT_THROW(write_image(dir.file("a.exr"), Picture{}), Error);
  EXPECT_EQ(test::file_count(dir), 0u);
}

}  // namespace
}  // namespace oktett::image_test
