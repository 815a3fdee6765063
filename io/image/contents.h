#pragma once
/// \file What an image shows, where the file that names it leaves that open.

#include <string>

namespace oktett {

struct ImageContents {
  /// Its colours are tangent-space normals: three channels, nearly all of length 1 as directions, on average
  /// along +z.
  bool normals = false;
  /// It has an alpha channel that is not 1 everywhere.
  bool alpha = false;
};

/// Reads the image at `path`; neither, if that cannot be done.
ImageContents image_contents(const std::string& path);

}  // namespace oktett
