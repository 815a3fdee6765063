#pragma once
/// \file Path tracing in media: what a wavefront does where the scene tracks in which solids its rays are.

#include "render/shading_point.h"
#include "render/transport/sample_dimensions.h"
#include "render/transport/wavefront.h"

namespace oktett {

/// Says for all camera rays in which solids they start.
void enclose_camera_rays(const RenderContext& context, Wavefront& wavefront);

/// Sends all rays, whose hits are known, through the media before them, and lists what they meet there in
/// `medium_events`. Rays that are scattered count as misses from then on, of throughput 0; the length of
/// their way is in the column of hits. The throughput of the others changes.
void pass_media(const RenderContext& context, Wavefront& wavefront);

/// Shades `medium_events`: adds the light of glowing media, and at places of scattering sends one ray to a
/// light and one in a direction of the phase function.
void shade_media(const RenderContext& context, Wavefront& wavefront);

/// The random numbers for what happens to entry `ray` in a medium.
TrackingNumbers tracking_numbers(const Wavefront& wavefront, std::uint32_t ray, MediumDecision decision);

/// trace_shadows for rays that may be in solids and media: both attenuate the light.
void trace_shadows_in_media(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue,
                            ShadowRule rule);

}  // namespace oktett
