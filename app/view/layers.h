#pragma once
/// \file The layers of a picture that a page can show, as eight-bit pixels.

#include <cstdint>
#include <string>
#include <vector>

#include "core/box.h"
#include "render/picture.h"
#include "render/picture/render.h"
#include "render/scene.h"

namespace oktett {

/// What is shown of a picture.
struct Layer {
  std::string name = "beauty";
  Tone tone;
  double near = 0, far = 1;  ///< depths that show as white and black
  Box bounds;                ///< places in it show as colours
};

/// The names of all layers of pictures of `scene`.
std::vector<std::string> layer_names(const Scene& scene);
/// Whether a layer needs the planes of RenderOptions::data_layers.
inline bool needs_data(const std::string& layer) { return layer != "beauty"; }

/// RGBA bytes of a tile, row by row. For beauty the pixels of a PNG file of the same picture.
std::string layer_pixels(const Picture& picture, const FinishedTile& tile, const Layer& layer);

}  // namespace oktett
