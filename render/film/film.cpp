#include "render/film/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/parallel.h"
#include "render/film/cryptomatte.h"
#include "render/light_groups.h"
#include "render/transport/render_code.h"

namespace oktett {

// ---- Layers of light groups in a picture: what the lights of one group alone would show.

/// The planes of add_catcher_planes.
static constexpr const char* kCatcherPlanes[] = {"shadow_catcher.R", "shadow_catcher.G", "shadow_catcher.B"};

static std::string plane_name(const std::string& group, char channel) {
  return fmt::format("light_{}.{}", group, channel);
}

void add_light_planes(const std::vector<std::string>& names, Picture& picture) {
  const std::size_t size = static_cast<std::size_t>(picture.width) * picture.height;
  for (const std::string& name : names)
    for (const char channel : {'R', 'G', 'B'})
      picture.planes.push_back(
          {plane_name(name, channel), PlaneType::half_float, filled_column(size, 0.0f), {}});
}

std::size_t first_light_plane(const Picture& picture) {
  const std::string name = plane_name(kDefaultLightGroup, 'R');
  const auto is_first = [&](const PicturePlane& plane) { return plane.name == name; };
  return static_cast<std::size_t>(std::ranges::find_if(picture.planes, is_first) - picture.planes.begin());
}

void add_to_layers(const SampleBatch& samples, std::size_t i, double* sums) {
  for (const ColorColumn& layer : samples.grouped)
    for (const Column<float>& channel : layer.part) *sums++ += static_cast<double>(channel[i]);
}

void write_layers(Picture& picture, std::size_t first, std::size_t at, std::span<const double> sums,
                  std::uint32_t samples) {
  if (samples == 0) return;
  for (std::size_t k = 0; k < sums.size(); ++k)
    picture.planes[first + k].values[at] = static_cast<float>(sums[k] / samples);
}

std::size_t FilmFormat::more_sums() const {
  return 3 * light_groups.size() + (catchers ? std::tuple_size_v<CaughtLight> : 0);
}

// ---- Pixels.

namespace {

/// Indices of planes, in the order in which make_picture adds them.
enum PlaneIndex {
  kR,
  kG,
  kB,
  kA,
  kZ,
  kNx,
  kNy,
  kNz,
  kNgx,
  kNgy,
  kNgz,
  kPx,
  kPy,
  kPz,
  kAlbedoR,
  kAlbedoG,
  kAlbedoB,
  kU,
  kV,
  kPrimId,
  kGeomId,
  kVarianceR,
  kVarianceG,
  kVarianceB,
};
constexpr const char* kNames[] = {
    "R",        "G",    "B",    "A",        "Z",        "N.X",        "N.Y",        "N.Z",
    "Ng.X",     "Ng.Y", "Ng.Z", "P.X",      "P.Y",      "P.Z",        "Albedo.R",   "Albedo.G",
    "Albedo.B", "u",    "v",    "primID.I", "geomID.I", "Variance.R", "Variance.G", "Variance.B",
};

void add3(double (&sum)[3], const Vec3f& v) {
  for (int k = 0; k < 3; ++k) sum[k] += static_cast<double>(v[k]);
}

void add_ids(PixelSum& pixel, const FirstHit& first, const Vec2f& offset) {
  const float distance = offset.x * offset.x + offset.y * offset.y;
  if (!pixel.has_ids || distance < pixel.nearest) {
    pixel.has_ids = true;
    pixel.nearest = distance;
    pixel.primitive = first.primitive, pixel.object = first.object;
  }
}

void add_first_hit(PixelSum& pixel, const FirstHit& first) {
  const bool finite = std::isfinite(first.depth) && is_finite(first.normal) &&
                      is_finite(first.geometric_normal) && is_finite(first.position) &&
                      is_finite(first.albedo) && std::isfinite(first.uv.x) && std::isfinite(first.uv.y);
  if (!finite) return;
  ++pixel.hits;
  pixel.depth += static_cast<double>(first.depth);
  add3(pixel.normal, first.normal);
  add3(pixel.geometric_normal, first.geometric_normal);
  add3(pixel.position, first.position);
  add3(pixel.albedo, first.albedo);
  pixel.uv[0] += static_cast<double>(first.uv.x), pixel.uv[1] += static_cast<double>(first.uv.y);
}

/// Variance of the mean of `n` samples with the given sums.
double variance_of_mean(double sum, double square, std::uint32_t n) {
  if (n < 2) return 0;
  const double count = n;
  return std::max(0.0, square - sum * sum / count) / (count - 1) / count;
}

/// Whether sample `i` holds no NaN and no infinity.
bool is_good(const SampleBatch& samples, std::size_t i) {
  return is_finite(samples.color[i]) && std::isfinite(samples.alpha[i]);
}

}  // namespace

bool add_to_pixel(PixelSum& pixel, const SampleBatch& samples, std::size_t i) {
  if (!is_good(samples, i)) return false;
  const Color color = samples.color[i];
  ++pixel.good;
  if (samples.first.empty()) {
    add3(pixel.color, color);
    pixel.alpha += static_cast<double>(samples.alpha[i]);
    return true;
  }
  const FirstHit& first = samples.first[i];
  if (!first.found && color == Color{} && samples.alpha[i] == 0) {
    add_ids(pixel, first, samples.offset[i]);
    return true;
  }
  add3(pixel.color, color);
  for (int k = 0; k < 3; ++k)
    pixel.square[k] += static_cast<double>(color[k]) * static_cast<double>(color[k]);
  pixel.alpha += static_cast<double>(samples.alpha[i]);
  add_ids(pixel, first, samples.offset[i]);
  if (first.found) add_first_hit(pixel, first);
  return true;
}

bool operator==(const FilmFormat& a, const FilmFormat& b) {
  const auto numbers = [](const FilmFormat& f) {
    return std::make_tuple(f.window.x0, f.window.y0, f.window.x1, f.window.y1, f.full_width, f.full_height,
                           f.data_layers, f.sample_counts, f.mattes, f.light_groups, f.catchers);
  };
  return numbers(a) == numbers(b);
}

FilmFormat format_of(const RenderContext& context) {
  const bool layers = context.data_layers;
  return {context.window,
          context.full_width,
          context.full_height,
          layers,
          layers && context.settings.error > 0,
          layers && context.mattes != nullptr,
          context.light_groups != nullptr ? context.light_groups->names : std::vector<std::string>{},
          context.catches};
}

Picture make_picture(const FilmFormat& format) {
  Picture picture;
  picture.width = format.window.width(), picture.height = format.window.height();
  picture.x = format.window.x0, picture.y = format.window.y0;
  picture.full_width = format.full_width, picture.full_height = format.full_height;
  const std::size_t size = static_cast<std::size_t>(picture.width) * picture.height;
  const int count = format.data_layers ? kVarianceB + 1 : kA + 1;
  for (int i = 0; i < count; ++i) {
    PicturePlane plane;
    plane.name = kNames[i];
    if (i == kPrimId || i == kGeomId) {
      plane.type = PlaneType::unsigned_int;
      plane.ids = filled_column(size, kNoId);
    } else {
      plane.type = i <= kA ? PlaneType::half_float : PlaneType::single_float;
      plane.values = filled_column(size, i == kZ ? std::numeric_limits<float>::infinity() : 0.0f);
    }
    picture.planes.push_back(std::move(plane));
  }
  if (format.sample_counts)
    picture.planes.push_back(
        {kSampleCountPlane, PlaneType::unsigned_int, {}, filled_column(size, std::uint32_t{0})});
  if (format.mattes) add_matte_planes(picture);
  if (format.catchers && format.data_layers) add_catcher_planes(picture);
  add_light_planes(format.light_groups, picture);
  return picture;
}

void TileColors::begin(std::size_t count) {
  for (Column<float>& plane : plane_) plane.resize_uninitialized(count);
}

void TileColors::clear(std::size_t first, std::size_t count) {
  for (Column<float>& plane : plane_) std::fill_n(plane.data() + first, count, 0.0f);
}

std::size_t TileColors::set(std::size_t first, const SampleBatch& samples, Isa isa) {
  const std::size_t count = samples.size();
  const float* const from[] = {samples.color.part[0].data(), samples.color.part[1].data(),
                               samples.color.part[2].data(), samples.alpha.data()};
  bool good = true;
  for (int k = 0; k < 4; ++k) {
    std::copy_n(from[k], count, plane_[k].data() + first);
    good = good && render_code(isa).all_finite(from[k], count);
  }
  if (good) return 0;
  std::size_t bad = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!is_good(samples, i)) clear(first + i, 1), ++bad;
  return bad;
}

void TileColors::set(std::size_t number, const PixelSum& sum) {
  if (sum.good == 0) return clear(number, 1);
  for (int k = 0; k < 3; ++k) plane_[k][number] = static_cast<float>(sum.color[k] / sum.good);
  plane_[3][number] = static_cast<float>(sum.alpha / sum.good);
}

void TileColors::copy_to(Picture& picture, const FinishedTile& tile,
                         const std::vector<std::uint32_t>& numbers) const {
  // A row of a tile lies far from the next one in the picture, so the processor does not foresee it.
  constexpr std::uint32_t kRowsAhead = 4, kLine = 64 / sizeof(float);
  for (std::uint32_t y = 0; y < tile.height; ++y) {
    if (y + kRowsAhead < tile.height) {
      const std::size_t next = static_cast<std::size_t>(tile.y + y + kRowsAhead) * picture.width + tile.x;
      for (int k = 0; k < 4; ++k)
        for (std::uint32_t x = 0; x < tile.width; x += kLine)
          __builtin_prefetch(picture.planes[kR + k].values.data() + next + x, 1);
    }
    const std::uint32_t* row = numbers.data() + static_cast<std::size_t>(y) * tile.width;
    const std::size_t at = static_cast<std::size_t>(tile.y + y) * picture.width + tile.x;
    for (int k = 0; k < 4; ++k) {
      const float* from = plane_[k].data();
      float* to = picture.planes[kR + k].values.data() + at;
      for (std::uint32_t x = 0; x < tile.width; ++x) to[x] = from[row[x]];
    }
  }
}

void write_color(Picture& picture, std::uint32_t x, std::uint32_t y, const PixelSum& pixel) {
  if (pixel.good == 0) return;
  const std::size_t at = static_cast<std::size_t>(y) * picture.width + x;
  for (int k = 0; k < 3; ++k)
    picture.planes[kR + k].values[at] = static_cast<float>(pixel.color[k] / pixel.good);
  picture.planes[kA].values[at] = static_cast<float>(pixel.alpha / pixel.good);
}

void write_pixel(Picture& picture, std::uint32_t x, std::uint32_t y, const PixelSum& pixel) {
  const std::size_t at = static_cast<std::size_t>(y) * picture.width + x;
  const auto set = [&](int plane, double sum, std::uint32_t count) {
    picture.planes[plane].values[at] = static_cast<float>(sum / count);
  };
  picture.planes[kPrimId].ids[at] = pixel.primitive;
  picture.planes[kGeomId].ids[at] = pixel.object;
  const bool empty = pixel.color[0] == 0 && pixel.color[1] == 0 && pixel.color[2] == 0 && pixel.alpha == 0;
  // make_picture left the pixel empty.
  if (pixel.good == 0 || (pixel.hits == 0 && empty)) return;
  for (int k = 0; k < 3; ++k) set(kR + k, pixel.color[k], pixel.good);
  set(kA, pixel.alpha, pixel.good);
  for (int k = 0; k < 3; ++k) {
    set(kNx + k, pixel.normal[k], pixel.good);
    set(kNgx + k, pixel.geometric_normal[k], pixel.good);
    set(kAlbedoR + k, pixel.albedo[k], pixel.good);
    set(kVarianceR + k, variance_of_mean(pixel.color[k], pixel.square[k], pixel.good), 1);
    if (pixel.hits > 0) set(kPx + k, pixel.position[k], pixel.hits);
  }
  if (pixel.hits == 0) return;
  set(kZ, pixel.depth, pixel.hits);
  set(kU, pixel.uv[0], pixel.hits), set(kV, pixel.uv[1], pixel.hits);
}

// ---- Shadow catchers.

/// Entries of CaughtLight.
constexpr std::size_t kWith = 0, kWithout = 3, kBehind = 6, kCovered = 9, kTransparent = 10;

void add_catcher_planes(Picture& picture) {
  const std::size_t size = static_cast<std::size_t>(picture.width) * picture.height;
  for (const char* name : kCatcherPlanes)
    picture.planes.push_back({name, PlaneType::half_float, filled_column(size, 1.0f), {}});
}

std::size_t first_catcher_plane(const Picture& picture) {
  const auto is_first = [&](const PicturePlane& plane) { return plane.name == kCatcherPlanes[0]; };
  return static_cast<std::size_t>(std::ranges::find_if(picture.planes, is_first) - picture.planes.begin());
}

CaughtLight caught_light(const RenderContext& context, const SampleBatch& samples, const SampleBatch& bare,
                         std::size_t i) {
  const std::size_t caught = samples.caught() + i;
  const auto covered = static_cast<double>(samples.alpha[caught]);
  CaughtLight light{};
  for (std::size_t k = 0; k < 3; ++k) {
    light[kWith + k] = static_cast<double>(samples.color[caught][k]);
    light[kWithout + k] = static_cast<double>(bare.color[caught][k]);
    light[kBehind + k] = static_cast<double>(samples.behind[caught][k]) * covered;
  }
  light[kCovered] = covered;
  light[kTransparent] = context.opaque_background ? 0 : covered;
  return light;
}

void write_caught(Picture& picture, std::size_t planes, std::size_t at, std::span<const double> sums,
                  std::uint32_t samples) {
  if (samples == 0 || !(sums[kCovered] > 0)) return;
  const double covered = sums[kCovered] / samples;
  const auto ratio = [](double with, double without) { return without > 0 ? with / without : 1; };
  const auto add = [&](std::size_t plane, double more) {
    float& value = picture.planes[plane].values[at];
    value = static_cast<float>(static_cast<double>(value) + more);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const double left = ratio(sums[kWith + k], sums[kWithout + k]);
    add(kR + k, sums[kBehind + k] / samples * left);
    if (planes < picture.planes.size())
      picture.planes[planes + k].values[at] = static_cast<float>(1 - covered * (1 - left));
  }
  const double left = ratio(sums[kWith] + sums[kWith + 1] + sums[kWith + 2],
                            sums[kWithout] + sums[kWithout + 1] + sums[kWithout + 2]);
  const double transparent = sums[kTransparent] / samples;
  add(kA, covered - transparent + transparent * (1 - std::min(1.0, left)));
}

}  // namespace oktett
