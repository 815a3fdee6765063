#pragma once
/// \file One sphere and many, in a scene file and in a text file of their own. Within io/ only.

#include "io/scene/load.h"
#include "kernels/closed/shape_data.h"

namespace oktett {

/// A list of spheres, {centers, radius} or {file}. Spheres of radius 0 are left out with a warning.
SpheresShape read_spheres(SceneLoad& load, const YamlNode& node);

}  // namespace oktett
