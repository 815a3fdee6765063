#pragma once
/// \file Tiles of a picture, and how one of them is rendered.

#include <cstdint>
#include <vector>

#include "render/context.h"
#include "render/film/film.h"
#include "render/picture.h"
#include "render/render_options.h"
#include "render/transport/wavefront.h"

namespace oktett {

/// Cuts a picture of the given size into tiles of at most `tile_size` pixels along an edge, row by row.
std::vector<FinishedTile> cut_tiles(std::uint32_t width, std::uint32_t height, std::uint32_t tile_size);

struct TileCounts {
  RayCounts rays;
  std::uint64_t bad_samples = 0;
};

/// Memory that a thread reuses from tile to tile.
struct TileWorkspace {
  Wavefront wavefront;
  std::vector<WavefrontPixel> pixels;  ///< of the tile
  std::uint32_t width = 0, height = 0;
  std::vector<WavefrontPixel> order;   ///< pixels of a tile of that size, relative to its corner
  std::vector<std::uint32_t> numbers;  ///< of these pixels, row by row
  TileColors colors;
};

/// Greatest number of camera samples in a wavefront: enough to keep packets full after some bounces, few
/// enough to stay in the cache.
inline constexpr std::uint32_t kWavefrontSamples = 4096;

/// Sets `order` and `numbers` of the workspace to the pixels of a tile of the given size, in Morton order, so
/// that neighbours in the list make coherent packets.
void list_pixels(std::uint32_t width, std::uint32_t height, TileWorkspace& work);

/// Darkens samples with a component above `most` until none is, and their layers of light groups by the same
/// factor. Those that are not finite stay so.
void clamp_samples(double most, SampleBatch& samples);

/// Renders the pixels of `tile` into `picture` and touches no others.
TileCounts render_tile(const RenderContext& context, const FinishedTile& tile, Picture& picture,
                       TileWorkspace& work);

}  // namespace oktett
