#pragma once
/// \file Which way is up in a mesh whose file does not say it.

#include "core/mesh.h"
#include "core/vec3.h"

namespace oktett {

/// The up direction of a mesh: +y, which most modellers use, unless the mesh shows that it is +z:
///
/// - It stands along z, and not along y. It stands along an axis if the lowest hundredth of it spans much of
///   the rectangle that it fills, seen along that axis: a base, or feet. Along z this must be more than a
///   tenth of the rectangle and more than three times as much as along y. A box stands along both: +y.
/// - Or it is open, faces +z or -z almost everywhere, and is low, but not flat: terrain. An open surface that
///   is higher than a third of its width, such as the scan of a face, and a flat one, such as a picture, have
///   +y.
///
/// Only vertices of triangles count. A mesh without triangles has +y.
Vec3d guess_up(const TriangleMesh& mesh);

}  // namespace oktett
