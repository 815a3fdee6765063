#include "render/transport/medium_paths.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "render/medium/phase.h"
#include "render/sampling/owen_sobol.h"
#include "render/transport/grouped_light.h"
#include "render/transport/integrators.h"
#include "render/transport/path_choices.h"

namespace oktett {

void enclose_camera_rays(const RenderContext& context, Wavefront& wavefront) {
  const std::size_t count = wavefront.rays.size();
  Column<EnclosureStack>& enclosures = wavefront.paths.enclosures;
  enclosures.resize_uninitialized(count);
  std::fill_n(enclosures.data(), count, context.camera_enclosures);
  if (!context.world->has_enclosing_solids) return;
  // Where a camera has more than one place, surfaces may lie in between.
  RayBatch between;
  std::vector<std::uint32_t> away;
  for (std::uint32_t i = 0; i < count; ++i) {
    Ray ray{context.camera_place, 0, wavefront.rays.rays[i].origin - context.camera_place, 1};
    if (ray.direction == Vec3f{0, 0, 0}) continue;
    between.push_back(ray), away.push_back(i);
  }
  if (away.empty()) return;
  HitLists lists;
  all_hits(*context.world->accel, between.span(), lists, context.isa);
  for (std::uint32_t k = 0; k < away.size(); ++k)
    enclosures[away[k]] = enclosures_behind(context, context.camera_enclosures, between[k], lists.of_ray(k));
}

TrackingNumbers tracking_numbers(const Wavefront& wavefront, std::uint32_t ray, MediumDecision decision) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint32_t number = wavefront.samples.number[sample];
  return {sequence_key(wavefront.samples.key[sample], dimension(decision, wavefront.level)), number};
}

/// The numbers that decide how far entry `ray` goes.
static SquareSample passage_point(const Wavefront& wavefront, std::uint32_t ray) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint32_t passage = dimension(MediumDecision::passage, wavefront.level);
  return sobol_point(wavefront.samples.number[sample], sequence_key(wavefront.samples.key[sample], passage));
}

void pass_media(const RenderContext& context, Wavefront& wavefront) {
  wavefront.medium_events.clear();
  for (std::uint32_t i = 0; i < wavefront.rays.size(); ++i) {
    const std::uint32_t medium =
        medium_in(*context.world, wavefront.paths.enclosures[i], context.outer_medium);
    if (medium == kNoId) continue;
    const Ray ray = wavefront.rays.rays[i];
    const Color before = wavefront.rays.throughput[i];
    TrackingNumbers numbers = tracking_numbers(wavefront, i, MediumDecision::tracking);
    const MediumPassage passage = context.media[medium].pass({ray.origin, ray.direction, wavefront.hits.t[i]},
                                                             before, passage_point(wavefront, i), numbers);
    if (passage.scattered || !(passage.emitted == Color{0, 0, 0}))
      wavefront.medium_events.push_back({i, medium, passage});
    const Color after = passage.scattered ? Color{0, 0, 0} : passage.throughput;
    wavefront.rays.throughput.set(i, after);
    // In the mean this covers 1 - transmittance of the pixel.
    if (wavefront.rays.from_camera[i])
      wavefront.samples.alpha[wavefront.rays.sample[i]] += channel_mean(before) - channel_mean(after);
    if (!passage.scattered) continue;
    wavefront.hits.item[i] = kNoId;
    wavefront.hits.t[i] = static_cast<float>(passage.t);
  }
}

/// Shades the place where entry `ray` is scattered.
static void shade_scattering(const RenderContext& context, Wavefront& wavefront, const MediumEvent& event) {
  const Choices choices(wavefront, event.ray);
  const Ray ray = wavefront.rays.rays[event.ray];
  const float anisotropy = context.media[event.medium].anisotropy();
  LightPoint from;
  from.position = ray.origin + ray.direction * static_cast<float>(event.passage.t);
  const EnclosureStack around = wavefront.paths.enclosures[event.ray];
  const Color throughput = event.passage.throughput;
  if (const std::optional<LightSample> light = choose_light(context, from, choices)) {
    const float value = phase_value(ray.direction, light->direction, anisotropy);
    const Color arriving = light_found(context, throughput, *light, {Color{value, value, value}, value});
    queue_light(wavefront, event.ray, from.position, from, *light, arriving, light->delta, &around);
  }
  const Vec3f direction = phase_direction(ray.direction, anisotropy, choices.point(Decision::direction));
  Color onward = throughput;
  if (!survives(wavefront, event.ray, choices, onward, onward)) return;
  push_bounce(wavefront, wavefront.next, event.ray, from.position, direction, onward, Bounce::reflected);
  wavefront.next_paths.push_back(phase_value(ray.direction, direction, anisotropy), from, false, &around);
}

void shade_media(const RenderContext& context, Wavefront& wavefront) {
  for (const MediumEvent& event : wavefront.medium_events) {
    wavefront.radiance.add(event.ray, event.passage.emitted);
    add_to_layer(wavefront, event.ray, 0, event.passage.emitted);
    if (event.passage.scattered && wavefront.rays.bounces[event.ray] <= context.settings.depth)
      shade_scattering(context, wavefront, event);
  }
}

}  // namespace oktett
