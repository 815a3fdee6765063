#pragma once
/// \file Directions and places made from points of the unit square.

#include <cstdint>
#include <vector>

#include "core/vec3.h"
#include "render/sampling/filter_kind.h"

namespace oktett {

/// A point of the unit square, [0, 1) in both coordinates.
struct SquareSample {
  double x = 0, y = 0;
};

/// A unit vector about the unit normal `n` with density cos(angle) / pi.
Vec3f cosine_direction(const Vec3f& n, const SquareSample& s);

/// A point of the unit disk, uniformly distributed: the concentric map of Shirley and Chiu (1997), which
/// keeps neighbours together. Coordinates in [-1, 1].
SquareSample disk_point(const SquareSample& s);

// ---- Places of samples about a pixel's centre, with the density of a reconstruction filter.

class FilterSampler {
 public:
  /// The box of one pixel.
  FilterSampler() = default;
  /// `radius` in pixels; 0: usual_radius(kind).
  FilterSampler(FilterKind kind, double radius);

  /// Whether the filter is the square of the pixel.
  bool is_pixel() const { return kind_ == FilterKind::box && radius_ == 0.5; }
  double radius() const { return radius_; }
  /// The distance from the centre, in pixels, along one axis, for a number in [0, 1). It grows with the
  /// number, so evenly spread numbers give evenly spread places.
  double offset(double u) const;

 private:
  FilterKind kind_ = FilterKind::box;
  double radius_ = 0.5;
  // Bell shapes are sampled as steps of equal width from -radius to radius.
  std::vector<double> below_;         ///< weight of all steps below step i, in all 1; one more than steps
  std::vector<std::uint32_t> first_;  ///< the step that holds i / steps
};

/// The weight of a filter at `x` in [-1, 1], where the radius is 1, without a factor.
double filter_weight(FilterKind kind, double x);

}  // namespace oktett
