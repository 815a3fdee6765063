#pragma once
/// \file Pictures to and from image files.

#include <cstdint>
#include <string>

#include "io/image/metadata.h"
#include "render/picture.h"

namespace oktett {

/// Throws Error if a picture cannot be written to `path`: "-", empty or of unknown extension (bad_input), a
/// directory or other thing that is no regular file, or a place that does not exist or cannot be written to
/// (io), or if the image library is missing (io). It tries by creating a file beside `path` and removing it,
/// with a picture of one pixel unless every OpenImageIO writes the format; what may stand at `path` is not
/// touched. Ask before rendering.
void check_output(const std::string& path);

/// True if the format that `path`'s extension names keeps planes other than R, G, B, A.
bool keeps_all_planes(const std::string& path);

/// Writes `picture` in the format that `path`'s extension names. A picture appears at `path` only when
/// complete: it is written under another name in the same directory, flushed and renamed. Throws Error of
/// kind io if that fails; then nothing is left behind and what stood at `path` before still does.
///
/// - EXR: every plane with its own type, zip compression, data window in the full frame, all metadata. Values
///   are stored as they are, NaN and infinities included; finite values too large for half become the largest
///   half.
/// - HDR and other formats of floating point: linear R, G, B.
/// - All others: 8-bit sRGB of R, G, B and, where the format has it, A. If A is stored, colours are divided
/// by
///   it; if not, they stay as they are (over black). NaN and infinities become 0. Only the data window is
///   written.
void write_image(const std::string& path, const Picture& picture, const ImageMetadata& metadata = {});

/// Reads any image that OpenImageIO can. Colours become linear, premultiplied by A; 8-bit ones are taken as
/// sRGB unless the file says otherwise. A grey image gives R, G and B. Other channels keep name and numbers;
/// 32-bit unsigned ones become PlaneType::unsigned_int, all else single_float. Throws Error of kind io if
/// there is no such file, or it is damaged or too large for this machine.
Picture read_image(const std::string& path);

}  // namespace oktett
