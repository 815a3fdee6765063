#pragma once
/// \file What describes a height field.

#include <cstdint>
#include <memory>

#include "core/vec3.h"

namespace oktett {

/// The samples of a height field; make_height_grid makes one.
class HeightGrid;

/// The surface between four neighbouring samples.
enum class HeightInterpolation : std::uint8_t {
  nearest,    ///< a level square at their mean height, with upright walls to its neighbours (slides)
  triangles,  ///< two, which meet on the line from the corner (column + 1, row) to (column, row + 1)
  bilinear,   ///< a patch of a hyperbolic paraboloid (slides)
};

/// How a ray passes over the cells between samples. The hits are the same for each.
enum class HeightWalk : std::uint8_t {
  pyramid,  ///< in blocks of cells, skipping those whose least and greatest height the ray does not come
            ///< between
  cells,    ///< one cell after the other, by a digital differential analyser
  spans,    ///< runs of cells of one row (C. Henning, P. Stephenson 2004)
};

/// Heights over a rectangle about the y axis: sample (column, row) stands at x = (column / (columns - 1) -
/// 1/2) size.x, z = (row / (rows - 1) - 1/2) size.z, and y is size.y times its value.
struct HeightFieldShape {
  std::shared_ptr<const HeightGrid> grid;
  Vec3d size{2, 1, 2};  ///< > 0
  bool open = true;     ///< without the sides and the bottom at y = base, which make it a solid
  double base = 0;      ///< below all heights, unless open
  HeightWalk walk = HeightWalk::pyramid;
};

}  // namespace oktett
