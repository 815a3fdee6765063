#pragma once
/// \file Directions of camera rays, computed in lanes.

#include <cstddef>

#include "core/isa.h"
#include "core/vec3.h"

namespace oktett {

/// The image plane in front of a pinhole camera.
struct ViewPlane {
  Vec3d corner;                    ///< from the pinhole to the point (0, 0)
  Vec3d per_pixel_x, per_pixel_y;  ///< from a point to its neighbours
};

/// Points (x[i], y[i]) of a plane, and the columns that receive the unit vectors from the pinhole to them.
struct ViewPoints {
  const double* x = nullptr;
  const double* y = nullptr;
  std::size_t count = 0;
  float* direction[3] = {};
};

/// direction = normalize(corner + x * per_pixel_x + y * per_pixel_y), computed in double and rounded once;
/// the same bits for every instruction set.
void view_directions(const ViewPlane& plane, const ViewPoints& points, Isa isa);

}  // namespace oktett
