#include "io/image/oiio/frame.h"

#include <fmt/format.h>

#include "io/image/oiio/open_image.h"

namespace oktett::oiio {

ImageFrame frame_of(const OIIO::ImageSpec& spec, const std::string& format, const std::string& path) {
  ImageFrame frame{static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), 0, 0,
                   true};
  const bool same = spec.x == spec.full_x && spec.y == spec.full_y && spec.width == spec.full_width &&
                    spec.height == spec.full_height;
  if (format != "openexr" || same) return frame;
  if (spec.full_width <= 0 || spec.full_height <= 0) fail(path, "the display window of the image is empty");
  check_size_in_memory(path, spec.full_width, spec.full_height, spec.nchannels);
  frame.width = static_cast<std::uint32_t>(spec.full_width);
  frame.height = static_cast<std::uint32_t>(spec.full_height);
  frame.x = std::int64_t{spec.x} - spec.full_x, frame.y = std::int64_t{spec.y} - spec.full_y;
  frame.is_whole = false;
  return frame;
}

}  // namespace oktett::oiio
