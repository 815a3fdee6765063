#pragma once
/// \file Phong's illumination model for the lights of the scene.

#include <vector>

#include "render/context.h"
#include "render/ray_queue.h"
#include "render/shading_point.h"

namespace oktett {

/// Colour * diffuse * cos(n, l) + specular colour * specular * max(0, r . v)^phong (Phong 1975) for light
/// from the unit direction `l`; both sides of a surface are lit alike. Black if `l` is behind the true or the
/// shading surface.
Color phong(const ShadingPoint& p, const Vec3f& l);

/// For each light that could reach `p`, a shadow ray in that light's queue that adds throughput * light *
/// phong to the radiance of `owner`. There is a queue per light.
void add_direct_light(const RenderContext& context, const ShadingPoint& p, const Color& throughput,
                      std::uint32_t owner, std::vector<ShadowQueue>& shadows);

}  // namespace oktett
