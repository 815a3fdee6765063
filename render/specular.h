#pragma once
/// \file The directions in which a mirror or a transparent surface sends a ray on, and with what weights.

#include "render/shading_point.h"

namespace oktett {

/// Weights are black where there is no such ray.
struct SpecularRays {
  Vec3f mirror_direction, refracted_direction;
  Color mirror{0, 0, 0};     ///< reflection * specular colour + transparency * Fresnel reflectance
  Color refracted{0, 0, 0};  ///< transparency * colour * (1 - Fresnel reflectance)
};

/// The ray enters the material if it comes from the front, else it leaves.
SpecularRays specular_rays(const ShadingPoint& p);

}  // namespace oktett
