#pragma once
/// \file Closed meshes made by formula, and what can be said of any mesh without tracing a ray.

#include <string>
#include <vector>

#include "core/mesh.h"

namespace oktett {

/// Triangles point outwards, all of these are closed, and share their corners by index.
struct OracleMesh {
  std::string name;
  TriangleMesh mesh;
  bool convex = false;
};

/// A cube of edge 2 in 12 triangles.
OracleMesh make_cube();
/// The unit sphere: an icosahedron, each triangle split in four `levels` times.
OracleMesh make_icosphere(int levels);
/// A torus of radii 1 and 0.4 in rings * sides quadrilaterals, each two triangles.
OracleMesh make_torus(int rings, int sides);
/// A unit sphere of `slices` meridians, all of which meet in the two poles, and `stacks` parallels.
OracleMesh make_globe(int slices, int stacks);
/// A prism over a circle whose side walls are needles: 10^5 times as long as wide.
OracleMesh make_needles(int count);
std::vector<OracleMesh> make_closed_meshes();

/// The number of edges whose triangles do not pair up in opposite directions; corners are told apart by
/// position. 0 for a closed mesh.
std::size_t open_edge_count(const TriangleMesh& mesh);

/// How often the mesh winds around `point`, by solid angles (van Oosterom and Strackee 1983): whole up to
/// rounding for a closed mesh unless the point is near the surface.
double winding_number(const TriangleMesh& mesh, const Vec3d& point);

/// True if `point` may be within `distance` of a triangle.
bool near_surface(const TriangleMesh& mesh, const Vec3d& point, double distance);

/// The mesh with all positions scaled, then moved, rounded to float.
TriangleMesh placed(const TriangleMesh& mesh, double scale, const Vec3d& offset);

}  // namespace oktett
