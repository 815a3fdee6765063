#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/image/oiio/open_image.h"

namespace oktett::oiio {
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
