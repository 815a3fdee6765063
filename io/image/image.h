#pragma once
/// \file Pictures to and from image files.

#include <cstdint>
#include <string>

#include "io/image/metadata.h"
#include "render/light/environment_picture.h"
#include "render/picture.h"

namespace oktett {

/// Throws Error if a picture cannot be written to `path`; ask before a long render. Of kind bad_input if
/// `path` is "-" or empty or its extension names no known format. Of kind io if `path` is a directory or
/// anything but a regular file, if its directory does not exist or cannot be written to, or if the format is
/// neither PNG nor EXR and the shared library liboktett_images is missing. A temporary file is created beside
/// `path` and removed; a file at `path` is not touched.
void check_output(const std::string& path);

/// True if the format that the extension of `path` names stores planes other than R, G, B and A.
bool keeps_all_planes(const std::string& path);

/// Whether the extension of `path` names EXR or HDR, whose files hold the light as it is, without a tone
/// curve.
bool keeps_light(const std::string& path);

/// Writes `picture` in the format that the extension of `path` names. It is written under another name in the
/// same directory, flushed to the disk and renamed, so `path` never holds a part of a picture. Throws Error
/// of kind io if that fails; then a file that was at `path` is still there, and no other is left behind.
///
/// - EXR: every plane with its own type, all attributes, zip compression, data window in the full frame, all
///   metadata. Values are stored as they are, NaN and infinities included; if a finite value is too large for
///   half, all planes of half become single.
/// - HDR and other formats of floating point: linear R, G, B.
/// - All others: 8-bit sRGB of R, G, B as picture.tone shows them and, where the format has it, A. If A is
/// stored, colours are divided
///   by it; if not, they stay as they are (over black). NaN and infinities become 0. Only the data window is
///   written.
void write_image(const std::string& path, const Picture& picture, const ImageMetadata& metadata = {});

/// Whether files of `path`'s format are written with 16 bits per number by the following: those of PNG.
bool can_store_words(const std::string& path);

/// As write_image, but as 16-bit sRGB. `path` must name a PNG file.
void write_image16(const std::string& path, const Picture& picture, const ImageMetadata& metadata = {});

/// The least power of ten of which 65534 reach to the farthest surface of the plane Z; 1 if there is none.
double depth_unit(const Picture& picture);

/// Writes the plane Z of `picture` as a PNG file of 16-bit grey numbers: the distance along the viewing
/// direction in steps of `unit`, at least 1 and at most 65535, and 0 where there is no surface. The text
/// `depthUnit` of the file states `unit`. Throws Error as write_image, and if there is no such plane.
void write_depth(const std::string& path, const Picture& picture, double unit,
                 const ImageMetadata& metadata = {});

/// Reads an image of any format that OpenImageIO reads. Colours become linear Rec.709, premultiplied by A:
/// integers are taken as sRGB unless the file says otherwise, and the chromaticities of EXR count. A grey
/// image gives R, G and B. Other channels keep their names and numbers; 32-bit unsigned ones become
/// PlaneType::unsigned_int, all others single_float. Throws Error of kind io if there is no such file, if it
/// is damaged, or if it does not fit into memory.
Picture read_image(const std::string& path);

/// Reads the colours of an image of all directions. It is the display window of an EXR file, black outside of
/// the data window. A cube map of EXR becomes one of latitude and longitude whose faces lie along the axes of
/// the world. Throws Error as read_image, and if the image has no colours.
EnvironmentPicture read_environment_image(const std::string& path);

}  // namespace oktett
