#include "render/light/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/math.h"

namespace oktett {

static constexpr double kPi = std::numbers::pi;

/// A compensated map with less than this part of its light left counts as constant.
static constexpr double kLeastLeft = 1e-6;

Vec3f environment_direction(double u, double v) {
  const double sine = portable::sin(kPi * v), angle = (u - 0.5) * 2 * kPi;
  return Vec3f(Vec3d{sine * portable::sin(angle), portable::cos(kPi * v), -sine * portable::cos(angle)});
}

static float valid(float value) { return value > 0 && std::isfinite(value) ? value : 0; }

/// Index of the interval of `sums` in which `value` lies, and in which part of it. Intervals of length 0 are
/// never chosen; at least one must be longer.
static std::size_t find_interval(const double* sums, std::size_t count, double value, double& part) {
  const double* end = sums + count;
  const double* found = std::upper_bound(sums, end, value);
  if (found == end) found = std::lower_bound(sums, end, sums[count - 1]);
  const double before = found == sums ? 0 : found[-1];
  part = std::clamp((value - before) / (*found - before), 0.0, 1.0);
  return static_cast<std::size_t>(found - sums);
}

/// The length of interval `i`.
static double interval(const double* sums, std::size_t i) { return i == 0 ? sums[0] : sums[i] - sums[i - 1]; }

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
  mean_ = total_ / (4 * kPi);
  if (!options.compensate || total_ == 0) return;
  prepare_density(mean_);
  if (total_ < mean_ * 4 * kPi * kLeastLeft) total_ = 0;
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

double EnvironmentMap::top_cosine(std::size_t row) const {
  return portable::cos(kPi * static_cast<double>(row) / picture_.height);
}

double EnvironmentMap::pixel_solid_angle(std::size_t row) const {
  // The difference of the cosines of its edges times the angle of its width.
  const double half = kPi / 2 / picture_.height;
  return 4 * kPi / picture_.width * portable::sin(half * static_cast<double>(2 * row + 1)) *
         portable::sin(half);
}

void EnvironmentMap::prepare_density(double subtract) {
  const std::size_t width = picture_.width, height = picture_.height;
  rows_.resize(height);
  columns_.resize(width * height);
  total_ = 0;
  for (std::size_t y = 0; y < height; ++y) {
    double sum = 0;
    for (std::size_t x = 0; x < width; ++x) {
      sum += std::max(0.0, weight(static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)) - subtract);
      columns_[y * width + x] = sum;
    }
    total_ += sum * pixel_solid_angle(y);
    rows_[y] = total_;
  }
}

float EnvironmentMap::density(std::size_t row, std::size_t column) const {
  const double* columns = columns_.data() + row * picture_.width;
  const double in_row = interval(columns, column) / columns[picture_.width - 1];
  return static_cast<float>(interval(rows_.data(), row) / total_ * in_row / pixel_solid_angle(row));
}

EnvironmentMap::Sample EnvironmentMap::sample(const SquareSample& s) const {
  const std::size_t width = picture_.width;
  double in_row, in_column;
  const std::size_t row = find_interval(rows_.data(), rows_.size(), s.y * total_, in_row);
  const double* columns = columns_.data() + row * width;
  const std::size_t column = find_interval(columns, width, s.x * columns[width - 1], in_column);

  const double top = top_cosine(row), cosine = top + in_row * (top_cosine(row + 1) - top);
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  const double u = (static_cast<double>(column) + in_column) / picture_.width;
  const double v = portable::atan2(sine, cosine) / kPi;
  const double angle = (u - 0.5) * 2 * kPi;
  const double x = sine * portable::sin(angle), z = -sine * portable::cos(angle);
  const Vec3d direction{cos_rotation_ * x + sin_rotation_ * z, cosine, cos_rotation_ * z - sin_rotation_ * x};
  return {Vec3f(direction), smooth_ ? radiance_at({u, v}) : picture_.pixels[row * width + column],
          density(row, column), static_cast<float>(u), static_cast<float>(v)};
}

EnvironmentMap::Place EnvironmentMap::place(const Vec3f& direction) const {
  const Vec3d d(direction);
  const double x = cos_rotation_ * d.x - sin_rotation_ * d.z, z = sin_rotation_ * d.x + cos_rotation_ * d.z;
  // A NaN becomes 0.
  return {std::max(0.0, 0.5 + portable::atan2(x, -z) / (2 * kPi)),
          std::max(0.0, portable::atan2(std::sqrt(x * x + z * z), d.y) / kPi)};
}

/// The pixel of `count` that holds the fraction `f`.
static std::size_t pixel_of(double f, std::size_t count) {
  return std::min(static_cast<std::size_t>(std::max(0.0, f * static_cast<double>(count))), count - 1);
}

float EnvironmentMap::pdf(const Vec3f& direction) const {
  if (!samples()) return 0;
  const Place p = place(direction);
  const std::size_t row = pixel_of(p.v, picture_.height);
  if (!(interval(rows_.data(), row) > 0)) return 0;
  return density(row, pixel_of(p.u, picture_.width));
}

Color EnvironmentMap::radiance(const Vec3f& direction) const {
  const Place p = place(direction);
  if (smooth_) return radiance_at(p);
  return picture_.pixels[pixel_of(p.v, picture_.height) * picture_.width + pixel_of(p.u, picture_.width)];
}

Color EnvironmentMap::radiance_at(const Place& p) const {
  const double x = p.u * picture_.width - 0.5, y = p.v * picture_.height - 0.5;
  const double left = std::floor(x), above = std::floor(y);
  const auto column = static_cast<std::int64_t>(left), row = static_cast<std::int64_t>(above);
  const auto right_part = static_cast<float>(x - left), lower_part = static_cast<float>(y - above);
  const auto mixed = [&](std::int64_t j) {
    return pixel(column, j) * (1 - right_part) + pixel(column + 1, j) * right_part;
  };
  return mixed(row) * (1 - lower_part) + mixed(row + 1) * lower_part;
}

}  // namespace oktett
