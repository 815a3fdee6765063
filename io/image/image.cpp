#include "io/image/image.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "core/error.h"
#include "io/image/library.h"
#include "io/image/output.h"

namespace oktett {
namespace {

using Format = std::pair<const char*, PictureLayout>;
/// Every OpenImageIO writes these.
constexpr Format kCommonFormats[] = {
    {".exr", PictureLayout::all_planes}, {".png", PictureLayout::srgb8}, {".jpg", PictureLayout::srgb8},
    {".jpeg", PictureLayout::srgb8},     {".tif", PictureLayout::srgb8}, {".tiff", PictureLayout::srgb8},
    {".hdr", PictureLayout::float_rgb},  {".bmp", PictureLayout::srgb8}, {".tga", PictureLayout::srgb8}};

std::string extension_of(const std::string& path) { return std::filesystem::path(path).extension().string(); }

/// Without the image library, for formats that need no asking.
std::optional<PictureLayout> common_layout(const std::string& path) {
  const std::string extension = extension_of(path);
  for (const Format& format : kCommonFormats)
    if (extension == format.first) return format.second;
  return std::nullopt;
}

void check_planes(const Picture& picture) {
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  if (pixels == 0) throw Error("the picture has no pixels");
  for (const PicturePlane& plane : picture.planes) {
    const std::size_t held = plane.type == PlaneType::unsigned_int ? plane.ids.size() : plane.values.size();
    if (held != pixels)
      throw Error(fmt::format("plane {} holds {} numbers, expected {}", plane.name, held, pixels));
  }
}

Picture one_pixel() {
  Picture picture;
  picture.width = picture.height = picture.full_width = picture.full_height = 1;
  for (const char* name : {"R", "G", "B", "A"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(1, 0.5f), {}});
  return picture;
}

}  // namespace

void check_output(const std::string& path) {
  if (path.empty()) throw Error("the name of the output file is empty");
  if (path == "-")
    throw Error("cannot write the picture to standard output: the format follows from a file name");
  if (path.find('\0') != std::string::npos) throw Error("the name of the output file contains a zero byte");
  if (std::filesystem::path(path).filename().empty() || std::filesystem::is_directory(path))
    throw Error(Location{path}, "cannot write: is a directory", ErrorKind::io);
  if (common_layout(path) && image_library_is_installed()) {
    const OutputFile file(path);
    return;
  }
  const ImageLibrary& library = image_library();
  if (!library.layout(path))
    throw Error(Location{path}, "unknown image format '" + extension_of(path) +
                                    "': known ones are .exr, .png, .jpg, .tif, .hdr, .bmp, .tga, .webp");
  const OutputFile file(path);
  library.write(path, file.temporary(), one_pixel(), {});
}

bool keeps_all_planes(const std::string& path) {
  std::optional<PictureLayout> layout = common_layout(path);
  if (!layout) layout = image_library().layout(path);
  return layout == PictureLayout::all_planes;
}

void write_image(const std::string& path, const Picture& picture, const ImageMetadata& metadata) {
  check_planes(picture);
  const ImageLibrary& library = image_library();
  if (!library.layout(path)) throw Error(Location{path}, "unknown image format");
  OutputFile file(path);
  library.write(path, file.temporary(), picture, metadata);
  file.commit();
}

Picture read_image(const std::string& path) { return image_library().read(path); }

HeightImage read_heights(const std::string& path, std::uint32_t most_side, std::size_t most_pixels) {
  return image_library().read_heights(path, most_side, most_pixels);
}

}  // namespace oktett
