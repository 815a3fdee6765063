#pragma once
/// \file A picture of all directions as data.

#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace oktett {

/// A picture of all directions as columns of longitude and rows of latitude, row by row. The top row is up,
/// +y; the middle column looks along -z, and columns to the right of it look towards +x.
struct EnvironmentPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<Color> pixels;  ///< linear radiance, width * height
};

/// The unit vector to the place at fractions `u` of the width and `v` of the height of a map that is not
/// rotated.
Vec3f environment_direction(double u, double v);

}  // namespace oktett
