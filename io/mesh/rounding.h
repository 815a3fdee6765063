#pragma once
/// \file Meshes whose parts lie so far apart that floats do not tell the corners of their triangles apart,
/// whatever centre is taken off. Within io/ only.

#include <functional>
#include <string>

#include "core/mesh.h"

namespace oktett {

/// What to warn of if rounding changed the shape of many triangles; else empty. Triangles are compared that
/// are spread over the mesh, at most 1024: one in eight of them has an edge that rounding moved by more than
/// a 64th of its longest one. `read_from(centre)` sets the positions of the mesh anew, less a centre in
/// double; it is called only if triangles are small enough, and the positions are those of before afterwards.
std::string find_rounding(TriangleMesh& mesh, const std::function<void(const Vec3d&)>& read_from);

}  // namespace oktett
