#include "io/image/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/image/cube_map.h"
#include "io/image/encode.h"
#include "io/image/library.h"
#include "io/image/output.h"
#include "io/text/files.h"

namespace oktett {
namespace {

using Writer = void (*)(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes);
struct Format {
  const char* extension;
  Writer write;  ///< null: OpenImageIO does, and every version of it can
};
constexpr Format kCommonFormats[] = {{".exr", write_exr}, {".sxr", write_exr}, {".mxr", write_exr},
                                     {".png", write_png}, {".jpg", nullptr},   {".jpeg", nullptr},
                                     {".tif", nullptr},   {".tiff", nullptr},  {".hdr", nullptr},
                                     {".bmp", nullptr},   {".tga", nullptr}};

std::string extension_of(const std::string& path) { return std::filesystem::path(path).extension().string(); }

/// The format of `path` if it is one of the above, else null.
const Format* common_format(const std::string& path) {
  std::string extension = extension_of(path);
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const Format& format : kCommonFormats)
    if (extension == format.extension) return &format;
  return nullptr;
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

/// That nothing is known about files with that extension.
std::string unknown_format(const std::string& extension) {
  const std::vector<std::string> known{".exr", ".png", ".jpg", ".tif", ".hdr",
                                       ".bmp", ".tga", ".ppm", ".webp"};
  const std::string near = extension.size() < 3 ? "" : did_you_mean(extension, known);
  return fmt::format("unknown image format '{}'{}", extension,
                     near.empty() ? fmt::format(": known ones are {}", fmt::join(known, ", ")) : near);
}

/// Writes `image` with OpenImageIO. Its writers get no file where that can be avoided: many do not report
/// that the disk is full, and the one of JPEG ends the process.
void write_by_library(OutputFile& file, const std::string& path, const FlatImage& image,
                      const std::vector<Attribute>& attributes) {
  const ImageLibrary& library = image_library();
  if (const auto bytes = library.encode(path, image, attributes))
    file.write({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  else
    library.write(path, file.temporary(), image, attributes);
}

/// Not smaller, because some writers (those of JPEG 2000 and FITS) fail with few pixels.
Picture small_picture() {
  constexpr std::uint32_t kSide = 64;
  Picture picture;
  picture.width = picture.height = picture.full_width = picture.full_height = kSide;
  for (const char* name : {"R", "G", "B", "A"})
    picture.planes.push_back({name, PlaneType::half_float, Column<float>(kSide * kSide, 0.5f), {}});
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
  const Format* format = common_format(path);
  if (format != nullptr && (format->write != nullptr || image_library_is_installed())) {
    const OutputFile file(path);
    return;
  }
  const ImageLibrary& library = image_library();
  const std::optional<PixelLayout> layout = library.layout(path);
  if (!layout) throw Error(Location{path}, unknown_format(extension_of(path)));
  OutputFile file(path);
  write_by_library(file, path, flatten(small_picture(), *layout), {});
}

bool keeps_all_planes(const std::string& path) {
  const Format* format = common_format(path);
  return format != nullptr && format->write == write_exr;
}

bool keeps_light(const std::string& path) {
  const Format* format = common_format(path);
  return format != nullptr && (format->write == write_exr || std::string_view(format->extension) == ".hdr");
}

void write_image(const std::string& path, const Picture& picture, const ImageMetadata& metadata) {
  check_planes(picture);
  if (const Format* format = common_format(path); format != nullptr && format->write != nullptr) {
    OutputFile file(path);
    format->write(file, picture, attributes(metadata));
    file.commit();
    return;
  }
  const ImageLibrary& library = image_library();
  const std::optional<PixelLayout> layout = library.layout(path);
  if (!layout) throw Error(Location{path}, "unknown image format");
  OutputFile file(path);
  write_by_library(file, path, flatten(picture, *layout), attributes(metadata));
  file.commit();
}

bool can_store_words(const std::string& path) {
  const Format* format = common_format(path);
  return format != nullptr && std::string_view(format->extension) == ".png";
}

static void write_words(const std::string& path, const FlatImage& image,
                        const std::vector<Attribute>& attributes) {
  if (!can_store_words(path)) throw Error(Location{path}, "only PNG files are written with 16 bits");
  OutputFile file(path);
  write_png(file, image, attributes);
  file.commit();
}

void write_image16(const std::string& path, const Picture& picture, const ImageMetadata& metadata) {
  check_planes(picture);
  write_words(path, flatten(picture, PixelLayout::srgb16_alpha), attributes(metadata));
}

/// The plane Z of finite depths.
static const PicturePlane& depth_plane(const Picture& picture) {
  check_planes(picture);
  const PicturePlane* plane = picture.find("Z");
  if (plane == nullptr || plane->type == PlaneType::unsigned_int) throw Error("the picture has no plane Z");
  return *plane;
}

/// The greatest number but one, which stands for all that is farther.
static constexpr double kMostDepth = 65534;

double depth_unit(const Picture& picture) {
  double farthest = 0;
  for (const float z : depth_plane(picture).values)
    if (std::isfinite(z)) farthest = std::max(farthest, static_cast<double>(z));
  if (!(farthest > 0)) return 1;
  int exponent = static_cast<int>(std::ceil(std::log10(farthest / kMostDepth)));
  while (farthest / std::pow(10.0, exponent) > kMostDepth) ++exponent;
  while (farthest / std::pow(10.0, exponent - 1) <= kMostDepth) --exponent;
  return std::pow(10.0, exponent);
}

void write_depth(const std::string& path, const Picture& picture, double unit,
                 const ImageMetadata& metadata) {
  const PicturePlane& plane = depth_plane(picture);
  FlatImage image{picture.width, picture.height, 1, {}, {}};
  image.words.reserve(plane.values.size());
  for (const float z : plane.values) {
    const double steps = std::round(static_cast<double>(z) / unit);
    image.words.push_back(std::isfinite(z)
                              ? static_cast<std::uint16_t>(std::clamp(steps, 1.0, kMostDepth + 1))
                              : std::uint16_t{0});
  }
  std::vector<Attribute> all = attributes(metadata);
  all.push_back({"depthUnit", fmt::format("{}", unit)});
  write_words(path, image, all);
}

Picture read_image(const std::string& path) { return image_library().read(image_to_open(path)); }

EnvironmentPicture read_environment_image(const std::string& path) {
  const EnvironmentImage image = image_library().read_environment(image_to_open(path));
  const Picture& picture = image.picture;
  const PicturePlane* planes[3] = {picture.find("R"), picture.find("G"), picture.find("B")};
  EnvironmentPicture environment;
  environment.width = picture.width, environment.height = picture.height;
  environment.pixels.resize(std::size_t{picture.width} * picture.height);
  for (std::size_t i = 0; i < environment.pixels.size(); ++i)
    environment.pixels[i] = {planes[0]->values[i], planes[1]->values[i], planes[2]->values[i]};
  return image.is_cube ? unfolded_cube(environment) : environment;
}

HeightImage read_heights(const std::string& path, std::uint32_t most_side, std::size_t most_pixels) {
  return image_library().read_heights(image_to_open(path), most_side, most_pixels);
}

}  // namespace oktett
