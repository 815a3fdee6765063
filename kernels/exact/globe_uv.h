#pragma once
/// \file Texture coordinates as on a globe.

#include "core/surface_interaction.h"
#include "core/vec3.h"

namespace oktett {

/// Longitude and latitude of p as of a point on a sphere about the origin, and the tangent along the
/// longitude.
void set_globe_uv(const Vec3d& p, SurfaceInteraction& s);

}  // namespace oktett
