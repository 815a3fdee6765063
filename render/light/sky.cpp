#include "render/light/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/math.h"

namespace oktett {

/// The angular diameter of the sun.
static constexpr double kSunAngle = 0.53 * std::numbers::pi / 180;

/// The sun's illuminance outside of the atmosphere in klx, and its colour there: a black body of 5778 K.
static constexpr double kSunIlluminance = 128;
static constexpr double kSunColor[] = {1.1117, 0.9755, 0.9142};

/// Per channel: wavelength in micrometres and the absorption by ozone per centimetre there.
static constexpr double kWavelength[] = {0.61, 0.55, 0.465};
static constexpr double kOzone[] = {0.12, 0.085, 0.008};

double Sky::Distribution::shape(double cos_zenith, double angle, double cos_angle) const {
  return (1 + a * portable::exp(b / std::max(cos_zenith, 1e-3))) *
         (1 + c * portable::exp(d * angle) + e * cos_angle * cos_angle);
}

double Sky::Distribution::at(double cos_zenith, double angle, double cos_angle) const {
  return factor * shape(cos_zenith, angle, cos_angle);
}

/// The angle between unit vectors.
static double angle_between(const Vec3d& a, const Vec3d& b) {
  return portable::atan2(length(cross(a, b)), dot(a, b));
}

static Color rec709(double luminance, double x, double y) {
  const Vec3d xyz{luminance * x / y, luminance, luminance * (1 - x - y) / y};
  return Color(max(rec709_of(xyz), Vec3d{}));
}

Sky::Sky(const SkyParameters& parameters)
    : parameters_(parameters),
      sun_(normalize(Vec3d{parameters.sun.x, std::max(0.0f, parameters.sun.y), parameters.sun.z})),
      turbidity_(std::clamp(parameters.turbidity, 2.0, 10.0)) {
  if (!is_finite(sun_)) sun_ = {0, 1, 0};
  const double t = turbidity_, s = angle_between({0, 1, 0}, sun_), s2 = s * s, s3 = s2 * s;
  const double chi = (4 / 9.0 - t / 120) * (std::numbers::pi - 2 * s);
  const double zenith = (4.0453 * t - 4.9710) * portable::tan(chi) - 0.2155 * t + 2.4192;
  const double zenith_x = (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) * t * t +
                          (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) * t +
                          (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886);
  const double zenith_y = (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) * t * t +
                          (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) * t +
                          (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688);
  luminance_ = {std::max(zenith, 0.0),
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
                0};
  x_ = {zenith_x,
        -0.0193 * t - 0.2592,
        -0.0665 * t + 0.0008,
        -0.0004 * t + 0.2125,
        -0.0641 * t - 0.8989,
        -0.0033 * t + 0.0452,
        0};
  y_ = {zenith_y,
        -0.0167 * t - 0.2608,
        -0.0950 * t + 0.0092,
        -0.0079 * t + 0.2102,
        -0.0441 * t - 1.6537,
        -0.0109 * t + 0.0529,
        0};
  for (Distribution* q : {&luminance_, &x_, &y_}) q->factor = q->zenith / q->shape(1, s, sun_.y);

  // The ground reflects what falls on it from sun and sky.
  Vec3d falling = Vec3d(sun_irradiance()) * sun_.y;
  constexpr int kRows = 32;
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < 2 * kRows; ++j) {
      // Directions of equal weight times cosine.
      const double sine = std::sqrt((i + 0.5) / kRows), turn = std::numbers::pi * (j + 0.5) / kRows;
      const Vec3d d{sine * portable::cos(turn), std::sqrt(1 - sine * sine), sine * portable::sin(turn)};
      falling += Vec3d(sky_radiance(d)) * (std::numbers::pi / (2 * kRows * kRows));
    }
  ground_ = parameters.ground * Color(falling / std::numbers::pi);
}

Color Sky::sky_radiance(const Vec3d& direction) const {
  const double cos_angle = dot(direction, sun_), angle = angle_between(direction, sun_);
  const double luminance = std::max(0.0, luminance_.at(direction.y, angle, cos_angle));
  return rec709(luminance, x_.at(direction.y, angle, cos_angle), y_.at(direction.y, angle, cos_angle));
}

Color Sky::radiance(const Vec3f& direction) const {
  return direction.y > 0 ? sky_radiance(Vec3d(direction)) : ground_;
}

Color Sky::sun_irradiance() const {
  if (!(parameters_.sun.y > 0)) return {};
  // The way through the atmosphere, relative to that from the zenith; then Rayleigh's scattering, aerosols
  // and ozone.
  const double degrees = angle_between({0, 1, 0}, sun_) * 180 / std::numbers::pi;
  const double mass = 1 / (sun_.y + 0.15 * portable::pow(93.885 - degrees, -1.253));
  const double beta = 0.04608 * turbidity_ - 0.04586;
  Color irradiance;
  for (int i = 0; i < 3; ++i) {
    const double depth = 0.008735 * portable::pow(kWavelength[i], -4.08) +
                         beta * portable::pow(kWavelength[i], -1.3) + 0.35 * kOzone[i];
    irradiance[i] = static_cast<float>(kSunIlluminance * kSunColor[i] * portable::exp(-depth * mass));
  }
  return irradiance;
}

DirectionalEmitter Sky::sun() const { return {Vec3f(sun_), sun_irradiance(), static_cast<float>(kSunAngle)}; }

EnvironmentPicture Sky::picture(std::uint32_t width, std::uint32_t height) const {
  EnvironmentPicture picture{width, height, {}};
  picture.pixels.reserve(std::size_t{width} * height);
  for (std::uint32_t row = 0; row < height; ++row)
    for (std::uint32_t column = 0; column < width; ++column)
      picture.pixels.push_back(radiance(environment_direction((column + 0.5) / width, (row + 0.5) / height)));
  return picture;
}

}  // namespace oktett
