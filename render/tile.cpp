#include "render/tile.h"

#include <algorithm>

#include "render/film.h"

namespace oktett {
namespace {

/// Camera samples per wave: enough to keep packets full after some bounces, few enough to stay in the cache.
constexpr std::uint32_t kWaveSamples = 2048;

struct Pixel {
  std::uint32_t x, y;  ///< in the picture
};

/// The even bits of `code`, closed up.
std::uint32_t even_bits(std::uint32_t code) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 16; ++i) bits |= ((code >> (2 * i)) & 1u) << i;
  return bits;
}

/// The pixels of a tile in Morton order, so that neighbours in the list make coherent packets.
std::vector<Pixel> tile_pixels(const FinishedTile& tile) {
  std::vector<Pixel> pixels;
  pixels.reserve(static_cast<std::size_t>(tile.width) * tile.height);
  std::uint32_t edge = 1;
  while (edge < tile.width || edge < tile.height) edge *= 2;
  for (std::uint32_t code = 0; code < edge * edge; ++code) {
    const std::uint32_t x = even_bits(code), y = even_bits(code >> 1);
    if (x < tile.width && y < tile.height) pixels.push_back({tile.x + x, tile.y + y});
  }
  return pixels;
}

/// Traces samples [first_sample, last_sample) of pixels [first, last) of the list.
void run_wave(const RenderContext& context, const std::vector<Pixel>& pixels, std::size_t first,
              std::size_t last, std::uint32_t first_sample, std::uint32_t last_sample, Wave& wave) {
  wave.clear();
  for (std::size_t p = first; p < last; ++p)
    for (std::uint32_t s = first_sample; s < last_sample; ++s)
      add_sample(context, wave, static_cast<std::uint32_t>(p), context.window.x0 + pixels[p].x,
                 context.window.y0 + pixels[p].y, s);
  trace_wave(context, wave);
}

}  // namespace

std::vector<FinishedTile> cut_tiles(std::uint32_t width, std::uint32_t height, std::uint32_t tile_size) {
  std::vector<FinishedTile> tiles;
  const std::uint32_t size = std::clamp(tile_size, 1u, 256u);
  for (std::uint32_t y = 0; y < height; y += size)
    for (std::uint32_t x = 0; x < width; x += size)
      tiles.push_back({x, y, std::min(size, width - x), std::min(size, height - y)});
  return tiles;
}

TileCounts render_tile(const RenderContext& context, const FinishedTile& tile, Picture& picture) {
  const std::vector<Pixel> pixels = tile_pixels(tile);
  const std::uint32_t samples = context.settings.samples;
  const std::size_t pixels_per_wave = std::max(1u, kWaveSamples / samples);
  const std::uint32_t samples_per_wave = std::min(samples, kWaveSamples);
  TileCounts counts;
  Wave wave;
  std::vector<PixelSum> sums(pixels.size());
  for (std::size_t p = 0; p < pixels.size(); p += pixels_per_wave) {
    const std::size_t last = std::min(pixels.size(), p + pixels_per_wave);
    for (std::uint32_t s = 0; s < samples; s += samples_per_wave) {
      run_wave(context, pixels, p, last, s, std::min(samples, s + samples_per_wave), wave);
      for (std::size_t i = 0; i < wave.samples.size(); ++i)
        if (!add_to_pixel(sums[wave.samples.pixel[i]], wave.samples, i)) ++counts.bad_samples;
    }
  }
  for (std::size_t p = 0; p < pixels.size(); ++p) write_pixel(picture, pixels[p].x, pixels[p].y, sums[p]);
  counts.rays = wave.counts;
  return counts;
}

}  // namespace oktett
