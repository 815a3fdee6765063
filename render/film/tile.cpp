#include "render/film/tile.h"

#include <algorithm>
#include <span>

#include "render/film/tile_parts.h"

namespace oktett {
namespace {

/// The even bits of `code`, packed together.
std::uint32_t even_bits(std::uint32_t code) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 16; ++i) bits |= ((code >> (2 * i)) & 1u) << i;
  return bits;
}

}  // namespace

void list_pixels(std::uint32_t width, std::uint32_t height, TileWorkspace& work) {
  if (work.width == width && work.height == height) return;
  work.width = width, work.height = height;
  work.order.clear();
  std::uint32_t edge = 1;
  while (edge < width || edge < height) edge *= 2;
  for (std::uint32_t code = 0; code < edge * edge; ++code) {
    const std::uint32_t x = even_bits(code), y = even_bits(code >> 1);
    if (x < width && y < height) work.order.push_back({static_cast<std::uint32_t>(work.order.size()), x, y});
  }
  work.numbers.resize(work.order.size());
  for (const WavefrontPixel& p : work.order) work.numbers[p.y * width + p.x] = p.number;
}

void clamp_samples(double most, SampleBatch& samples) {
  const auto limit = static_cast<float>(most);
  for (std::size_t i = 0; i < samples.color.size(); ++i) {
    const Color color = samples.color[i];
    const float peak = max_component(color);
    if (!(peak > limit) || !is_finite(color)) continue;
    samples.color.set(i, color * (limit / peak));
    for (ColorColumn& layer : samples.grouped) layer.set(i, layer[i] * (limit / peak));
  }
}

std::vector<FinishedTile> cut_tiles(std::uint32_t width, std::uint32_t height, std::uint32_t tile_size) {
  std::vector<FinishedTile> tiles;
  const std::uint32_t size = std::clamp(tile_size, 1u, 256u);
  for (std::uint32_t y = 0; y < height; y += size)
    for (std::uint32_t x = 0; x < width; x += size)
      tiles.push_back({x, y, std::min(size, width - x), std::min(size, height - y)});
  return tiles;
}

TileCounts render_tile(const RenderContext& context, const FinishedTile& tile, Picture& picture,
                       TileWorkspace& work) {
  if (needs_parts(context)) return render_tile_in_parts(context, tile, picture, work);
  list_pixels(tile.width, tile.height, work);
  work.pixels.clear();
  for (const WavefrontPixel& p : work.order)
    work.pixels.push_back({p.number, context.window.x0 + tile.x + p.x, context.window.y0 + tile.y + p.y});
  const std::uint32_t samples = context.settings.samples;
  // Wavefronts of equal size: a small remainder would leave packets partly empty.
  const std::size_t most_pixels = std::max(1u, kWavefrontSamples / samples);
  const std::size_t wavefronts = (work.pixels.size() + most_pixels - 1) / most_pixels;
  const std::size_t pixels_per_wavefront = (work.pixels.size() + wavefronts - 1) / wavefronts;
  const std::uint32_t samples_per_wavefront = std::min(samples, kWavefrontSamples);
  TileCounts counts;
  Wavefront& wavefront = work.wavefront;
  wavefront.counts = {};
  if (!context.data_layers) work.colors.begin(work.pixels.size());
  const auto finish = [&](std::uint32_t number, const PixelSum& sum) {
    if (!context.data_layers) return work.colors.set(number, sum);
    write_pixel(picture, tile.x + work.order[number].x, tile.y + work.order[number].y, sum);
  };
  for (std::size_t p = 0; p < work.pixels.size(); p += pixels_per_wavefront) {
    const auto pixels =
        std::span(work.pixels).subspan(p, std::min(pixels_per_wavefront, work.pixels.size() - p));
    // The samples of a pixel are consecutive. If they fill several wavefronts, these hold no other pixel.
    std::uint32_t number = pixels.front().number;
    PixelSum sum;
    for (std::uint32_t s = 0; s < samples; s += samples_per_wavefront) {
      start_wavefront(context, pixels, s, std::min(samples, s + samples_per_wavefront), wavefront);
      if (!trace_wavefront(context, wavefront)) {
        if (!context.data_layers) work.colors.clear(pixels.front().number, pixels.size());
        continue;
      }
      if (context.settings.clamp > 0) clamp_samples(context.settings.clamp, wavefront.samples);
      if (samples == 1 && !context.data_layers) {
        counts.bad_samples += work.colors.set(number, wavefront.samples, context.isa);
        continue;
      }
      for (std::size_t i = 0; i < wavefront.samples.size(); ++i) {
        if (wavefront.samples.pixel[i] != number) {
          finish(number, sum);
          number = wavefront.samples.pixel[i], sum = {};
        }
        if (!add_to_pixel(sum, wavefront.samples, i)) ++counts.bad_samples;
      }
    }
    // Pixels are black at first; those that were skipped stay black.
    if (samples > 1 || context.data_layers) finish(number, sum);
  }
  if (!context.data_layers) work.colors.copy_to(picture, tile, work.numbers);
  counts.rays = wavefront.counts;
  return counts;
}

}  // namespace oktett
