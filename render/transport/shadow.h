#pragma once
/// \file Shadow rays: how much light arrives from each light.

#include "render/context.h"
#include "render/shading_point.h"
#include "render/transport/ray_queue.h"

namespace oktett {

/// Traces all rays of `queue` and adds to entry `owner` of `radiance` the light that arrives, in the order of
/// the queue.
void trace_shadows(const RenderContext& context, ShadowQueue& queue, ShadowRule rule, ColorColumn& radiance);

/// Surfaces that a shadow ray may pass before it counts as blocked.
inline constexpr int kMostShadowLayers = 128;

/// The part of a shadow ray behind the surface `s`. It ends where `ray` ends.
Ray continue_behind(const Ray& ray, const SurfaceInteraction& s);

}  // namespace oktett
