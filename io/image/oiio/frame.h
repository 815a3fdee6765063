#pragma once
/// \file The window of an image that its file shows. Not for other folders.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/soa.h"

namespace oktett::oiio {

/// The frame of an image and where its pixels lie in it: EXR's display and data window. Of other formats,
/// whose programs mean their pixels, these are the frame.
struct ImageFrame {
  std::uint32_t width = 0, height = 0;
  std::int64_t x = 0, y = 0;  ///< of the first pixel of the file
  bool is_whole = true;       ///< the pixels are just those of the frame
};

/// Throws Error of kind io, which names `path`, if the frame is no image or would take too much memory.
ImageFrame frame_of(const OIIO::ImageSpec& spec, const std::string& format, const std::string& path);

/// The pixels of the frame, of `channels` numbers each, from those of the file: 0 where the file has none.
template <class T>
Column<T> in_frame(const ImageFrame& frame, const OIIO::ImageSpec& spec, std::size_t channels,
                   Column<T> pixels) {
  if (frame.is_whole) return pixels;
  Column<T> all(std::size_t{frame.width} * frame.height * channels, T{});
  const std::int64_t width = spec.width, begin = std::max<std::int64_t>(frame.x, 0),
                     end = std::min<std::int64_t>(frame.x + width, frame.width);
  for (std::int64_t y = std::max<std::int64_t>(frame.y, 0);
       y < std::min<std::int64_t>(frame.y + spec.height, frame.height) && begin < end; ++y) {
    const auto from = static_cast<std::size_t>((y - frame.y) * width + begin - frame.x);
    const auto to = static_cast<std::size_t>(y * frame.width + begin);
    std::copy_n(pixels.data() + from * channels, static_cast<std::size_t>(end - begin) * channels,
                all.data() + to * channels);
  }
  return all;
}

}  // namespace oktett::oiio
