#pragma once
/// \file The mirror and refracted rays of a surface: directions and weights.

#include "render/shading_point.h"

namespace oktett {

/// Weights are black where there is no such ray.
struct SpecularRays {
  Vec3f mirror_direction, refracted_direction;
  Color mirror{0, 0, 0};     ///< reflection * specular colour + transparency * Fresnel reflectance
  Color refracted{0, 0, 0};  ///< transparency * colour * (1 - Fresnel reflectance)
};

/// A ray from the front enters the material; a ray from behind leaves it.
SpecularRays specular_rays(const ShadingPoint& p);

}  // namespace oktett
