#include "io/image/library.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "io/image/image.h"
#include "io/image/texture.h"
#include "tests/support/temp_dir.h"

namespace oktett::image_library_test {
namespace {

using test::TempDir;

/// True if this process has a file of this name in its memory.
bool is_loaded(const std::string& name) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find(name) != std::string::npos) return true;
  return false;
}

// This program does not link OpenImageIO itself.
TEST(ImageLibrary, IsLoadedForReadingAndOtherFormatsThanPngAndExr) {
  const TempDir dir;
  const std::string path = dir.file("a.png");
  EXPECT_TRUE(image_library_is_installed());
  for (const char* name : {"a.png", "a.exr", "a.jpeg"}) check_output(dir.file(name));
  EXPECT_TRUE(keeps_all_planes("a.exr"));
  EXPECT_FALSE(keeps_all_planes("a.png"));
  const ImageTextures none({});
  EXPECT_EQ(none.color(0, {0, 0}, {0, 0}, {0, 0}), (Color{1, 1, 1}));
  EXPECT_EQ(none.value(0, {0, 0}, {0, 0}, {0, 0}), 1);
  EXPECT_EQ(none.normal(0, {0, 0}, {0, 0}, {0, 0}), (Vec3f{0.5f, 0.5f, 1}));

  Picture picture;
  picture.width = picture.height = 2;
  for (const char* name : {"R", "G", "B"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(4, 1.0f), {}});
  write_image(path, picture);
  write_image(dir.file("a.exr"), picture);
  EXPECT_FALSE(is_loaded("liboktett_images"));
  EXPECT_FALSE(is_loaded("libOpenImageIO"));

  write_image(dir.file("a.jpg"), picture);
  EXPECT_TRUE(is_loaded("liboktett_images"));
  EXPECT_TRUE(is_loaded("libOpenImageIO"));
  EXPECT_EQ(read_image(path).find("G")->values[3], 1);
}

TEST(ImageLibrary, ErrorsComeThroughWithTheirKindAndPlace) {
  const TempDir dir;
  const std::string path = dir.write("a.png", "no image");
  try {
    read_image(path);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_EQ(error.where().file, path);
    EXPECT_EQ(std::string(error.what()).find(path + ": cannot read the image"), 0u) << error.what();
  }
}

}  // namespace
}  // namespace oktett::image_library_test
