#pragma once
/// \file Shadow rays: how much light arrives from each light.

#include "render/context.h"
#include "render/shading_point.h"
#include "render/transport/ray_queue.h"

namespace oktett {

struct Wavefront;

/// Adds `light` to the radiance of the owner of an entry of `queue`, and to the layer of its light group.
void add_arriving(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue,
                  std::size_t entry, const Color& light);

/// Traces all rays of `queue`, one of the wavefront's, and adds the light that arrives to their owners, in
/// the order of the queue.
void trace_shadows(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue, ShadowRule rule);

/// Traces all rays of `queue`, one of the wavefront's, and leaves in `queue.light` what arrives: black where
/// something is in the way.
void find_arriving(const RenderContext& context, ShadowQueue& queue, ShadowRule rule);

/// The part of a shadow ray behind the surface `s`. It ends where `ray` ends.
Ray continue_behind(const Ray& ray, const SurfaceInteraction& s);

}  // namespace oktett
