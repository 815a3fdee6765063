#pragma once
/// \file Tiles of a picture, and how one of them is rendered.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"
#include "render/context.h"
#include "render/film/cryptomatte.h"
#include "render/film/film.h"
#include "render/picture.h"
#include "render/render_options.h"
#include "render/scene.h"
#include "render/transport/wavefront.h"

namespace oktett {

// ---- Adaptive sampling: how many samples a pixel needs for a stated error.
//
// Each pixel first gets `samples` samples. How many it gets in all is computed from the first samples of its
// neighbours alone. If its own were asked, pixels that happen to miss what is bright and rare would end
// early, and the picture would be too dark: the mean of samples whose number depends on them is biased (Kirk
// and Arvo 1991). The samples of neighbours are independent of those of the pixel, so its mean stays
// unbiased, and none of its samples is thrown away. For this, pixels must share nothing random. They do
// share photons (caustics.h) and points of emitters (area_lights.h), so each pixel begins with a random one
// of these. For the same reason nothing is decided a second time when more samples are there.

/// Neighbours up to this many pixels away, in x and in y, decide.
inline constexpr std::uint32_t kNeighbourhood = 2;
/// The error of pixels darker than this counts as if they were as bright: what is nearly black need not be
/// known to a part of itself.
inline constexpr double kDarkestLight = 0.02;

/// Luminance of the samples of a pixel.
struct LuminanceSums {
  double sum = 0, square = 0;
  std::uint32_t count = 0;

  /// Adds a sample, which is finite.
  void add(const Color& c);
};

/// What the neighbours of a pixel say about it.
class ErrorEstimate {
 public:
  void add_neighbour(const LuminanceSums& sums);
  /// The number of samples for which the standard deviation of a pixel's mean is settings.error times its
  /// light: one of 1, 2, 3, 4, 6, 8, 12, ... times settings.samples, at most settings.max_samples rounded
  /// down to a multiple of settings.samples.
  std::uint32_t samples_wanted(const IntegratorSettings& settings) const;

 private:
  double variance_ = 0, mean_ = 0;
  std::uint32_t count_ = 0;
};

// ---- The sums of all pixels of a tile: as numbers, as planes of a picture and as bytes of a file.

/// Most samples that can be added to the first ones of a pixel.
inline constexpr std::uint32_t kMostAddedSamples = 1u << 24;

/// What is known of the pixels of a tile after some of their samples, row by row.
struct TileSums {
  std::vector<PixelSum> pixels;
  std::vector<std::uint32_t> samples;         ///< of each pixel, those that were left out included
  std::vector<MatteSums> objects, materials;  ///< of each pixel; empty unless mattes are wanted
  /// Of each pixel: red, green and blue of each light group, then CaughtLight if the format has it.
  std::vector<double> grouped;

  /// Samples that were left out.
  std::uint64_t bad_samples() const;
};

/// Writes all planes of a tile. `picture` is from make_picture(format).
///
/// Of shadow catchers that the camera sees only shadows are shown. L being the light that would leave the
/// catchers of a pixel, and L0 the same without all objects that neither are catchers nor glow, a part 1 - L
/// / L0 of the pixel is black and hides what is behind, at least 0 and by the mean of the channels, and the
/// rest is transparent. Before a background that gives light, the pixel shows that times L / L0 of each
/// channel. Both are sums over the samples of the pixel.
void write_tile(const FilmFormat& format, const FinishedTile& tile, const TileSums& sums, Picture& picture);

/// The sums as bytes. A sum that is the same in all pixels is kept once.
std::string encode_tile(const FilmFormat& format, const TileSums& sums);

/// What encode_tile encoded for a tile of `pixels` pixels. Throws Error for other bytes.
TileSums decode_tile(const FilmFormat& format, std::size_t pixels, std::string_view bytes);

// ---- Tiles.

/// Cuts a picture of the given size into tiles of at most `tile_size` pixels along an edge, row by row.
std::vector<FinishedTile> cut_tiles(std::uint32_t width, std::uint32_t height, std::uint32_t tile_size);

struct TileCounts {
  RayCounts rays;
  std::uint64_t bad_samples = 0;
};

/// Memory that a thread reuses from tile to tile.
struct TileWorkspace {
  Wavefront wavefront, bare;           ///< `bare`: the same samples in RenderContext::without_others
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

// ---- Tiles whose samples are traced in parts: adaptive sampling, moments of the shutter, mattes, layers of
// light groups, shadow catchers.

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
