#pragma once
/// \file Which image files may be read. Within io/ only.

#include <string>

namespace oktett {

/// Why `path` may not be read as an image; empty if it may be tried. While files are confined
/// (io/text/file_access.h), only files that begin like one of the usual formats are tried: others may name
/// further files, like the play lists of films.
std::string why_not_an_image(const std::string& path);

}  // namespace oktett
