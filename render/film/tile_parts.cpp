#include "render/film/tile_parts.h"

#include <algorithm>
#include <span>

#include "render/film/adaptive.h"
#include "render/film/light_layers.h"
#include "render/light_groups.h"
#include "render/moments.h"

namespace oktett {
namespace {

/// A tile while it is rendered.
class TileParts {
 public:
  /// `adaptive`: all first samples are traced, from which the number of others follows.
  TileParts(const RenderContext& context, const FinishedTile& tile, bool adaptive, TileWorkspace& work)
      : context_(context), tile_(tile), work_(work), adaptive_(adaptive) {
    list_all_pixels();
    sums_.resize(pixels_.size(), empty_sum());
    if (adaptive_) luminance_.resize(pixels_.size());
    if (context.mattes != nullptr) objects_.resize(pixels_.size()), materials_.resize(pixels_.size());
    if (context.light_groups != nullptr) channels_ = 3 * context.light_groups->names.size();
    grouped_.resize(pixels_.size() * channels_);
    counts_.resize(pixels_.size(), context.settings.samples);
  }

  /// Sets what is known of the tile.
  void set(const TileSums& sums) {
    for (const WavefrontPixel& p : pixels_) {
      if (!is_inside(p)) continue;
      const std::size_t at = place(p);
      sums_[p.number] = sums.pixels[at], counts_[p.number] = sums.samples[at];
      std::copy_n(sums.grouped.begin() + at * channels_, channels_, grouped_.begin() + p.number * channels_);
      if (context_.mattes == nullptr) continue;
      objects_[p.number] = sums.objects[at], materials_[p.number] = sums.materials[at];
    }
  }

  void trace_all() {
    const std::uint32_t pilot = context_.settings.samples;
    in_pilot_ = adaptive_;
    trace(pixels_, 0, pilot);
    in_pilot_ = false;
    if (!adaptive_) return;
    for (const WavefrontPixel& p : pixels_)
      if (is_inside(p)) counts_[p.number] = samples_wanted(p);
    for_each_count([&](std::uint32_t count, std::span<const WavefrontPixel> group) {
      if (count > pilot) trace(group, pilot, count);
    });
  }

  /// Traces `count` more samples of each pixel.
  void trace_more(std::uint32_t count) {
    for_each_count([&](std::uint32_t taken, std::span<const WavefrontPixel> group) {
      trace(group, taken, taken + count);
    });
    for (std::uint32_t& taken : counts_) taken += count;
  }

  TileSums sums() const {
    TileSums sums;
    const std::size_t size = std::size_t{tile_.width} * tile_.height;
    sums.pixels.resize(size), sums.samples.resize(size), sums.grouped.resize(size * channels_);
    if (context_.mattes != nullptr) sums.objects.resize(size), sums.materials.resize(size);
    for (const WavefrontPixel& p : pixels_) {
      if (!is_inside(p)) continue;
      const std::size_t at = place(p);
      sums.pixels[at] = sums_[p.number], sums.samples[at] = counts_[p.number];
      std::copy_n(grouped_.begin() + p.number * channels_, channels_, sums.grouped.begin() + at * channels_);
      if (context_.mattes == nullptr) continue;
      sums.objects[at] = objects_[p.number], sums.materials[at] = materials_[p.number];
    }
    return sums;
  }

  TileCounts counts() const { return {work_.wavefront.counts, bad_samples_}; }

 private:
  /// Calls `use(count, pixels)` for all pixels of the tile of which as many samples are wanted, or known.
  template <class Use>
  void for_each_count(const Use& use) {
    std::vector<std::uint32_t> counts;
    for (const WavefrontPixel& p : pixels_)
      if (is_inside(p)) counts.push_back(counts_[p.number]);
    std::sort(counts.begin(), counts.end());
    counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
    for (const std::uint32_t count : counts) {
      std::vector<WavefrontPixel> group;
      for (const WavefrontPixel& p : pixels_)
        if (is_inside(p) && counts_[p.number] == count) group.push_back(p);
      use(count, group);
    }
  }

  /// A pixel with one sample has its bits: even -0 stays -0 when it is added.
  PixelSum empty_sum() const {
    PixelSum sum;
    if (context_.settings.samples == 1 && !context_.data_layers)
      sum.color[0] = sum.color[1] = sum.color[2] = sum.alpha = -0.0;
    return sum;
  }

  /// The number of a pixel of the tile, row by row.
  std::size_t place(const WavefrontPixel& p) const {
    return std::size_t{p.y - top_} * tile_.width + (p.x - left_);
  }

  void add_to_mattes(std::uint32_t pixel, const FirstHit& first) {
    const Mattes& mattes = *context_.mattes;
    if (!first.found) return;
    if (first.whole < mattes.objects.size()) objects_[pixel].add(mattes.objects[first.whole]);
    materials_[pixel].add(mattes.materials[first.material]);
  }

  /// The pixels of the tile and, in adaptive sampling, their neighbours outside it, as far as the frame goes,
  /// in Morton order.
  void list_all_pixels() {
    left_ = context_.window.x0 + tile_.x, top_ = context_.window.y0 + tile_.y;
    const std::uint32_t rim = adaptive_ ? kNeighbourhood : 0;
    x0_ = left_ - std::min(left_, rim), y0_ = top_ - std::min(top_, rim);
    x1_ = std::min(left_ + tile_.width + rim, context_.full_width);
    y1_ = std::min(top_ + tile_.height + rim, context_.full_height);
    list_pixels(x1_ - x0_, y1_ - y0_, work_);
    for (const WavefrontPixel& p : work_.order) pixels_.push_back({p.number, x0_ + p.x, y0_ + p.y});
  }

  bool is_inside(const WavefrontPixel& p) const {
    return p.x >= left_ && p.x < left_ + tile_.width && p.y >= top_ && p.y < top_ + tile_.height;
  }

  /// The number of a pixel in list_all_pixels.
  std::uint32_t number(std::uint32_t x, std::uint32_t y) const {
    return work_.numbers[std::size_t{y - y0_} * (x1_ - x0_) + (x - x0_)];
  }

  std::uint32_t samples_wanted(const WavefrontPixel& p) const {
    ErrorEstimate estimate;
    const std::uint32_t x_begin = std::max(p.x, x0_ + kNeighbourhood) - kNeighbourhood;
    const std::uint32_t y_begin = std::max(p.y, y0_ + kNeighbourhood) - kNeighbourhood;
    for (std::uint32_t y = y_begin; y < std::min(p.y + kNeighbourhood + 1, y1_); ++y)
      for (std::uint32_t x = x_begin; x < std::min(p.x + kNeighbourhood + 1, x1_); ++x)
        if (x != p.x || y != p.y) estimate.add_neighbour(luminance_[number(x, y)]);
    return estimate.samples_wanted(context_.settings);
  }

  /// Adds samples [first, last) of the pixels to their sums, in the order of their numbers. `first` is a
  /// multiple of the number of first samples.
  void trace(std::span<const WavefrontPixel> pixels, std::uint32_t first, std::uint32_t last) {
    if (context_.moments == nullptr) return trace_moment(context_, pixels, first, last);
    const std::uint32_t cycle = context_.settings.samples;
    const auto moments = static_cast<std::uint32_t>(context_.moments->size());
    for (std::uint32_t begin = first; begin < last; begin += cycle)
      for (std::uint32_t m = 0; m < moments; ++m)
        trace_moment((*context_.moments)[m], pixels, begin + first_sample_of_moment(m, moments, cycle),
                     begin + first_sample_of_moment(m + 1, moments, cycle));
  }

  void trace_moment(const RenderContext& context, std::span<const WavefrontPixel> pixels, std::uint32_t first,
                    std::uint32_t last) {
    for (std::uint32_t s = first; s < last; s += kWavefrontSamples) {
      const std::uint32_t end = std::min(last, s + kWavefrontSamples);
      const std::size_t most = std::max(1u, kWavefrontSamples / (end - s));
      for (std::size_t p = 0; p < pixels.size(); p += most)
        add_samples(context, pixels.subspan(p, std::min(most, pixels.size() - p)), s, end);
    }
  }

  void add_samples(const RenderContext& context, std::span<const WavefrontPixel> pixels, std::uint32_t first,
                   std::uint32_t last) {
    Wavefront& wavefront = work_.wavefront;
    start_wavefront(context, pixels, first, last, wavefront);
    // Samples that meet nothing count, too.
    wavefront.whole_pixels = false;
    trace_wavefront(context, wavefront);
    const SampleBatch& samples = wavefront.samples;
    if (context.settings.clamp > 0) clamp_samples(context.settings.clamp, wavefront.samples);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::uint32_t pixel = samples.pixel[i];
      if (!add_to_pixel(sums_[pixel], samples, i)) {
        bad_samples_ += is_inside(pixels_[pixel]) ? 1 : 0;
        continue;
      }
      if (in_pilot_) luminance_[pixel].add(samples.color[i]);
      if (context.mattes != nullptr) add_to_mattes(pixel, samples.first[i]);
      add_to_layers(samples, i, grouped_.data() + pixel * channels_);
    }
  }

  const RenderContext& context_;
  const FinishedTile& tile_;
  TileWorkspace& work_;
  bool adaptive_;
  bool in_pilot_ = false;             ///< the first samples are traced, from which the number of all follows
  std::uint32_t left_ = 0, top_ = 0;  ///< the tile's first pixel in the full frame
  std::uint32_t x0_ = 0, y0_ = 0, x1_ = 0, y1_ = 0;  ///< the pixels in the list, in the full frame
  std::vector<WavefrontPixel> pixels_;               ///< numbered in their order
  std::vector<PixelSum> sums_;                       ///< of each pixel
  std::vector<MatteSums> objects_, materials_;       ///< of each pixel, if mattes are wanted
  std::size_t channels_ = 0;                         ///< three for each light group
  std::vector<double> grouped_;                      ///< of each pixel and channel
  std::vector<LuminanceSums> luminance_;             ///< of its first samples
  std::vector<std::uint32_t> counts_;                ///< of its samples
  std::uint64_t bad_samples_ = 0;
};

}  // namespace

bool needs_parts(const RenderContext& context) {
  return context.settings.error > 0 || context.moments != nullptr || context.mattes != nullptr ||
         context.light_groups != nullptr;
}

TileCounts render_tile_in_parts(const RenderContext& context, const FinishedTile& tile, Picture& picture,
                                TileWorkspace& work) {
  work.wavefront.counts = {};
  TileParts parts(context, tile, context.settings.error > 0, work);
  parts.trace_all();
  write_tile(format_of(context), tile, parts.sums(), picture);
  return parts.counts();
}

TileSums sum_tile(const RenderContext& context, const FinishedTile& tile, TileWorkspace& work) {
  TileParts parts(context, tile, context.settings.error > 0, work);
  parts.trace_all();
  return parts.sums();
}

void add_to_tile(const RenderContext& context, const FinishedTile& tile, std::uint32_t samples,
                 TileWorkspace& work, TileSums& sums) {
  TileParts parts(context, tile, false, work);
  parts.set(sums);
  parts.trace_more(samples);
  sums = parts.sums();
}

}  // namespace oktett
