#pragma once
/// \file Phong's illumination model for the lights of the scene.

#include <vector>

#include "core/platform.h"
#include "render/context.h"
#include "render/ray_queue.h"
#include "render/shading_point.h"

namespace oktett {

/// How far shadow rays reach whose direction is the way to the light: just not to it.
inline constexpr float kBeforeLight = 1 - 0x1p-24f;

/// Greatest exponent that is raised to by squaring, if it is whole: those of materials mostly are.
inline constexpr float kMostBySquaring = 1024;
inline bool by_squaring(float exponent) {
  return exponent <= kMostBySquaring && exponent >= 0 &&
         static_cast<float>(static_cast<unsigned>(exponent)) == exponent;
}

/// `cosine`, in [0, 1] or NaN, to the power of a material's exponent.
float highlight_power(float cosine, float exponent);

/// The sum of `phong` where the light is before the surface: `cosine` > 0 or NaN is that between shading
/// normal and light, `highlight` that between the mirrored light and the viewer, `power()` the
/// highlight_power of the latter, not above 1.
template <class Power>
OKTETT_INLINE Color phong_sum(const Material& m, const Color& color, const Color& specular_color,
                              float cosine, float highlight, Power&& power) {
  Color sum = color * (m.diffuse * cosine);
  // NaN is not left out.
  if (m.specular != 0 && !(highlight <= 0)) sum += specular_color * (m.specular * power());
  return sum;
}

/// Colour * diffuse * cos(n, l) + specular colour * specular * max(0, r . v)^phong (Phong 1975) for light
/// from the unit direction `l`; both sides of a surface are lit alike. Black if `l` is behind the true or the
/// shading surface.
Color phong(const ShadingPoint& p, const Vec3f& l);

/// For each light that could reach `p`, a shadow ray in that light's queue that adds throughput * light *
/// phong to the radiance of `owner`. There is a queue per light.
void add_direct_light(const RenderContext& context, const ShadingPoint& p, const Color& throughput,
                      std::uint32_t owner, std::vector<ShadowQueue>& shadows);

}  // namespace oktett
