#pragma once
/// \file Layers of light groups: the light that paths find goes to the picture and to the layer of its group.
/// Nothing is done unless RenderContext::light_groups is set.

#include "render/transport/wavefront.h"

namespace oktett {

/// Makes the layers of a wavefront black. Call it before the camera rays are shaded.
void start_layers(const RenderContext& context, Wavefront& wavefront);

/// Adds light to the layer of group number `group`.
inline void add_to_layer(Wavefront& wavefront, std::size_t ray, std::uint8_t group, const Color& light) {
  if (!wavefront.samples.grouped.empty())
    wavefront.samples.grouped[group].add(wavefront.rays.sample[ray], light);
}

/// Adds the light that the surface of material number `material` emits.
void add_emission_to_layer(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                           std::uint32_t material, const Color& light);

/// Adds the light that arrives by entry `entry` of a queue of shadow rays.
void add_shadow_to_layers(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue,
                          std::size_t entry, const Color& light);

/// Adds what a ray that meets nothing finds: `throughput` times the background, and times the environment's
/// radiance and `weight`.
void add_environment_to_layers(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                               const Color& environment, float weight);

}  // namespace oktett
