#pragma once
/// \file Integrators: what happens where a ray has hit a surface, one function per kind of picture.

#include <iterator>

#include "accel/interaction_block.h"
#include "render/transport/wavefront.h"

namespace oktett {

/// Shades the hit `p` of entry `ray` of `wavefront.rays`: adds light that needs no further ray to
/// `wavefront.radiance`, and queues shadow rays for light that depends on visibility, and the rays of the
/// next bounce.
using ShadeHit = void(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                      const ShadingPoint& p);
/// The same for the hits of rays `which[0]` ... `which[count - 1]`, whose surface interactions are `found`;
/// records first hits, too. The bits of a hit do not depend on the others.
using ShadeBlock = void(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                        std::size_t count, const InteractionBlock& found);

/// Recursive ray tracing after Whitted (1980) with Phong's illumination model, mirrors, and dielectrics by
/// Snell's and Fresnel's laws; see Material for the sum.
ShadeBlock shade_whitted_block;

/// Removes from wavefront.hit_rays the hits that add no light: at the last bounce, those on surfaces that
/// only send rays on. For Whitted's model.
void drop_dark_hits(const RenderContext& context, Wavefront& wavefront);

/// Queues the shadow rays of hits in a penumbra to the points of area lights that their own pattern lacks: of
/// the rays `which`, which share a pattern, with the surface interactions `found`. Rays of a hit follow each
/// other in `queue`, in the order of the points.
void queue_penumbra_rays(const RenderContext& context, Wavefront& wavefront,
                         std::span<const std::uint32_t> which, const InteractionBlock& found,
                         ShadowQueue& queue);

/// Unidirectional path tracing (Kajiya 1986). Each hit sends one ray to a light that is chosen at random and
/// one in a direction that the material chooses. Light that both can find is weighted by the power heuristic
/// (Veach 1997). After `depth` bounces the next surface gives only what it emits. Nothing is cut off: the
/// expected value of a pixel is its light, but for two conventions. Light from points passes glass straight,
/// as no ray could find it otherwise. Ambient light is left out, since it stands for the indirect light that
/// path tracing computes.
ShadeBlock shade_path_block;

/// Light that needs no lights, and what the camera sees without light.
ShadeHit shade_ambient_occlusion, shade_normal, shade_depth, shade_albedo, shade_uv, shade_position,
    shade_object, shade_primitive, shade_facing, shade_wire;

/// How an integrator shades: exactly one of the two is set.
struct Integrator {
  ShadeHit* shade;
  ShadeBlock* shade_block;
};

/// In the order of IntegratorKind.
inline constexpr Integrator kIntegrators[] = {
    {nullptr, shade_whitted_block},
    {nullptr, shade_path_block},
    {shade_ambient_occlusion, nullptr},
    {shade_normal, nullptr},
    {shade_depth, nullptr},
    {shade_albedo, nullptr},
    {shade_uv, nullptr},
    {shade_position, nullptr},
    {shade_object, nullptr},
    {shade_primitive, nullptr},
    {shade_facing, nullptr},
    {shade_wire, nullptr},
};
static_assert(std::size(kIntegrators) == std::size(kIntegratorKinds));
inline const Integrator& integrator(IntegratorKind kind) {
  return kIntegrators[static_cast<std::size_t>(kind)];
}

/// Which queue of a Wavefront holds the shadow rays of path tracing to lights that other rays can meet.
inline constexpr std::size_t kAreaQueue = 1;

}  // namespace oktett
