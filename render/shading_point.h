#pragma once
/// \file Shading points: a hit's surface interaction with its material looked up, as the integrators need it.

#include <cstdint>
#include <optional>
#include <span>

#include "core/ray.h"
#include "core/surface_interaction.h"
#include "core/vec3.h"
#include "render/context.h"
#include "render/material.h"
#include "render/straight_light.h"
#include "render/texture_values.h"

namespace oktett {

/// What is known of a ray's path; it decides how finely textures are looked up.
struct RayHistory {
  float distance = 0;        ///< length of the path up to the ray's origin
  bool from_camera = false;  ///< a camera ray, or its straight continuation
};

struct ShadingPoint {
  SurfaceInteraction surface;
  const Material* material = nullptr;
  Vec3f direction;  ///< unit direction in which the ray travels
  float t = 0;      ///< distance from the ray's origin
  Vec3f ng, ns;     ///< geometric and shading normal, turned towards the ray's origin; dot(direction, ns) < 0
  Vec3f normal;     ///< shading normal with textures, on the side that the surface's own normal points to
  bool front = true;  ///< the ray comes from the side that the surface's own normal points to
  Color color, specular_color, emission;           ///< textures included
  float ior = 1.5f;                                ///< inside relative to outside; textures included
  PhongValues values{};                            ///< textures included
  std::optional<Color> filter;                     ///< of Material; textures included
  std::optional<Color> reflection_color;           ///< likewise
  float opacity = 1;                               ///< fraction that is surface; the rest is a hole
  std::optional<PrincipledParameters> principled;  ///< textures included; path tracing only
};

/// `ray` has unit direction, and `hit` is its valid hit, with the surface interaction `s`. Its tangents
/// may be missing, and its uv unless the picture shows it; both are computed if textures need them.
ShadingPoint shading_point(const RenderContext& context, const Ray& ray, const Hit& hit,
                           const RayHistory& history, const SurfaceInteraction& s);

/// The index of refraction of the material at a point; 1 without a surface.
float index_of_refraction(const ShadingPoint& p);
/// Gives the material at a point this index of refraction.
inline void set_index_of_refraction(ShadingPoint& p, float ior) {
  p.ior = ior;
  if (p.principled) p.principled->ior = ior;
}
/// index_of_refraction at a hit with the surface interaction `s`, of which only the names are used.
float index_of_refraction(const RenderContext& context, const Ray& ray, const Hit& hit,
                          const SurfaceInteraction& s);

/// What alpha and the data layers show of a hit.
struct ShownSurface {
  SurfaceInteraction surface;  ///< its shading normal with textures
  Color color;                 ///< textures included
  float opacity = 1;           ///< as in ShadingPoint
};

ShownSurface shown_surface(const ShadingPoint& p);
/// The same for a hit of which nothing else is needed. The arguments are those of shading_point().
ShownSurface shown_surface(const RenderContext& context, const Ray& ray, const Hit& hit,
                           const RayHistory& history, const SurfaceInteraction& s);

/// Surfaces that a ray or photon may pass straight, in addition to its bounces, before it counts as lost.
/// This is to end only rays that make no way: a line can meet hundreds of surfaces of a Menger sponge.
inline constexpr unsigned kMostPassages = 1u << 14;

/// What stops light on its way from an emitter.
enum class ShadowRule {
  /// Opaque materials, and in path tracing glass that scatters light. Other transparent ones take from light
  /// what they reflect by Fresnel's equations and what their colour absorbs, and do not bend it.
  transparent_passes,
  /// All materials; light passes only through holes. For light that other rays find behind glass.
  holes_pass,
};

/// What the surface at a hit of a shadow ray, of any length, does to light that goes straight through it. The
/// ray counts as the way of the light in air; in solids light has the angle that Snell's law then says.
/// `ior`: the index of refraction relative to what the solid lies in, if it is not that of the material
/// because solids touch (Boundary::ior).
StraightPassage straight_passage(const RenderContext& context, const Ray& ray, const Hit& hit,
                                 const SurfaceInteraction& s, ShadowRule rule,
                                 std::optional<float> ior = std::nullopt);

/// The part of light that holes let pass at a hit. Uses only the names of `s`.
Color passing_holes(const RenderContext& context, const Ray& ray, const Hit& hit,
                    const SurfaceInteraction& s);

/// True if no light passes straight at any hit.
bool is_opaque(const Material& material, ShadowRule rule);

}  // namespace oktett
