#include "render/light/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/math.h"

namespace oktett {

/// A compensated map with less than this part of its light left counts as constant.
static constexpr double kLeastLeft = 1e-6;

Vec3f environment_direction(double u, double v) {
  const double sine = portable::sin(std::numbers::pi * v), angle = (u - 0.5) * 2 * std::numbers::pi;
  return Vec3f(
      Vec3d{sine * portable::sin(angle), portable::cos(std::numbers::pi * v), -sine * portable::cos(angle)});
}

static float valid(float value) { return value > 0 && std::isfinite(value) ? value : 0; }

EnvironmentMap::EnvironmentMap(EnvironmentPicture picture, const EnvironmentOptions& options)
    : picture_(std::move(picture)),
      cos_rotation_(portable::cos(options.rotation)),
      sin_rotation_(portable::sin(options.rotation)),
      smooth_(options.smooth) {
  const std::size_t pixels = std::size_t{picture_.width} * picture_.height;
  if (pixels == 0) throw Error("an environment map needs pixels");
  if (picture_.pixels.size() != pixels) throw Error("an environment map has a wrong number of pixels");
  for (Color& c : picture_.pixels) c = {valid(c.x), valid(c.y), valid(c.z)};
  prepare_density(0);
  mean_ = total_ / (4 * std::numbers::pi);
  if (!options.compensate || total_ == 0) return;
  prepare_density(mean_);
  if (total_ < mean_ * 4 * std::numbers::pi * kLeastLeft) total_ = 0;
}

const Color& EnvironmentMap::pixel(std::int64_t x, std::int64_t y) const {
  const std::int64_t width = picture_.width, height = picture_.height;
  const std::int64_t column = x < 0 ? x + width : x >= width ? x - width : x;
  return picture_
      .pixels[static_cast<std::size_t>(std::clamp<std::int64_t>(y, 0, height - 1) * width + column)];
}

double EnvironmentMap::weight(std::int64_t x, std::int64_t y) const {
  const auto mean = [&](std::int64_t i, std::int64_t j) {
    const Color& c = pixel(i, j);
    return (double{c.x} + c.y + c.z) / 3;
  };
  if (!smooth_) return mean(x, y);
  // The mean of linear interpolation over a pixel is 6/8 of its value and 1/8 of each neighbour's.
  const auto row = [&](std::int64_t j) { return mean(x - 1, j) + 6 * mean(x, j) + mean(x + 1, j); };
  return (row(y - 1) + 6 * row(y) + row(y + 1)) / 64;
}

double EnvironmentMap::pixel_solid_angle(std::size_t row) const {
  // The difference of the cosines of its edges times the angle of its width.
  const double half = std::numbers::pi / 2 / picture_.height;
  return 4 * std::numbers::pi / picture_.width * portable::sin(half * static_cast<double>(2 * row + 1)) *
         portable::sin(half);
}

void EnvironmentMap::prepare_density(double subtract) {
  const std::size_t width = picture_.width, height = picture_.height;
  rows_.resize(height), cosines_.resize(height + 1);
  columns_.resize(width * height), density_.resize(width * height);
  total_ = 0;
  std::vector<double> weights(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    double sum = 0;
    for (std::size_t x = 0; x < width; ++x) {
      weights[y * width + x] =
          std::max(0.0, weight(static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)) - subtract);
      columns_[y * width + x] = sum += weights[y * width + x];
    }
    total_ += sum * pixel_solid_angle(y);
    rows_[y] = total_;
  }
  for (std::size_t y = 0; y <= height; ++y)
    cosines_[y] = portable::cos(std::numbers::pi * static_cast<double>(y) / picture_.height);
  for (std::size_t i = 0; i < weights.size(); ++i) density_[i] = static_cast<float>(weights[i] / total_);
}

EnvironmentTables EnvironmentMap::tables() const {
  return {.width = static_cast<std::int32_t>(picture_.width),
          .height = static_cast<std::int32_t>(picture_.height),
          .pixels = picture_.pixels.data(),
          .rows = rows_.data(),
          .columns = columns_.data(),
          .cosines = cosines_.data(),
          .density = density_.data(),
          .total = total_,
          .cos_rotation = cos_rotation_,
          .sin_rotation = sin_rotation_,
          .smooth = smooth_};
}

using Lane = Simd<double, 1, ScalarIsa>;

static Color radiance_at(const EnvironmentTables& map, const MapPlaces<Lane>& place) {
  Color c;
  float* const parts[3] = {&c.x, &c.y, &c.z};
  map_radiance(map, place, parts);
  return c;
}

EnvironmentMap::Sample EnvironmentMap::sample(const SquareSample& s) const {
  const EnvironmentTables map = tables();
  const auto chosen = map_samples(map, Lane(s.x), Lane(s.y));
  const std::size_t pixel = static_cast<std::size_t>(chosen.row[0]) * picture_.width + chosen.column[0];
  return {only_lane(chosen.direction), smooth_ ? radiance_at(map, chosen.place) : picture_.pixels[pixel],
          density_[pixel], static_cast<float>(only_lane(chosen.place.u)),
          static_cast<float>(only_lane(chosen.place.v))};
}

static MapPlaces<Lane> place_of(const EnvironmentTables& map, const Vec3f& direction) {
  return map_places(map, broadcast<Simd<float, 1, ScalarIsa>>(direction));
}

float EnvironmentMap::pdf(const Vec3f& direction) const {
  const EnvironmentTables map = tables();
  float density;
  map_density(map, place_of(map, direction), &density);
  return density;
}

Color EnvironmentMap::radiance(const Vec3f& direction) const {
  const EnvironmentTables map = tables();
  return radiance_at(map, place_of(map, direction));
}

}  // namespace oktett
