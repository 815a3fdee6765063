#pragma once
/// \file Images that are computed for GLB files. Within io/gltf/ only.

#include <string>

#include "render/material.h"

namespace oktett {

/// A PNG of 8 bits with the colours of `color` (null: white) and the numbers of `opacity` (null: none) as
/// alpha, both as large as the larger one. Throws Error of kind io if an image cannot be read.
std::string png_of_texture(const Texture* color, const Texture* opacity);

/// A PNG of tangent-space normals of the heights of a texture, where width and height of its image are so
/// long on the surface. Throws Error of kind io if the image cannot be read.
std::string png_of_heights(const Texture& heights, double scale, double width, double height);

}  // namespace oktett
