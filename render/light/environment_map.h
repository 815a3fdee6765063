#pragma once
/// \file Light from infinitely far away, given as a picture of all directions.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/math.h"
#include "core/vec3.h"
#include "render/light/environment_picture.h"
#include "render/sampling/warp.h"

namespace oktett {

// ---- Look-ups and samples in lanes. Single directions use them with one lane.

/// The tables of an EnvironmentMap.
struct EnvironmentTables {
  std::int32_t width = 0, height = 0;
  const Color* pixels = nullptr;
  const double* rows = nullptr;     ///< [height]: weight times solid angle of this row and those above
  const double* columns = nullptr;  ///< [height][width]: weights of the row up to this pixel
  const double* cosines = nullptr;  ///< [height + 1]: of the angle between +y and the edges of rows
  const float* density = nullptr;   ///< [height][width]: per solid angle
  double total = 0;
  double cos_rotation = 1, sin_rotation = 0;
  bool smooth = true;
};

/// Fractions of width and height at which the map shows unit vectors.
template <class D>
struct MapPlaces {
  D u, v;
};

template <int W, class A>
OKTETT_INLINE MapPlaces<Simd<double, W, A>> map_places(const EnvironmentTables& map,
                                                       const Vec3<Simd<float, W, A>>& direction) {
  using D = Simd<double, W, A>;
  const D c(map.cos_rotation), s(map.sin_rotation), zero(0.0);
  const Vec3<D> d = to_double(direction);
  const D x = c * d.x - s * d.z, z = s * d.x + c * d.z, out = sqrt(x * x + z * z);
  D turn = atan2_lanes(x, -z);
  if (const unsigned edge = bits(x == zero); edge != 0) {
    // The signs of zeros say on which side of the map's edge a direction lies.
    double lanes[W], xs[W], zs[W];
    turn.store(lanes), x.store(xs), (-z).store(zs);
    for (int k = 0; k < W; ++k)
      if (edge >> k & 1) lanes[k] = portable::atan2(xs[k], zs[k]);
    turn = D::load(lanes);
  }
  const D down = atan2_lanes(out, d.y) / D(std::numbers::pi);
  // A NaN becomes 0.
  return {max(D(0.5) + turn / D(2 * std::numbers::pi), zero), max(down, zero)};
}

/// Which of `count` pixels hold fractions `f` >= 0.
template <class D>
OKTETT_INLINE D map_pixels(const D& f, std::int32_t count) {
  return whole_part(min(f * D(double(count)), D(double(count - 1))));
}

/// The radiance of the pixels around one place, bilinear between the centres of pixels.
template <class A>
Color smooth_radiance(const EnvironmentTables& map, double u, double v) {
  const double x = u * map.width - 0.5, y = v * map.height - 0.5;
  const auto below = [](double t) {
    const auto whole = static_cast<std::int32_t>(t);
    return whole > t ? whole - 1 : whole;
  };
  const std::int32_t column = below(x), row = below(y);
  const auto right_part = static_cast<float>(x - column), lower_part = static_cast<float>(y - row);
  const std::int32_t left = column < 0 ? column + map.width : column;
  const std::int32_t right = column + 1 >= map.width ? column + 1 - map.width : column + 1;
  const auto mixed = [&](std::int32_t j) {
    const std::int32_t at = j < 0 ? 0 : j >= map.height ? map.height - 1 : j;
    const Color* const pixels = map.pixels + std::int64_t{at} * map.width;
    const Color &a = pixels[left], &b = pixels[right];
    const float part = 1 - right_part;
    return Color{a.x * part + b.x * right_part, a.y * part + b.y * right_part, a.z * part + b.z * right_part};
  };
  const Color above = mixed(row), lower = mixed(row + 1);
  const float part = 1 - lower_part;
  return {above.x * part + lower.x * lower_part, above.y * part + lower.y * lower_part,
          above.z * part + lower.z * lower_part};
}

template <int W, class A>
OKTETT_INLINE void map_radiance(const EnvironmentTables& map, const MapPlaces<Simd<double, W, A>>& at,
                                float* const (&radiance)[3]) {
  double u[W], v[W];
  if (map.smooth) {
    at.u.store(u), at.v.store(v);
    for (int k = 0; k < W; ++k) {
      const Color c = smooth_radiance<A>(map, u[k], v[k]);
      radiance[0][k] = c.x, radiance[1][k] = c.y, radiance[2][k] = c.z;
    }
    return;
  }
  map_pixels(at.u, map.width).store(u), map_pixels(at.v, map.height).store(v);
  for (int k = 0; k < W; ++k) {
    const Color& c =
        map.pixels[static_cast<std::int64_t>(v[k]) * map.width + static_cast<std::int64_t>(u[k])];
    radiance[0][k] = c.x, radiance[1][k] = c.y, radiance[2][k] = c.z;
  }
}

template <int W, class A>
OKTETT_INLINE void map_density(const EnvironmentTables& map, const MapPlaces<Simd<double, W, A>>& at,
                               float* density) {
  double column[W], row[W];
  map_pixels(at.u, map.width).store(column), map_pixels(at.v, map.height).store(row);
  for (int k = 0; k < W; ++k)
    density[k] = map.total > 0 ? map.density[static_cast<std::int64_t>(row[k]) * map.width +
                                             static_cast<std::int64_t>(column[k])]
                               : 0;
}

/// Indices of the intervals of increasing `sums`, W lists of `count` sums, in which `value` lies, and in
/// which part of them. Intervals of length 0 are never chosen; at least one must be longer.
template <int W, class A>
OKTETT_INLINE void find_intervals(const double* const (&sums)[W], std::int32_t count,
                                  const Simd<double, W, A>& value, std::int32_t* found,
                                  Simd<double, W, A>& part) {
  double values[W], before[W], after[W];
  value.store(values);
  std::int32_t step = 1;
  while (2 * step <= count) step *= 2;
  for (int k = 0; k < W; ++k) found[k] = 0;
  // All lanes take each step together, so that their loads overlap.
  for (; step > 0; step /= 2)
    for (int k = 0; k < W; ++k) {
      const std::int32_t next = found[k] + step;
      const std::int32_t last = next <= count ? next - 1 : count - 1;
      found[k] = ((next <= count) & (sums[k][last] <= values[k])) != 0 ? next : found[k];
    }
  for (int k = 0; k < W; ++k) {
    // A value that is rounded up to the whole sum lies in the last interval that is not empty.
    if (found[k] == count)
      for (found[k] = count - 1; found[k] > 0 && sums[k][found[k] - 1] == sums[k][count - 1];) --found[k];
    before[k] = found[k] == 0 ? 0 : sums[k][found[k] - 1], after[k] = sums[k][found[k]];
  }
  using D = Simd<double, W, A>;
  const D low = D::load(before);
  part = min(max((value - low) / (D::load(after) - low), D(0.0)), D(1.0));
}

/// EnvironmentMap::Sample in lanes.
template <int W, class A>
struct MapSamples {
  Vec3<Simd<float, W, A>> direction;
  MapPlaces<Simd<double, W, A>> place;
  std::int32_t row[W], column[W];
};

/// Directions for points (x, y) of the unit square, uniform over the solid angle of the pixels chosen.
template <int W, class A>
OKTETT_INLINE MapSamples<W, A> map_samples(const EnvironmentTables& map, const Simd<double, W, A>& x,
                                           const Simd<double, W, A>& y) {
  using D = Simd<double, W, A>;
  MapSamples<W, A> s;
  const double* sums[W];
  double in_row_total[W], top[W], bottom[W], column[W];
  D in_row, in_column;
  for (int k = 0; k < W; ++k) sums[k] = map.rows;
  find_intervals<W, A>(sums, map.height, y * D(map.total), s.row, in_row);
  for (int k = 0; k < W; ++k) {
    sums[k] = map.columns + std::int64_t{s.row[k]} * map.width, in_row_total[k] = sums[k][map.width - 1];
    top[k] = map.cosines[s.row[k]], bottom[k] = map.cosines[s.row[k] + 1];
  }
  find_intervals<W, A>(sums, map.width, x * D::load(in_row_total), s.column, in_column);
  for (int k = 0; k < W; ++k) column[k] = s.column[k];

  const D one(1.0), upper = D::load(top), cosine = upper + in_row * (D::load(bottom) - upper);
  const D sine = sqrt(max(D(0.0), (one - cosine) * (one + cosine)));
  s.place.u = (D::load(column) + in_column) / D(double(map.width));
  s.place.v = atan2_lanes(sine, cosine) / D(std::numbers::pi);
  D sine_turn, cosine_turn;
  sin_cos_of_turn(s.place.u, sine_turn, cosine_turn);
  // The middle column looks along -z.
  const D east = -sine * sine_turn, south = sine * cosine_turn;
  const D c(map.cos_rotation), r(map.sin_rotation);
  s.direction = to_float(Vec3<D>{c * east + r * south, cosine, c * south - r * east});
  return s;
}

struct EnvironmentOptions {
  double rotation = 0;  ///< radians; turns the map about +y, counter-clockwise as seen from above
  /// Interpolates between the centres of pixels, bilinearly. False: each pixel has one colour.
  bool smooth = true;
  /// Leaves out of the density what a map of constant radiance would give (Karlik et al. 2019, "MIS
  /// compensation"). Directions darker than the mean are then never chosen, so they must be met by other
  /// rays, with weights of multiple importance sampling.
  bool compensate = false;
};

/// Light of a picture and directions chosen by how bright they are. The density is constant in each pixel:
/// it is proportional to the pixel's radiance, averaged over channels and over the interpolation, per solid
/// angle.
class EnvironmentMap {
 public:
  /// Pixels that are negative or not finite count as black. Throws Error if the picture is empty or its
  /// pixels do not fill it.
  explicit EnvironmentMap(EnvironmentPicture picture, const EnvironmentOptions& options = {});

  struct Sample {
    Vec3f direction;  ///< unit
    Color radiance;
    float pdf;   ///< per solid angle, > 0
    float u, v;  ///< fractions of width and height
  };

  /// Whether directions can be chosen: not if the map is black, or constant and compensated.
  bool samples() const { return total_ > 0; }
  /// samples() must be true.
  Sample sample(const SquareSample& s) const;
  /// The density with which sample() chooses the unit vector `direction`.
  float pdf(const Vec3f& direction) const;
  /// The radiance that arrives from the unit vector `direction`.
  Color radiance(const Vec3f& direction) const;
  /// The mean over all directions of the mean of the channels.
  double mean_radiance() const { return mean_; }
  /// Valid as long as the map.
  EnvironmentTables tables() const;

 private:
  const Color& pixel(std::int64_t x, std::int64_t y) const;
  double weight(std::int64_t x, std::int64_t y) const;
  /// Fills the sums and total_.
  void prepare_density(double subtract);
  double pixel_solid_angle(std::size_t row) const;

  EnvironmentPicture picture_;
  double cos_rotation_, sin_rotation_;
  bool smooth_;
  double mean_ = 0, total_ = 0;
  /// For each row: the sum of weight times solid angle over this row and those above. For each pixel: the sum
  /// of weights over this pixel and those left of it in its row.
  std::vector<double> rows_, columns_;
  std::vector<double> cosines_;  ///< of the angle between +y and the edges of rows
  std::vector<float> density_;   ///< of each pixel, per solid angle
};

}  // namespace oktett
