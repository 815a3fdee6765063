#pragma once
/// \file What image files hold of a picture, the same whichever library writes them. Not for other folders.

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "io/image/metadata.h"
#include "render/picture.h"

namespace oktett {

/// What formats that do not name their channels hold of a picture.
enum class PixelLayout { float_rgb, srgb8, srgb8_alpha };

/// Interleaved pixels, row by row from the top.
struct FlatImage {
  std::uint32_t width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> bytes;  ///< of PixelLayout::srgb8 and srgb8_alpha
  std::vector<float> floats;        ///< of PixelLayout::float_rgb
};

/// All pixels of `picture`, with its tone unless they are floats, with A if `layout` has room for it and
/// `picture` has it. Colours are divided by an A that is stored. Numbers that are not finite become 0. Throws
/// Error if a plane is missing.
FlatImage flatten(const Picture& picture, PixelLayout layout);

/// One fact of ImageMetadata under the name that it has in files.
struct Attribute {
  std::string name;
  std::variant<std::string, std::int32_t, float, Matrix4> value;
};

/// Those members of `metadata` that are not empty or zero.
std::vector<Attribute> attributes(const ImageMetadata& metadata);

}  // namespace oktett
