#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/image/color.h"
#include "io/image/oiio/frame.h"
#include "io/image/oiio/open_image.h"

namespace oktett::oiio {

namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

bool is_id(const ImageSpec& spec, int channel) {
  return spec.channelformat(channel).basetype == TypeDesc::UINT32;
}

/// Reads channels [begin, end), all ids or all numbers, and appends them to the picture.
void append_planes(OIIO::ImageInput& input, const ImageSpec& spec, const std::string& path, int begin,
                   int end, Picture& picture) {
  const std::size_t count = static_cast<std::size_t>(end - begin);
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  const bool ids = is_id(spec, begin);
  Column<std::uint32_t> words(pixels * count);
  const TypeDesc type = ids ? TypeDesc::UINT32 : TypeDesc::FLOAT;
  read_channels(input, path, begin, end, type, words.data());
  for (std::size_t c = 0; c < count; ++c) {
    PicturePlane plane;
    plane.name = spec.channel_name(begin + static_cast<int>(c));
    plane.type = ids ? PlaneType::unsigned_int : PlaneType::single_float;
    if (ids) {
      plane.ids.resize_uninitialized(pixels);
      for (std::size_t i = 0; i < pixels; ++i) plane.ids[i] = words[i * count + c];
    } else {
      plane.values.resize_uninitialized(pixels);
      for (std::size_t i = 0; i < pixels; ++i)
        std::memcpy(&plane.values[i], &words[i * count + c], sizeof(float));
    }
    picture.planes.push_back(std::move(plane));
  }
}

bool is_color(const std::string& name) { return name == "R" || name == "G" || name == "B"; }

/// Grey images become R, G and B like all others.
void expand_grey(Picture& picture) {
  if (picture.find("R") != nullptr) return;
  const auto grey = std::find_if(picture.planes.begin(), picture.planes.end(),
                                 [](const PicturePlane& p) { return p.name == "Y" || p.name == "I"; });
  if (grey == picture.planes.end() || grey->type == PlaneType::unsigned_int) return;
  grey->name = "R";
  PicturePlane green = *grey, blue = *grey;
  green.name = "G", blue.name = "B";
  const auto next = picture.planes.insert(grey + 1, std::move(green));
  picture.planes.insert(next + 1, std::move(blue));
}

void decode_colors(Picture& picture, const ColorEncoding& encoding, bool multiply_by_alpha) {
  const PicturePlane* alpha = multiply_by_alpha ? picture.find("A") : nullptr;
  if (alpha != nullptr && alpha->type == PlaneType::unsigned_int) alpha = nullptr;
  for (PicturePlane& plane : picture.planes) {
    if (!is_color(plane.name) || plane.type == PlaneType::unsigned_int) continue;
    if (encoding.curve != TransferCurve::linear)
      for (float& v : plane.values) v = decode(encoding, v);
    if (alpha != nullptr)
      for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] *= alpha->values[i];
  }
}

/// Light of other primaries than Rec.709.
void convert_primaries(Picture& picture, const ColorMatrix& matrix) {
  PicturePlane* const planes[3] = {picture.find("R"), picture.find("G"), picture.find("B")};
  for (const PicturePlane* plane : planes)
    if (plane == nullptr || plane->type == PlaneType::unsigned_int) return;
  for (std::size_t i = 0; i < planes[0]->values.size(); ++i) {
    const Color light =
        transformed(matrix, {planes[0]->values[i], planes[1]->values[i], planes[2]->values[i]});
    for (int k = 0; k < 3; ++k) planes[k]->values[i] = light[k];
  }
}

/// `what(path)`, whose Error names the file.
template <class What>
auto naming(const std::string& path, const What& what) {
  try {
    return what();
  } catch (const Error& error) {
    const std::string message = error.what();
    if (message.starts_with(path)) throw;
    fail(path, message);
  }
}

/// All planes of the file, as its pixels lie.
Picture read_planes(OIIO::ImageInput& input, const std::string& path) {
  const ImageSpec spec = input.spec();
  Picture picture;
  picture.width = static_cast<std::uint32_t>(spec.width);
  picture.height = static_cast<std::uint32_t>(spec.height);
  for (int begin = 0; begin < spec.nchannels;) {
    int end = begin + 1;
    while (end < spec.nchannels && is_id(spec, end) == is_id(spec, begin)) ++end;
    append_planes(input, spec, path, begin, end, picture);
    begin = end;
  }
  const bool grey = picture.find("R") == nullptr;
  expand_grey(picture);
  const ColorEncoding encoding = naming(path, [&] { return color_encoding(spec); });
  decode_colors(picture, encoding, spec.get_int_attribute("oiio:UnassociatedAlpha") != 0);
  if (encoding.to_rec709 && !grey) convert_primaries(picture, *encoding.to_rec709);
  return picture;
}

}  // namespace

Picture OpenImageIoLibrary::read(const std::string& path) const {
  const OIIO::ImageInput::unique_ptr input = open_image(path);
  const ImageSpec spec = input->spec();
  Picture picture = read_planes(*input, path);
  // A window that does not lie inside the frame cannot be expressed; the pixels themselves are whole.
  const bool inside = spec.full_width > 0 && spec.full_height > 0 && spec.x >= spec.full_x &&
                      spec.y >= spec.full_y &&
                      std::int64_t{spec.x} - spec.full_x + spec.width <= spec.full_width &&
                      std::int64_t{spec.y} - spec.full_y + spec.height <= spec.full_height;
  picture.x = inside ? static_cast<std::uint32_t>(spec.x - spec.full_x) : 0;
  picture.y = inside ? static_cast<std::uint32_t>(spec.y - spec.full_y) : 0;
  picture.full_width = inside ? static_cast<std::uint32_t>(spec.full_width) : picture.width;
  picture.full_height = inside ? static_cast<std::uint32_t>(spec.full_height) : picture.height;
  return picture;
}

EnvironmentImage OpenImageIoLibrary::read_environment(const std::string& path) const {
  const OIIO::ImageInput::unique_ptr input = open_image(path);
  const ImageSpec spec = input->spec();
  EnvironmentImage image;
  image.is_cube = spec.get_string_attribute("textureformat") == "CubeFace Environment";
  if (image.is_cube && spec.height < 6)
    fail(path, fmt::format("a cube map has six faces one above the other, found {} rows", spec.height));
  Picture all = read_planes(*input, path);
  // The faces fill the data window, whatever is displayed.
  const ImageFrame frame = image.is_cube ? ImageFrame{all.width, all.height, 0, 0, true}
                                         : frame_of(spec, input->format_name(), path);
  image.picture.width = image.picture.full_width = frame.width;
  image.picture.height = image.picture.full_height = frame.height;
  for (const char* name : {"R", "G", "B"}) {
    PicturePlane* const plane = all.find(name);
    if (plane == nullptr || plane->type == PlaneType::unsigned_int) fail(path, "the image has no colours");
    plane->values = in_frame(frame, spec, 1, std::move(plane->values));
    image.picture.planes.push_back(std::move(*plane));
  }
  return image;
}

/// Reads the first `colors` channels, and channel `alpha` unless it is negative.
template <class T>
static Column<T> read_texel_numbers(OIIO::ImageInput& input, const std::string& path, OIIO::TypeDesc type,
                                    std::uint32_t colors, int alpha) {
  const OIIO::ImageSpec spec = input.spec();
  const std::size_t pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  const int end = std::max(static_cast<int>(colors), alpha + 1);
  Column<T> numbers(pixels * static_cast<std::size_t>(end));
  read_channels(input, path, 0, end, type, numbers.data());
  const std::size_t read = static_cast<std::size_t>(end), kept = colors + (alpha >= 0 ? 1u : 0u);
  if (kept == read) return numbers;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < colors; ++c) numbers[i * kept + c] = numbers[i * read + c];
    if (alpha >= 0) numbers[i * kept + colors] = numbers[i * read + static_cast<std::size_t>(alpha)];
  }
  numbers.resize_uninitialized(pixels * kept);
  numbers.shrink_to_fit();
  return numbers;
}

TexelImage OpenImageIoLibrary::read_texels(const TextureSource& source) const {
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
  if (source.content != nullptr)
    memory = std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<char*>(source.content->data()),
                                                             source.content->size());
  const OIIO::ImageInput::unique_ptr input = open_image(source.path, memory.get());
  const OIIO::ImageSpec spec = input->spec();
  TexelImage image;
  const ImageFrame frame = frame_of(spec, input->format_name(), source.path);
  image.width = frame.width, image.height = frame.height;
  image.colors = spec.nchannels < 3 ? 1 : 3;
  const int alpha = source.alpha ? spec.alpha_channel : -1;
  image.alpha = alpha >= 0;
  image.encoding = naming(source.path, [&] { return color_encoding(spec); });
  if (source.color_space != TextureColors::of_file) {
    const bool is_srgb = source.color_space == TextureColors::srgb;
    image.encoding.curve = is_srgb ? TransferCurve::srgb : TransferCurve::linear;
    image.encoding.exponent = 1;
  }
  if (spec.format.basetype == OIIO::TypeDesc::UINT8)
    image.bytes =
        read_texel_numbers<std::uint8_t>(*input, source.path, OIIO::TypeDesc::UINT8, image.colors, alpha);
  else
    image.floats =
        in_frame(frame, spec, image.channels(),
                 read_texel_numbers<float>(*input, source.path, OIIO::TypeDesc::FLOAT, image.colors, alpha));
  return image;
}

namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

void check_size(const std::string& path, const ImageSpec& spec, std::uint32_t most_side,
                std::size_t most_pixels) {
  const auto width = static_cast<std::size_t>(spec.width), height = static_cast<std::size_t>(spec.height);
  if (width < 2 || height < 2 || width > most_side || height > most_side)
    fail(path, fmt::format("the image has {} x {} pixels, expected 2 to {} along each side", width, height,
                           most_side));
  if (width * height > most_pixels)
    fail(path,
         fmt::format("the image has {} x {} pixels, expected at most {} in all", width, height, most_pixels));
  if (spec.channelformats.size() > 1)
    for (const TypeDesc& format : spec.channelformats)
      if (format != spec.channelformats[0]) fail(path, "the image has channels of different types");
}

/// How many channels carry heights: one, or three that must agree.
int height_channels(const std::string& path, const ImageSpec& spec) {
  if (spec.nchannels <= 2) return 1;
  if (spec.nchannels <= 4) return 3;
  fail(path, fmt::format("the image has {} channels, expected a grey image", spec.nchannels));
}

/// The first channel of all pixels.
template <class T>
Column<T> read_grey(OIIO::ImageInput& input, const std::string& path, const ImageSpec& spec, TypeDesc type) {
  const int channels = height_channels(path, spec);
  const std::size_t count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  Column<T> grey(count * static_cast<std::size_t>(channels));
  read_channels(input, path, 0, channels, type, grey.data());
  if (channels == 1) return grey;
  Column<T> first(count);
  for (std::size_t i = 0; i < count; ++i) {
    first[i] = grey[3 * i];
    // Not a number differs from itself; that is reported as such.
    if (grey[3 * i] == first[i] && (grey[3 * i + 1] != first[i] || grey[3 * i + 2] != first[i]))
      fail(path,
           fmt::format("the image is not grey: red, green and blue differ at pixel ({}, {})",
                       i % static_cast<std::size_t>(spec.width), i / static_cast<std::size_t>(spec.width)));
  }
  return first;
}

}  // namespace

HeightImage OpenImageIoLibrary::read_heights(const std::string& path, std::uint32_t most_side,
                                             std::size_t most_pixels) const {
  const OIIO::ImageInput::unique_ptr input = open_image(path);
  const ImageSpec spec = input->spec();
  check_size(path, spec, most_side, most_pixels);
  if (!frame_of(spec, input->format_name(), path).is_whole)
    fail(path, "the image has no heights in a part of its display window, or some outside of it");
  HeightImage image;
  image.columns = static_cast<std::uint32_t>(spec.width),
  image.rows = static_cast<std::uint32_t>(spec.height);
  if (spec.format == TypeDesc::UINT8 || spec.format == TypeDesc::UINT16) {
    image.words = read_grey<std::uint16_t>(*input, path, spec, TypeDesc::UINT16);
    return image;
  }
  image.floats = read_grey<float>(*input, path, spec, TypeDesc::FLOAT);
  for (std::size_t i = 0; i < image.floats.size(); ++i)
    if (!std::isfinite(image.floats[i]))
      fail(path, fmt::format("pixel ({}, {}) is not a finite number", i % image.columns, i / image.columns));
  return image;
}

}  // namespace oktett::oiio
