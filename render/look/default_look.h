#pragma once
/// \file How a mesh that is given without a scene is shown.

#include "render/scene.h"

namespace oktett {

enum class Look {
  studio,   ///< its materials, on a soft ground in a studio's light
  clay,     ///< the same with one matt material for everything
  normals,  ///< shading normals as colours, without a ground
  wire,     ///< the edges of triangles, without a ground
};

/// Whether the scene holds at most one object, a mesh, and neither a camera nor lights.
bool is_mesh_alone(const Scene& scene);

/// Completes a scene that holds nothing but one mesh: camera, ground, light, integrator, and a material for
/// what has none. A room is shown from inside. Film, seed and what else it says stay. A scene without objects
/// stays as it is.
void apply_look(Scene& scene, Look look);

}  // namespace oktett
