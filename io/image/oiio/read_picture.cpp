#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "io/image/color.h"
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

}  // namespace

Picture OpenImageIoLibrary::read(const std::string& path) const {
  const OIIO::ImageInput::unique_ptr input = open_image(path);
  const ImageSpec spec = input->spec();
  Picture picture;
  picture.width = static_cast<std::uint32_t>(spec.width);
  picture.height = static_cast<std::uint32_t>(spec.height);
  // A window that does not lie inside the frame cannot be expressed; the pixels themselves are whole.
  const bool inside = spec.full_width > 0 && spec.full_height > 0 && spec.x >= spec.full_x &&
                      spec.y >= spec.full_y &&
                      std::int64_t{spec.x} - spec.full_x + spec.width <= spec.full_width &&
                      std::int64_t{spec.y} - spec.full_y + spec.height <= spec.full_height;
  picture.x = inside ? static_cast<std::uint32_t>(spec.x - spec.full_x) : 0;
  picture.y = inside ? static_cast<std::uint32_t>(spec.y - spec.full_y) : 0;
  picture.full_width = inside ? static_cast<std::uint32_t>(spec.full_width) : picture.width;
  picture.full_height = inside ? static_cast<std::uint32_t>(spec.full_height) : picture.height;

  for (int begin = 0; begin < spec.nchannels;) {
    int end = begin + 1;
    while (end < spec.nchannels && is_id(spec, end) == is_id(spec, begin)) ++end;
    append_planes(*input, spec, path, begin, end, picture);
    begin = end;
  }
  expand_grey(picture);
  decode_colors(picture, color_encoding(spec), spec.get_int_attribute("oiio:UnassociatedAlpha") != 0);
  return picture;
}

}  // namespace oktett::oiio
