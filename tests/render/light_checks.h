#pragma once
/// \file Oracles for light sampling: surfaces cut into small patches, Lambert's formula, and Pearson's
/// chi-squared test.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "core/vec3.h"
#include "render/light/light_sample.h"
#include "render/sampling/warp.h"

namespace oktett::light_checks {

/// Independent random numbers.
class Random {
 public:
  explicit Random(std::uint64_t key) : key_(mix_bits(key + kGoldenBits)) {}
  double operator()() { return static_cast<double>(random_bits(key_, count_++, 7) >> 11) * 0x1p-53; }
  double between(double lo, double hi) { return lo + (*this)() * (hi - lo); }
  SquareSample square() {
    const double x = (*this)();
    return {x, (*this)()};
  }
  Vec3f direction() {
    const double z = between(-1, 1), angle = between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return Vec3f(Vec3d{r * std::cos(angle), r * std::sin(angle), z});
  }

 private:
  std::uint64_t key_;
  std::uint32_t count_ = 0;
};

/// A surface over the unit square.
struct ParametricSurface {
  std::function<Vec3d(double, double)> position;
  /// Unit normal times the area per area of the square.
  std::function<Vec3d(double, double)> area;
  /// The point of the square for a sample.
  std::function<SquareSample(const LightSample&, const Vec3f&)> inverse;
};

/// A small part of a surface as seen from a point.
struct Patch {
  double u, v, distance, solid_angle;
  Vec3d direction;
  Vec3d normal;  ///< unit
};

/// Cuts the surface until each patch is small compared with its distance from the point.
inline void cut(const ParametricSurface& surface, const Vec3d& point, double u0, double u1, double v0,
                double v1, int depth, const std::function<void(const Patch&)>& take) {
  const double u = (u0 + u1) / 2, v = (v0 + v1) / 2;
  const Vec3d middle = surface.position(u, v);
  const double along_u = length(surface.position(u1, v) - middle) + length(surface.position(u0, v) - middle);
  const double along_v = length(surface.position(u, v1) - middle) + length(surface.position(u, v0) - middle);
  const double far = length(middle - point);
  if (depth < 8 || (depth < 34 && std::max(along_u, along_v) > 0.06 * far)) {
    // Every other cut at first, so that patches lie in cells of the square.
    const bool cut_u = depth < 8 ? depth % 2 == 0 : along_u > along_v;
    cut(surface, point, u0, cut_u ? u : u1, v0, cut_u ? v1 : v, depth + 1, take);
    cut(surface, point, cut_u ? u : u0, u1, cut_u ? v0 : v, v1, depth + 1, take);
    return;
  }
  for (const double gu : {-1 / std::sqrt(3), 1 / std::sqrt(3)})
    for (const double gv : {-1 / std::sqrt(3), 1 / std::sqrt(3)}) {
      const double pu = u + gu * (u1 - u0) / 2, pv = v + gv * (v1 - v0) / 2;
      const Vec3d to = surface.position(pu, pv) - point, area = surface.area(pu, pv);
      const double d = length(to), part = (u1 - u0) * (v1 - v0) / 4;
      take({pu, pv, d, std::abs(dot(area, to)) / (d * d * d) * part, to / d, normalize(area)});
    }
}

/// The cell of a cube map with `n` x `n` cells per face; the cube is turned, so that its edges are parallel
/// to nothing.
inline std::size_t cube_cell(const Vec3d& direction, int n) {
  const Vec3d z = normalize(Vec3d{0.31, -0.27, 0.89}), x = normalize(cross(z, Vec3d{0.6, 0.7, -0.1}));
  const Vec3d d{dot(direction, x), dot(direction, cross(z, x)), dot(direction, z)};
  const int axis = dominant_axis(d);
  const double m = std::abs(d[axis]);
  const auto cell = [&](double c) { return std::clamp(static_cast<int>((c / m + 1) / 2 * n), 0, n - 1); };
  const int face = 2 * axis + (d[axis] < 0);
  return static_cast<std::size_t>((face * n + cell(d[(axis + 1) % 3])) * n + cell(d[(axis + 2) % 3]));
}

/// Lambert's formula: the irradiance of a polygon of radiance 1 that lies above the horizon.
inline double lambert(const std::vector<Vec3d>& corners, const Vec3d& point, const Vec3d& n) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalize(corners[i] - point), b = normalize(corners[(i + 1) % corners.size()] - point);
    const Vec3d side = cross(a, b);
    sum += std::atan2(length(side), dot(a, b)) * dot(normalize(side), n) / 2;
  }
  return std::abs(sum);
}

/// How many standard deviations Pearson's sum lies above its mean (Wilson and Hilferty 1931). `expected` and
/// `counted` have the same sum; cells are joined until each expects at least ten. A cell that expects nothing
/// but is counted gives a thousand.
inline double chi_squared(const std::vector<double>& expected, const std::vector<double>& counted) {
  double sum = 0, e = 0, c = 0, last_e = 1, last_c = 0;
  int cells = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] <= 0 && counted[i] > 0) return 1000;
    e += expected[i], c += counted[i];
    if (e < 10) continue;
    sum += (c - e) * (c - e) / e, ++cells;
    last_e = e, last_c = c, e = c = 0;
  }
  if (cells > 0 && e > 0) {
    sum -= (last_c - last_e) * (last_c - last_e) / last_e;
    last_e += e, last_c += c;
    sum += (last_c - last_e) * (last_c - last_e) / last_e;
  }
  if (cells < 2) return 0;
  const double k = cells - 1, width = 2 / (9 * k);
  return (std::cbrt(sum / k) - (1 - width)) / std::sqrt(width);
}

}  // namespace oktett::light_checks
