#pragma once
/// \file What a height field is to its kernels: samples, and how they lie in the element's own space.

#include "kernels/exact/exact.h"
#include "kernels/heights/height_field_data.h"
#include "kernels/heights/height_grid.h"

namespace oktett {

/// Upright walls of `nearest`; the others are parts of the surface (0) and faces of the box (1 to 6).
enum HeightPart { kWallLowX = 7, kWallHighX = 8, kWallLowZ = 9, kWallHighZ = 10 };

/// How the element's own space lies to the grid: column = x * scale.x + shift.x, sample as stored =
/// y * scale.y + shift.y, row = z * scale.z + shift.z.
struct HeightFrame {
  Vec3d scale, shift;
};

/// The own space is a uniformly scaled one: the rectangle and the heights lie about the origin, the longest
/// of their sides 2 or less.
struct HeightFieldElement {
  std::shared_ptr<const HeightGrid> keep;
  const HeightGrid* grid;
  HeightFrame frame;  ///< from the own space to the grid
  double margin;      ///< what the heights are bounded by is so far from them, in samples as stored
  HeightWalk walk;
  bool solid;
  Vec3d lo, hi;  ///< the box: of a solid, its lower face is the bottom
};

struct HeightFieldPool : ExactPool<HeightFieldElement> {
  /// With the samples and pyramids, each as often as it is in use.
  std::size_t bytes() const;
};

}  // namespace oktett
