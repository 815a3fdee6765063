#pragma once
/// \file Light from infinitely far away, given as a picture of all directions.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec3.h"
#include "render/light/environment_lanes.h"
#include "render/light/environment_picture.h"
#include "render/sampling/square_sample.h"

namespace oktett {

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
