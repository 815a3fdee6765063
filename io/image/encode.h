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

/// 4 if pixels are stored with A: if there is room for it and `picture` has it. Else 3.
std::uint32_t stored_channels(const Picture& picture, PixelLayout layout);

/// Pixels [first, first + count) of `picture`, counted from the upper left row by row, as 8-bit sRGB of
/// `channels` channels each. Colours are divided by A if that is stored. Throws Error if a plane is missing.
void encode_srgb8(const Picture& picture, std::uint32_t channels, std::size_t first, std::size_t count,
                  std::uint8_t* out);

/// All pixels of `picture`. Numbers that are not finite become 0. Throws Error if a plane is missing.
FlatImage flatten(const Picture& picture, PixelLayout layout);

/// One fact of ImageMetadata under the name that it has in files.
struct Attribute {
  std::string name;
  std::variant<std::string, std::int32_t, float, Matrix4> value;
};

/// Those members of `metadata` that are not empty or zero.
std::vector<Attribute> attributes(const ImageMetadata& metadata);

}  // namespace oktett
