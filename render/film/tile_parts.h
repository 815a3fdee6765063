#pragma once
/// \file Tiles whose samples are traced in parts: adaptive sampling, moments of the shutter, mattes,
/// layers of light groups.

#include "render/film/tile.h"
#include "render/film/tile_sums.h"

namespace oktett {

/// Whether the samples of a tile cannot be traced all alike.
bool needs_parts(const RenderContext& context);

/// Does what render_tile does, for contexts that need it.
TileCounts render_tile_in_parts(const RenderContext& context, const FinishedTile& tile, Picture& picture,
                                TileWorkspace& work);

/// The sums of a tile, of any context. From them write_tile makes the bits that render_tile writes. Counts of
/// rays are added to those of the wavefront.
TileSums sum_tile(const RenderContext& context, const FinishedTile& tile, TileWorkspace& work);

/// Adds `samples` more samples of each pixel. In motion their number must be a multiple of the first samples.
void add_to_tile(const RenderContext& context, const FinishedTile& tile, std::uint32_t samples,
                 TileWorkspace& work, TileSums& sums);

}  // namespace oktett
