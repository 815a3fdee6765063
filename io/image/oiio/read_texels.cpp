#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstddef>
#include <memory>

#include "io/image/oiio/open_image.h"

namespace oktett::oiio {

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
  image.width = static_cast<std::uint32_t>(spec.width);
  image.height = static_cast<std::uint32_t>(spec.height);
  image.colors = spec.nchannels < 3 ? 1 : 3;
  const int alpha = source.alpha ? spec.alpha_channel : -1;
  image.alpha = alpha >= 0;
  image.encoding = color_encoding(spec);
  if (spec.format.basetype == OIIO::TypeDesc::UINT8)
    image.bytes =
        read_texel_numbers<std::uint8_t>(*input, source.path, OIIO::TypeDesc::UINT8, image.colors, alpha);
  else
    image.floats = read_texel_numbers<float>(*input, source.path, OIIO::TypeDesc::FLOAT, image.colors, alpha);
  return image;
}

}  // namespace oktett::oiio
