#pragma once
/// \file Meshes whose parts lie so far apart that floats do not tell the corners of their triangles apart,
/// whatever centre is taken off. Within io/ only.

#include <functional>
#include <string>

#include "core/mesh.h"
#include "io/mesh/reading.h"

namespace oktett {

/// What to warn of if rounding changed the shape of many triangles; else empty. At most 1024 triangles,
/// spread over the mesh, are compared; many are one in eight, and the shape of one is changed if an edge was
/// moved by more than a 64th of its longest edge. `read_from(centre)` sets the positions of the mesh anew,
/// less a centre in double; it is called only if triangles are small enough, and the positions are those of
/// before afterwards.
std::string find_rounding(TriangleMesh& mesh, const std::function<void(const Vec3d&)>& read_from);
/// Adds that to the notices of a file.
void note_rounding(ParsedMesh& parsed, const std::function<void(const Vec3d&)>& read_from);

}  // namespace oktett
