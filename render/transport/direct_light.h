#pragma once
/// \file Phong's illumination model for the lights of the scene.

#include <vector>

#include "core/platform.h"
#include "render/context.h"
#include "render/shading_point.h"
#include "render/transport/ray_queue.h"

namespace oktett {

/// tmax of shadow rays whose direction is the vector to the light: they end just before it.
inline constexpr float kBeforeLight = 1 - 0x1p-24f;

/// phong_power, rounded to float.
float highlight_power(float cosine, float exponent);

/// The sum that `phong` returns where the light is in front of the surface. `cosine`, > 0 or NaN, is the
/// cosine between shading normal and light; `highlight` is that between the mirrored light and the viewer;
/// `power()` returns the highlight_power of min(highlight, 1).
template <class Power>
OKTETT_INLINE Color phong_sum(const PhongValues& m, const Color& color, const Color& specular_color,
                              float cosine, float highlight, Power&& power) {
  Color sum = color * (m.diffuse * cosine);
  // The comparison keeps NaN in the sum.
  if (m.specular != 0 && !(highlight <= 0)) sum += specular_color * (m.specular * power());
  return sum;
}

/// Colour * diffuse * cos(n, l) + specular colour * specular * max(0, r . v)^phong (Phong 1975) for light
/// from the unit direction `l`; both sides of a surface are lit alike. Black if `l` is behind the true or the
/// shading surface.
Color phong(const ShadingPoint& p, const Vec3f& l);

/// A shadow ray in `queue` that adds throughput * light * phong to the radiance of `owner`, if the light
/// could reach `p`.
void add_light(const ShadingPoint& p, const Color& throughput, const LightSource& light, std::uint32_t owner,
               ShadowQueue& queue);

/// For each light that could reach `p`, a shadow ray in that light's queue that adds throughput * light *
/// phong to the radiance of `owner`. There is a queue per light, and then one for each point of a pattern of
/// the area lights, of which those of `pattern` are asked.
void add_direct_light(const RenderContext& context, const ShadingPoint& p, const Color& throughput,
                      std::uint32_t pattern, std::uint32_t owner, std::vector<ShadowQueue>& shadows);

}  // namespace oktett
