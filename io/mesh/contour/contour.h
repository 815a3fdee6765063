#pragma once
/// \file Triangle meshes of exact surfaces, by dual contouring. Within io/ only.

#include <cstdint>
#include <vector>

#include "accel/accel.h"
#include "core/mesh.h"

namespace oktett {

struct ContourOptions {
  std::uint32_t cells = 64;  ///< of the grid along the longest edge of the bounds; at least 1
  /// The surface is that of a solid: the mesh is closed, and its front is the outside. Else it may end
  /// anywhere.
  bool closed = true;
};

struct Contour {
  /// Vertices have a normal for each smooth part of the surface that meets there. Positions are those of the
  /// structure.
  TriangleMesh mesh;
  std::vector<std::uint32_t> users;  ///< SurfaceInteraction::user of each triangle
  /// The greatest distance of a crossing, which is on the surface, from the triangles across its edge.
  double deviation = 0;
};

/// The mesh of all that a structure holds. Rays along the lines of a grid find crossings and normals; in each
/// cell each sheet of the surface gets a vertex where the planes of its crossings meet best (dual contouring:
/// Ju, Losasso, Schaefer and Warren 2002), each crossing a quad of the vertices around its edge. Sheets are
/// told apart by how crossings are linked around the faces of the grid, so an edge may have several: plates
/// thinner than a cell stay. What is thinner than a cell in two directions may be missed. Sharp edges and
/// corners are kept.
///
/// Of a solid each edge of the mesh belongs to two triangles, which run along it in opposite directions.
/// The longest edge of the bounds should be about 1 or 2: rays are floats. Runs in parallel; the mesh is the
/// same for any number of threads. Throws Error if there is too much of the surface.
Contour contour(const Accel& accel, const ContourOptions& options);

}  // namespace oktett
