#pragma once
/// \file Cube maps of EXR. Not for other folders.

#include "render/light/environment_picture.h"

namespace oktett {

/// The same light by latitude and longitude. `cube` holds six square faces one above the other, +x, -x, +y,
/// -y, +z, -z of the world, each turned as OpenEXR's ImfEnvmap.h shows. The result has four faces' width:
/// around the horizon its pixels are as large as those of the faces.
EnvironmentPicture unfolded_cube(const EnvironmentPicture& cube);

}  // namespace oktett
