#pragma once
/// \file The sums of all pixels of a tile: as numbers, as planes of a picture and as bytes of a file.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/film/cryptomatte.h"
#include "render/film/film.h"

namespace oktett {

/// Most samples that can be added to the first ones of a pixel.
inline constexpr std::uint32_t kMostAddedSamples = 1u << 24;

/// What is known of the pixels of a tile after some of their samples, row by row.
struct TileSums {
  std::vector<PixelSum> pixels;
  std::vector<std::uint32_t> samples;         ///< of each pixel, those that were left out included
  std::vector<MatteSums> objects, materials;  ///< of each pixel; empty unless mattes are wanted
  std::vector<double> grouped;                ///< of each pixel: red, green and blue of each light group

  /// Samples that were left out.
  std::uint64_t bad_samples() const;
};

/// Writes all planes of a tile. `picture` is from make_picture(format).
void write_tile(const FilmFormat& format, const FinishedTile& tile, const TileSums& sums, Picture& picture);

/// The sums as bytes. A sum that is the same in all pixels is kept once.
std::string encode_tile(const FilmFormat& format, const TileSums& sums);

/// What encode_tile encoded for a tile of `pixels` pixels. Throws Error for other bytes.
TileSums decode_tile(const FilmFormat& format, std::size_t pixels, std::string_view bytes);

}  // namespace oktett
