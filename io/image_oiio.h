#pragma once
/// \file What the image files of io/ share in dealing with OpenImageIO. Not for other folders.

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <string>

#include "io/image_color.h"

namespace oktett {

/// The first line of an error text, without a full stop at its end; `fallback` if there is none.
std::string first_line(const std::string& text, const std::string& fallback);

/// Takes the pending global error of OpenImageIO; it would be printed at exit otherwise.
std::string take_image_error(const std::string& fallback);

/// How the colour channels of a file with this header are encoded: as the file says, else sRGB for 8-bit
/// integers and linear for everything else.
ColorEncoding color_encoding(const OIIO::ImageSpec& spec);

/// Opens an image for reading with colours as they are stored, not multiplied by an unassociated alpha. The
/// file is not trusted: throws Error of kind io if it cannot be opened, is not a plain two-dimensional image,
/// or would take more than half of this machine's memory once read.
OIIO::ImageInput::unique_ptr open_image(const std::string& path);

}  // namespace oktett
