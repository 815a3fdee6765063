#include "render/fog.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/math.h"

namespace oktett {
namespace {

/// The density at height h over the offset, in altitudes.
double fog_density(double h) { return h > 0 ? 1 / (1 + h * h) : 1; }

/// Its integral from 0 to h.
double fog_below(double h) { return h > 0 ? portable::atan(h) : h; }

/// The length of the way, weighted by the density.
double fog_depth(const Fog& fog, const Vec3d& origin, const Vec3d& direction, double distance) {
  if (fog.altitude == 0) return distance;
  const Vec3d up = normalize(fog.up);
  const double start = (dot(origin, up) - fog.offset) / fog.altitude,
               slope = dot(direction, up) / fog.altitude;
  // Nearly level ways have the density in their middle.
  constexpr double kLevel = 1e-5;
  const double rise = slope * distance;
  if (slope == 0 || std::abs(rise) < kLevel)
    return distance * fog_density(slope == 0 ? start : start + rise / 2);
  if (std::isinf(distance) && slope > 0) return (std::numbers::pi / 2 - fog_below(start)) / slope;
  return (fog_below(start + rise) - fog_below(start)) / slope;
}

/// What is left of fog where clouds make it thinner.
double thinned(const Fog& fog, const Vec3d& origin, const Vec3d& direction, double distance) {
  if (fog.turbulence == Vec3d{0, 0, 0} || fog.turbulence_depth == 0) return 1;
  // Ways that end nowhere have no middle.
  if (std::isinf(distance)) return 1;
  const Vec3d middle = origin + direction * (distance / 2);
  return 1 - fog.turbulence_depth * std::min(1.0, value_turbulence(fog.clouds, middle * fog.turbulence)) *
                 portable::exp(-distance / fog.distance);
}

}  // namespace

Veil pass_fogs(std::span<const Fog> fogs, const Vec3d& origin, const Vec3d& direction, double distance) {
  Veil all;
  for (const Fog& fog : fogs) {
    const double depth = fog_depth(fog, origin, direction, distance) / fog.distance *
                         thinned(fog, origin, direction, distance);
    const auto left = static_cast<float>(std::max(portable::exp(-depth), fog.transmit));
    const auto filter = static_cast<float>(fog.filter);
    const Color clear = Color{1, 1, 1} * (1 - filter) + fog.color * filter;
    all.left = all.left * clear * left;
    all.light = all.light + fog.color * (1 - left);
  }
  return all;
}

}  // namespace oktett
