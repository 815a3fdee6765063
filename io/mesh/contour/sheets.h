#pragma once
/// \file The vertices of a contour: one for each sheet of the surface in each cell. Within io/ only.

#include <cstdint>
#include <vector>

#include "io/mesh/contour/grid.h"
#include "io/mesh/contour/links.h"
#include "io/mesh/contour/rims.h"

namespace oktett {

/// Where sheets are: crossings that links in the faces of a cell hold together are one sheet there, so a cell
/// may have several (the idea of Schaefer, Ju and Warren 2007, "Manifold Dual Contouring").
struct ContourSheets {
  std::vector<std::uint32_t> of_quadrant;  ///< the sheet of 4 x + quadrant
  std::vector<std::uint32_t> begin;        ///< where the quadrants of each sheet begin in `quadrants`
  std::vector<std::uint32_t> quadrants;    ///< sheet by sheet

  std::size_t count() const { return begin.size() - 1; }
};

ContourSheets find_sheets(const ContourCrossings& crossings, const std::vector<SlotNumber>& links);

/// The vertex of a sheet, and the normals of the surface there: one where it is smooth, two at an edge, three
/// at a corner.
struct SheetVertex {
  Vec3d position;
  Vec3f normals[3];
  std::uint8_t smooth_parts = 1;
};

/// The vertex of each sheet. It is the minimum of the error function of its crossings, and of the points of
/// rims in the faces around, within its cell, moved
/// to the surface then: rays along the normals of its smooth parts meet the surface beside it, and the
/// minimum for these places is nearer to the edge or corner, where parts are curved.
std::vector<SheetVertex> place_vertices(const Accel& accel, const ContourGrid& grid,
                                        const ContourCrossings& crossings, const ContourSheets& sheets,
                                        const std::vector<SlotNumber>& links,
                                        const std::vector<RimPoint>& rims);

}  // namespace oktett
