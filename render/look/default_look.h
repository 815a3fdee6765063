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

/// Where a mesh is seen from.
enum class Viewpoint {
  automatic,  ///< inside if interior_view says so
  outside,
  inside,
};

/// Whether the scene holds at most one object, a mesh, and neither a camera nor lights.
bool is_mesh_alone(const Scene& scene);

/// Completes a scene that holds nothing but one mesh: camera, ground, light, integrator, and a material for
/// what has none. Up is that of its camera. Film, seed and what else it says stay. A scene without objects
/// stays as it is.
void apply_look(Scene& scene, Look look, Viewpoint viewpoint);
/// From where it is best seen.
void apply_look(Scene& scene, Look look);

}  // namespace oktett
