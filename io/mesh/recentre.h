#pragma once
/// \file Meshes that lie far from the origin, such as scans in coordinates of a map. Floats would lose their
/// details, so a centre is taken off in double precision. Within io/ only.

#include <optional>
#include <span>

#include "core/mesh.h"

namespace oktett {

/// A centre to take off positions that lie more than 128 times their extent from the origin, of which floats
/// keep fewer than 16 bits; nothing for others. It is a multiple of a power of two that is at least their
/// extent, so floats can hold it exactly. `exact`: positions are those of the file; then nothing is taken off
/// along axes that are not far, so that all differences are floats, too.
std::optional<Vec3d> far_centre(std::span<const Vec3f> positions, bool exact);

/// Takes a centre off positions that are exact as floats; so are the differences then.
void take_off(const Vec3d& centre, TriangleMesh& mesh);

}  // namespace oktett
