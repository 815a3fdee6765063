#pragma once
/// \file The formats that are written without OpenImageIO. Not for other folders.

#include <string>
#include <vector>

#include "io/image/encode.h"
#include "io/image/output.h"

namespace oktett {

/// The bytes of a PNG of 8-bit sRGB, with straight alpha if `picture` has A; attributes that are texts become
/// tEXt chunks. Throws Error if a colour is missing.
std::string encode_png(const Picture& picture, const std::vector<Attribute>& attributes);
/// Writes them. Throws Error of kind io if the file cannot be written.
void write_png(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes);

/// Writes an OpenEXR file: one part of scan lines, ZIP compression, each plane a channel of its type, all
/// attributes. Values are stored as they are; finite ones too large for half become the largest half.
/// Throws Error if two planes share a name or a name is empty or longer than 255 bytes, or of kind io if the
/// file cannot be written.
void write_exr(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes);

}  // namespace oktett
