#include "render/film/tile.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

#include "core/bytes.h"
#include "core/error.h"
#include "render/film/film.h"
#include "render/light_groups.h"
#include "render/moments.h"

namespace oktett {

// ---- Adaptive sampling.

void LuminanceSums::add(const Color& c) {
  const double y = 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) +
                   0.0722 * static_cast<double>(c.z);
  sum += y, square += y * y;
  ++count;
}

void ErrorEstimate::add_neighbour(const LuminanceSums& s) {
  if (s.count < 2) return;
  const double n = s.count;
  variance_ += std::max(0.0, s.square - s.sum * s.sum / n) / (n - 1);
  mean_ += s.sum / n;
  ++count_;
}

std::uint32_t ErrorEstimate::samples_wanted(const IntegratorSettings& settings) const {
  const std::uint32_t pilot = settings.samples;
  if (count_ == 0) return pilot;
  const double light = std::max(mean_ / count_, kDarkestLight), allowed = settings.error * light;
  const double wanted = variance_ / count_ / (allowed * allowed) / pilot;
  const std::uint32_t most = std::max(1u, settings.max_samples / pilot);
  std::uint32_t times = 1;
  // 1, 2, 3, 4, 6, 8, 12, ...: blocks that samplers spread evenly, without much more than is wanted.
  while (times < most && times < wanted)
    times = times == 1 ? 2 : (times & (times - 1)) == 0 ? times + times / 2 : times / 3 * 4;
  return pilot * std::min(times, most);
}

// ---- Tiles whose samples are traced in parts.

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
    channels_ = format_of(context).more_sums();
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
    if (context.without_others != nullptr) trace_without_others(*context.without_others, pixels, first, last);
    for (std::size_t i = 0; i < (context.catches ? samples.caught() : samples.size()); ++i) {
      const std::uint32_t pixel = samples.pixel[i];
      CaughtLight caught{};
      if (context.catches) caught = caught_light(context, samples, work_.bare.samples, i);
      if (!std::ranges::all_of(caught, [](double x) { return std::isfinite(x); }) ||
          !add_to_pixel(sums_[pixel], samples, i)) {
        bad_samples_ += is_inside(pixels_[pixel]) ? 1 : 0;
        continue;
      }
      if (in_pilot_)
        luminance_[pixel].add(context.catches ? samples.color[i] + samples.color[samples.caught() + i]
                                              : samples.color[i]);
      if (context.mattes != nullptr) add_to_mattes(pixel, samples.first[i]);
      add_to_layers(samples, i, grouped_.data() + pixel * channels_);
      if (!context.catches) continue;
      double* const sums = grouped_.data() + (pixel + 1) * channels_ - caught.size();
      for (std::size_t k = 0; k < caught.size(); ++k) sums[k] += caught[k];
    }
  }

  /// Traces the same samples where there are only shadow catchers and what glows.
  void trace_without_others(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                            std::uint32_t first, std::uint32_t last) {
    Wavefront& bare = work_.bare;
    std::swap(bare.counts, work_.wavefront.counts);
    start_wavefront(context, pixels, first, last, bare);
    bare.whole_pixels = false;
    trace_wavefront(context, bare);
    if (context.settings.clamp > 0) clamp_samples(context.settings.clamp, bare.samples);
    std::swap(bare.counts, work_.wavefront.counts);
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
         context.light_groups != nullptr || context.catches;
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

// ---- The sums of the pixels of a tile.

namespace {

/// A number of a PixelSum.
struct Field {
  std::size_t offset, size;
  bool layers;  ///< only pictures with data layers have it
};

#define OKTETT_FIELD(member, layers) \
  Field { offsetof(PixelSum, member), sizeof(PixelSum::member), layers }
/// All members; arrays are kept number by number.
constexpr Field kMembers[] = {
    OKTETT_FIELD(color, false),
    OKTETT_FIELD(alpha, false),
    OKTETT_FIELD(good, false),
    OKTETT_FIELD(square, true),
    OKTETT_FIELD(depth, true),
    OKTETT_FIELD(normal, true),
    OKTETT_FIELD(geometric_normal, true),
    OKTETT_FIELD(position, true),
    OKTETT_FIELD(albedo, true),
    OKTETT_FIELD(uv, true),
    OKTETT_FIELD(hits, true),
    OKTETT_FIELD(nearest, true),
    OKTETT_FIELD(has_ids, true),
    OKTETT_FIELD(primitive, true),
    OKTETT_FIELD(object, true),
};
#undef OKTETT_FIELD
static_assert(sizeof(PixelSum) == 200, "a new member of PixelSum stands in kMembers, too");

/// Calls `use(offset, size)` for each number of a PixelSum that pictures of this format have.
template <class Use>
void for_each_number(const FilmFormat& format, const Use& use) {
  for (const Field& field : kMembers) {
    if (field.layers && !format.data_layers) continue;
    const std::size_t size = field.size > sizeof(double) ? sizeof(double) : field.size;
    for (std::size_t at = 0; at < field.size; at += size) use(field.offset + at, size);
  }
}

constexpr char kSame = 0, kDifferent = 1;

/// One number of each of `count` structures `stride` bytes apart.
void encode_column(const char* first, std::size_t count, std::size_t stride, std::size_t size,
                   std::string& bytes) {
  bool same = true;
  for (std::size_t i = 1; i < count && same; ++i) same = std::memcmp(first, first + i * stride, size) == 0;
  bytes += same ? kSame : kDifferent;
  for (std::size_t i = 0; i < (same ? 1 : count); ++i) bytes.append(first + i * stride, size);
}

void decode_column(ByteReader& reader, char* first, std::size_t count, std::size_t stride, std::size_t size) {
  const char kind = reader.take(1)[0];
  if (kind != kSame && kind != kDifferent) throw Error("a tile has a column of an unknown kind");
  const std::string_view values = reader.take(kind == kSame ? size : size * count);
  // The only numbers of one byte are truth values.
  if (size == 1)
    for (const char c : values)
      if (c != 0 && c != 1) throw Error("a tile has numbers that none can have");
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(first + i * stride, values.data() + (kind == kSame ? 0 : i * size), size);
}

void encode_mattes(const std::vector<MatteSums>& mattes, std::string& bytes) {
  for (const MatteSums& matte : mattes) {
    append_number(bytes, static_cast<std::uint32_t>(matte.entries().size()));
    for (const MatteSums::Entry& entry : matte.entries())
      append_number(bytes, entry.id), append_number(bytes, entry.count);
  }
}

std::vector<MatteSums> decode_mattes(ByteReader& reader, std::size_t pixels) {
  std::vector<MatteSums> mattes(pixels);
  for (MatteSums& matte : mattes)
    for (std::uint32_t left = reader.count(8); left > 0; --left) {
      const auto id = reader.number<float>();
      matte.append(id, reader.number<std::uint32_t>());
    }
  return mattes;
}

/// Sums are divided by counts, and counts number the samples that are added.
void check_counts(const TileSums& sums) {
  constexpr std::uint32_t kMost = kMostSamples + kMostAddedSamples;
  for (std::size_t i = 0; i < sums.pixels.size(); ++i)
    if (sums.samples[i] > kMost || sums.pixels[i].good > sums.samples[i] ||
        sums.pixels[i].hits > sums.pixels[i].good)
      throw Error("a tile has counts that none can have");
}

char* bytes_of(void* numbers) { return static_cast<char*>(numbers); }
const char* bytes_of(const void* numbers) { return static_cast<const char*>(numbers); }

}  // namespace

std::uint64_t TileSums::bad_samples() const {
  std::uint64_t bad = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) bad += samples[i] - pixels[i].good;
  return bad;
}

void write_tile(const FilmFormat& format, const FinishedTile& tile, const TileSums& sums, Picture& picture) {
  PicturePlane* counts = format.sample_counts ? picture.find(kSampleCountPlane) : nullptr;
  const std::size_t object_planes = first_matte_plane(picture, kObjectLayer);
  const std::size_t material_planes = first_matte_plane(picture, kMaterialLayer);
  const std::size_t light_planes = first_light_plane(picture), catcher_planes = first_catcher_plane(picture);
  const std::size_t channels = 3 * format.light_groups.size(), more = format.more_sums();
  std::size_t i = 0;
  for (std::uint32_t y = tile.y; y < tile.y + tile.height; ++y)
    for (std::uint32_t x = tile.x; x < tile.x + tile.width; ++x, ++i) {
      const std::size_t at = std::size_t{y} * picture.width + x;
      if (format.data_layers)
        write_pixel(picture, x, y, sums.pixels[i]);
      else
        write_color(picture, x, y, sums.pixels[i]);
      if (counts != nullptr) counts->ids[at] = sums.samples[i];
      const std::span<const double> beside(sums.grouped.data() + i * more, more);
      write_layers(picture, light_planes, at, beside.first(channels), sums.pixels[i].good);
      if (format.catchers)
        write_caught(picture, catcher_planes, at, beside.subspan(channels), sums.pixels[i].good);
      if (!format.mattes) continue;
      sums.objects[i].write(picture, object_planes, at, sums.pixels[i].good);
      sums.materials[i].write(picture, material_planes, at, sums.pixels[i].good);
    }
}

std::string encode_tile(const FilmFormat& format, const TileSums& sums) {
  std::string bytes;
  const std::size_t count = sums.pixels.size();
  encode_column(bytes_of(sums.samples.data()), count, sizeof(std::uint32_t), sizeof(std::uint32_t), bytes);
  for_each_number(format, [&](std::size_t offset, std::size_t size) {
    encode_column(bytes_of(sums.pixels.data()) + offset, count, sizeof(PixelSum), size, bytes);
  });
  encode_mattes(sums.objects, bytes), encode_mattes(sums.materials, bytes);
  const std::size_t channels = format.more_sums();
  for (std::size_t k = 0; k < channels; ++k)
    encode_column(bytes_of(sums.grouped.data() + k), count, channels * sizeof(double), sizeof(double), bytes);
  return bytes;
}

TileSums decode_tile(const FilmFormat& format, std::size_t pixels, std::string_view bytes) {
  ByteReader reader(bytes);
  TileSums sums;
  sums.pixels.resize(pixels), sums.samples.resize(pixels);
  decode_column(reader, bytes_of(sums.samples.data()), pixels, sizeof(std::uint32_t), sizeof(std::uint32_t));
  for_each_number(format, [&](std::size_t offset, std::size_t size) {
    decode_column(reader, bytes_of(sums.pixels.data()) + offset, pixels, sizeof(PixelSum), size);
  });
  if (format.mattes)
    sums.objects = decode_mattes(reader, pixels), sums.materials = decode_mattes(reader, pixels);
  const std::size_t channels = format.more_sums();
  if (channels > reader.left() / sizeof(double)) throw Error("the file is cut short");
  sums.grouped.resize(pixels * channels);
  for (std::size_t k = 0; k < channels; ++k)
    decode_column(reader, bytes_of(sums.grouped.data() + k), pixels, channels * sizeof(double),
                  sizeof(double));
  if (reader.left() != 0) throw Error("a tile has not the length that it says");
  check_counts(sums);
  return sums;
}

// ---- Tiles.

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
