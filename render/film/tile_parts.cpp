#include "render/film/tile_parts.h"

#include <algorithm>
#include <span>

#include "render/film/adaptive.h"
#include "render/film/cryptomatte.h"
#include "render/moments.h"

namespace oktett {
namespace {

/// A tile while it is rendered.
class TileParts {
 public:
  TileParts(const RenderContext& context, const FinishedTile& tile, TileWorkspace& work)
      : context_(context), tile_(tile), work_(work), adaptive_(context.settings.error > 0) {
    list_all_pixels();
    sums_.resize(pixels_.size());
    if (adaptive_) luminance_.resize(pixels_.size());
    if (context.mattes != nullptr) objects_.resize(pixels_.size()), materials_.resize(pixels_.size());
    counts_.resize(pixels_.size(), context.settings.samples);
    work_.wavefront.counts = {};
  }

  void trace_all() {
    const std::uint32_t pilot = context_.settings.samples;
    in_pilot_ = adaptive_;
    trace(pixels_, 0, pilot);
    in_pilot_ = false;
    if (!adaptive_) return;
    std::vector<std::uint32_t> wanted;
    for (const WavefrontPixel& p : pixels_)
      if (is_inside(p)) wanted.push_back(counts_[p.number] = samples_wanted(p));
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    for (const std::uint32_t count : wanted) {
      if (count == pilot) continue;
      std::vector<WavefrontPixel> group;
      for (const WavefrontPixel& p : pixels_)
        if (is_inside(p) && counts_[p.number] == count) group.push_back(p);
      trace(group, pilot, count);
    }
  }

  void write(Picture& picture) const {
    std::vector<std::uint32_t> numbers(std::size_t{tile_.width} * tile_.height);
    if (!context_.data_layers) work_.colors.begin(pixels_.size());
    for (const WavefrontPixel& p : pixels_) {
      if (!is_inside(p)) continue;
      const std::uint32_t x = p.x - left_, y = p.y - top_;
      numbers[std::size_t{y} * tile_.width + x] = p.number;
      if (context_.data_layers)
        write_pixel(picture, tile_.x + x, tile_.y + y, sums_[p.number]);
      else
        work_.colors.set(p.number, sums_[p.number]);
    }
    if (!context_.data_layers) work_.colors.copy_to(picture, tile_, numbers);
    if (context_.mattes != nullptr) write_mattes(picture);
    if (PicturePlane* counts = picture.find(kSampleCountPlane); counts != nullptr)
      for (std::uint32_t y = 0; y < tile_.height; ++y)
        for (std::uint32_t x = 0; x < tile_.width; ++x)
          counts->ids[std::size_t{tile_.y + y} * picture.width + tile_.x + x] =
              counts_[numbers[std::size_t{y} * tile_.width + x]];
  }

  TileCounts counts() const { return {work_.wavefront.counts, bad_samples_}; }

 private:
  void write_mattes(Picture& picture) const {
    for (const WavefrontPixel& p : pixels_) {
      if (!is_inside(p)) continue;
      const std::size_t at = std::size_t{tile_.y + p.y - top_} * picture.width + (tile_.x + p.x - left_);
      const std::uint32_t samples = sums_[p.number].good;
      objects_[p.number].write(picture, context_.mattes->object_planes, at, samples);
      materials_[p.number].write(picture, context_.mattes->material_planes, at, samples);
    }
  }

  void add_to_mattes(std::uint32_t pixel, const FirstHit& first) {
    const Mattes& mattes = *context_.mattes;
    if (!first.found) return;
    if (first.object < mattes.objects.size()) objects_[pixel].add(mattes.objects[first.object]);
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
    if (context.settings.clamp > 0) clamp_samples(context.settings.clamp, wavefront.samples.color);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::uint32_t pixel = samples.pixel[i];
      if (!add_to_pixel(sums_[pixel], samples, i)) {
        bad_samples_ += is_inside(pixels_[pixel]) ? 1 : 0;
        continue;
      }
      if (in_pilot_) luminance_[pixel].add(samples.color[i]);
      if (context.mattes != nullptr) add_to_mattes(pixel, samples.first[i]);
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
  std::vector<LuminanceSums> luminance_;             ///< of its first samples
  std::vector<std::uint32_t> counts_;                ///< of its samples
  std::uint64_t bad_samples_ = 0;
};

}  // namespace

bool needs_parts(const RenderContext& context) {
  return context.settings.error > 0 || context.moments != nullptr || context.mattes != nullptr;
}

TileCounts render_tile_in_parts(const RenderContext& context, const FinishedTile& tile, Picture& picture,
                                TileWorkspace& work) {
  TileParts parts(context, tile, work);
  parts.trace_all();
  parts.write(picture);
  return parts.counts();
}

}  // namespace oktett
