#pragma once
/// \file What image files hold of a picture, the same whichever library writes them; and the formats that are
/// written without OpenImageIO. For io/ only.

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "io/image/metadata.h"
#include "io/image/output.h"
#include "render/picture.h"

namespace oktett {

/// What formats that do not name their channels hold of a picture.
enum class PixelLayout { float_rgb, srgb8, srgb8_alpha, srgb16_alpha };

/// Interleaved pixels, row by row from the top.
struct FlatImage {
  std::uint32_t width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> bytes;     ///< of PixelLayout::srgb8 and srgb8_alpha
  std::vector<float> floats;           ///< of PixelLayout::float_rgb
  std::vector<std::uint16_t> words{};  ///< of PixelLayout::srgb16_alpha, and of depths
};

/// All pixels of `picture`, with its tone unless they are floats, with A if `layout` has room for it and
/// `picture` has it. Colours are divided by an A that is stored. Numbers that are not finite become 0. Throws
/// Error if a plane is missing.
FlatImage flatten(const Picture& picture, PixelLayout layout);

/// One fact of ImageMetadata under the name that it has in files.
struct Attribute {
  std::string name;
  std::variant<std::string, std::int32_t, float, Matrix4, Vec3d> value;
};

/// Those members of `metadata` that are not empty or zero.
std::vector<Attribute> attributes(const ImageMetadata& metadata);

/// The bytes of a PNG of 8-bit sRGB, with straight alpha if `picture` has A; attributes that are texts become
/// tEXt chunks. Throws Error if a colour is missing.
std::string encode_png(const Picture& picture, const std::vector<Attribute>& attributes);
/// Writes them. Throws Error of kind io if the file cannot be written.
void write_png(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes);
/// The same with the bytes or words of `image`. One channel is linear grey, more are sRGB.
void write_png(OutputFile& file, const FlatImage& image, const std::vector<Attribute>& attributes);

/// Writes an OpenEXR file: one part of scan lines, ZIP compression, each plane a channel of its type, all
/// attributes. Values are stored as they are; if a finite one is too large for half, all planes of half
/// become single. Throws Error if two planes share a name or a name is empty or longer than 255 bytes, or of
/// kind io if the file cannot be written.
void write_exr(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes);

}  // namespace oktett
