#pragma once
/// \file Tiles whose samples are traced in parts: adaptive sampling, moments of the shutter, mattes.

#include "render/film/tile.h"

namespace oktett {

/// Whether the samples of a tile cannot be traced all alike.
bool needs_parts(const RenderContext& context);

/// Does what render_tile does, for contexts that need it.
TileCounts render_tile_in_parts(const RenderContext& context, const FinishedTile& tile, Picture& picture,
                                TileWorkspace& work);

}  // namespace oktett
