#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <vector>

#include "core/error.h"
#include "io/image/color.h"
#include "io/image/oiio/open_image.h"

namespace oktett::oiio {
namespace {

using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr float kLargestHalf = 65504;
constexpr std::uint32_t kRowsAtOnce = 64;

PictureLayout layout_of(const ImageOutput& output) {
  const std::string format = output.format_name();
  if (format == "openexr") return PictureLayout::all_planes;
  return format == "hdr" ? PictureLayout::float_rgb : PictureLayout::srgb8;
}

/// The writer for `path`'s extension, or null. Leaves out those that make no file.
ImageOutput::unique_ptr find_writer(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  ImageOutput::unique_ptr output;
  if (!extension.empty()) output = ImageOutput::create("picture" + extension);
  OIIO::geterror();
  if (output &&
      (std::strcmp(output->format_name(), "null") == 0 || std::strcmp(output->format_name(), "term") == 0))
    output.reset();
  return output;
}

TypeDesc file_type(PlaneType type) {
  if (type == PlaneType::half_float) return TypeDesc::HALF;
  return type == PlaneType::single_float ? TypeDesc::FLOAT : TypeDesc::UINT32;
}

void add_metadata(ImageSpec& spec, const ImageMetadata& metadata) {
  if (!metadata.software.empty()) spec.attribute("Software", metadata.software);
  if (!metadata.command_line.empty()) spec.attribute("commandLine", metadata.command_line);
  if (!metadata.scene.empty()) spec.attribute("scene", metadata.scene);
  if (metadata.samples > 0) spec.attribute("samples", static_cast<int>(metadata.samples));
  if (metadata.render_seconds > 0)
    spec.attribute("renderSeconds", static_cast<float>(metadata.render_seconds));
  if (metadata.camera) {
    // OpenImageIO stores these as OpenEXR's worldToCamera and worldToNDC.
    spec.attribute("worldtocamera", OIIO::TypeMatrix, metadata.camera->world_to_camera.data());
    spec.attribute("worldtoNDC", OIIO::TypeMatrix, metadata.camera->world_to_ndc.data());
  }
}

/// Copies `count` pixels of a plane to every `stride` bytes of `out`, in the type the file has.
void pack_plane(const PicturePlane& plane, std::size_t first, std::size_t count, std::byte* out,
                std::size_t stride) {
  const auto copy = [&](const auto* numbers) {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(out + i * stride, numbers + i, sizeof *numbers);
  };
  if (plane.type == PlaneType::unsigned_int) return copy(&plane.ids[first]);
  if (plane.type == PlaneType::single_float) return copy(&plane.values[first]);
  std::vector<float> finite(count);
  std::vector<std::uint16_t> halves(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float v = plane.values[first + i];
    finite[i] = std::isfinite(v) ? std::clamp(v, -kLargestHalf, kLargestHalf) : v;
  }
  OIIO::convert_pixel_values(TypeDesc::FLOAT, finite.data(), TypeDesc::HALF, halves.data(),
                             static_cast<int>(count));
  copy(halves.data());
}

/// All planes of a row, pixel after pixel. A row stays in the cache while plane after plane is added.
void pack_row(const Picture& picture, std::uint32_t row, std::byte* out, std::size_t pixel_bytes) {
  for (const PicturePlane& plane : picture.planes) {
    pack_plane(plane, std::size_t{row} * picture.width, picture.width, out, pixel_bytes);
    out += file_type(plane.type).size();
  }
}

bool write_planes(ImageOutput& output, const std::string& path, const Picture& picture,
                  const ImageMetadata& metadata) {
  ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height),
                 static_cast<int>(picture.planes.size()), TypeDesc::FLOAT);
  spec.channelnames.clear();
  spec.x = static_cast<int>(picture.x), spec.y = static_cast<int>(picture.y);
  if (picture.full_width > 0 && picture.full_height > 0)
    spec.full_width = static_cast<int>(picture.full_width),
    spec.full_height = static_cast<int>(picture.full_height);
  spec.full_x = spec.full_y = 0;
  spec.alpha_channel = spec.z_channel = -1;
  std::size_t pixel_bytes = 0;
  for (const PicturePlane& plane : picture.planes) {
    const TypeDesc type = file_type(plane.type);
    if (plane.name == "A") spec.alpha_channel = static_cast<int>(spec.channelnames.size());
    if (plane.name == "Z") spec.z_channel = static_cast<int>(spec.channelnames.size());
    spec.channelnames.push_back(plane.name);
    spec.channelformats.push_back(type);
    pixel_bytes += type.size();
  }
  // Level 2 takes half the time of the default and makes files that are a few percent larger.
  spec.attribute("compression", "zip:2");
  spec.attribute("oiio:ColorSpace", "Linear");
  add_metadata(spec, metadata);
  if (!output.open(path, spec)) return false;

  std::vector<std::byte> rows(pixel_bytes * picture.width * std::min(picture.height, kRowsAtOnce));
  for (std::uint32_t y = 0; y < picture.height; y += kRowsAtOnce) {
    const std::uint32_t y_end = std::min(y + kRowsAtOnce, picture.height);
    for (std::uint32_t row = y; row < y_end; ++row)
      pack_row(picture, row, rows.data() + std::size_t{row - y} * picture.width * pixel_bytes, pixel_bytes);
    if (!output.write_scanlines(spec.y + static_cast<int>(y), spec.y + static_cast<int>(y_end), 0,
                                TypeDesc::UNKNOWN, rows.data()))
      return false;
  }
  return output.close();
}

const PicturePlane& color_plane(const Picture& picture, const char* name) {
  const PicturePlane* plane = picture.find(name);
  if (plane == nullptr || plane->type == PlaneType::unsigned_int)
    throw Error(fmt::format("the picture has no colour plane {}, which this format needs", name));
  return *plane;
}

std::array<const PicturePlane*, 3> color_planes(const Picture& picture) {
  return {&color_plane(picture, "R"), &color_plane(picture, "G"), &color_plane(picture, "B")};
}

ImageSpec flat_spec(const Picture& picture, int channels, TypeDesc type, const ImageMetadata& metadata) {
  ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), channels, type);
  spec.attribute("oiio:ColorSpace", type == TypeDesc::UINT8 ? "sRGB" : "Linear");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 95);
  add_metadata(spec, metadata);
  return spec;
}

bool write_float_rgb(ImageOutput& output, const std::string& path, const Picture& picture,
                     const ImageMetadata& metadata) {
  const std::array<const PicturePlane*, 3> planes = color_planes(picture);
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  std::vector<float> rgb(pixels * 3);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float v = planes[c]->values[i];
      rgb[i * 3 + c] = std::isfinite(v) ? v : 0;
    }
  return output.open(path, flat_spec(picture, 3, TypeDesc::FLOAT, metadata)) &&
         output.write_image(TypeDesc::FLOAT, rgb.data()) && output.close();
}

/// Coverage in [0, 1]; NaN and infinities count as none.
float clamped_alpha(float a) { return std::isfinite(a) ? std::clamp(a, 0.0f, 1.0f) : 0; }

bool write_srgb8(ImageOutput& output, const std::string& path, const Picture& picture,
                 const ImageMetadata& metadata) {
  const std::array<const PicturePlane*, 3> planes = color_planes(picture);
  const PicturePlane* alpha =
      output.supports("alpha") && picture.find("A") != nullptr ? &color_plane(picture, "A") : nullptr;
  const std::size_t channels = alpha != nullptr ? 4 : 3;
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  std::vector<std::uint8_t> bytes(pixels * channels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const float a = alpha != nullptr ? clamped_alpha(alpha->values[i]) : 1;
    // Without coverage there is no colour to recover; what light there is (a glow) is kept as it is.
    const float divisor = a > 0 ? a : 1;
    for (std::size_t c = 0; c < 3; ++c)
      bytes[i * channels + c] = linear_to_srgb8(planes[c]->values[i] / divisor);
    if (channels == 4) bytes[i * channels + 3] = static_cast<std::uint8_t>(a * 255 + 0.5f);
  }
  return output.open(path, flat_spec(picture, static_cast<int>(channels), TypeDesc::UINT8, metadata)) &&
         output.write_image(TypeDesc::UINT8, bytes.data()) && output.close();
}

}  // namespace

std::optional<PictureLayout> OpenImageIoLibrary::layout(const std::string& path) const {
  const ImageOutput::unique_ptr output = find_writer(path);
  if (!output) return std::nullopt;
  return layout_of(*output);
}

void OpenImageIoLibrary::write(const std::string& path, const std::string& temporary, const Picture& picture,
                               const ImageMetadata& metadata) const {
  const ImageOutput::unique_ptr writer = find_writer(path);
  if (!writer) throw Error(Location{path}, "unknown image format");
  ImageOutput& output = *writer;
  bool written = false;
  std::string why;
  try {
    const PictureLayout layout = layout_of(output);
    const auto write_as = layout == PictureLayout::all_planes  ? write_planes
                          : layout == PictureLayout::float_rgb ? write_float_rgb
                                                               : write_srgb8;
    written = write_as(output, temporary, picture, metadata);
    if (!written) why = output.geterror();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    why = error.what();
  }
  if (!written) fail(path, "cannot write: " + first_line(why, "unknown reason"));
}

}  // namespace oktett::oiio
