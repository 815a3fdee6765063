#include "render/transport/penumbra.h"

#include <algorithm>
#include <span>

#include "accel/accel.h"
#include "render/transport/integrators.h"
#include "render/transport/shadow.h"

namespace oktett {
namespace {

/// What Wavefront::lamp_view holds of a ray's hit.
enum View : std::uint8_t { kSeesPoint = 1, kMissesPoint = 2, kBoth = 3, kListed = 4 };

/// Rays are traced when this many have gathered.
constexpr std::size_t kBatch = 4096;

std::span<ShadowQueue> lamp_queues(const RenderContext& context, Wavefront& wavefront) {
  return std::span(wavefront.shadows).subspan(context.lights.size(), context.area_lights.samples);
}

float share_of_pattern(const AreaLights& area) { return 1.0f / static_cast<float>(area.penumbra); }

/// Notes which points the owners of `queue` see.
void note_view(const ShadowQueue& queue, Column<std::uint8_t>& view) {
  for (std::size_t i = 0; i < queue.size(); ++i)
    view[queue.owner[i]] |= is_black(queue.light[i]) ? kMissesPoint : kSeesPoint;
}

void add_lamp_light(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue) {
  const float share = share_of_pattern(context.area_lights);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::uint32_t owner = queue.owner[i];
    std::uint8_t& view = wavefront.lamp_view[owner];
    Color light = queue.light[i];
    if (context.area_lights.penumbra > 1 && (view & kBoth) == kBoth) {
      if ((view & kListed) == 0) wavefront.penumbra.push_back(owner);
      view |= kListed;
      light = light * share;
    }
    if (!is_black(light)) add_arriving(context, wavefront, queue, i, light);
  }
}

void trace_penumbra_rays(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue) {
  const float share = share_of_pattern(context.area_lights);
  find_arriving(context, queue, ShadowRule::transparent_passes);
  for (std::size_t i = 0; i < queue.size(); ++i)
    if (const Color light = queue.light[i] * share; !is_black(light))
      add_arriving(context, wavefront, queue, i, light);
  count_shadow_rays(wavefront, queue.size());
  queue.clear();
}

}  // namespace

void start_penumbras(const RenderContext& context, Wavefront& wavefront) {
  if (context.area_lights.empty()) return;
  wavefront.lamp_view.resize_uninitialized(wavefront.rays.size());
  std::fill_n(wavefront.lamp_view.data(), wavefront.rays.size(), std::uint8_t{0});
  wavefront.penumbra.clear();
}

void flush_lamp_shadows(const RenderContext& context, Wavefront& wavefront) {
  const std::span<ShadowQueue> queues = lamp_queues(context, wavefront);
  for (ShadowQueue& queue : queues) {
    count_shadow_rays(wavefront, queue.size());
    if (queue.size() == 0) continue;
    find_arriving(context, queue, ShadowRule::transparent_passes);
    note_view(queue, wavefront.lamp_view);
  }
  for (ShadowQueue& queue : queues) {
    add_lamp_light(context, wavefront, queue);
    queue.clear();
  }
}

void shade_penumbras(const RenderContext& context, Wavefront& wavefront) {
  const std::span<const std::uint32_t> hits(wavefront.penumbra);
  const auto pattern = [&](std::uint32_t ray) { return pattern_of(wavefront, ray); };
  ShadowQueue& queue = wavefront.penumbra_shadows;
  InteractionBlock found;
  for (std::size_t first = 0, last; first < hits.size(); first = last) {
    for (last = first + 1; last < hits.size() && last < first + InteractionBlock::kMost &&
                           pattern(hits[last]) == pattern(hits[first]);)
      ++last;
    const std::span<const std::uint32_t> block = hits.subspan(first, last - first);
    surface_interactions(*context.world->accel, wavefront.rays.rays, wavefront.hits, block, found,
                         context.isa);
    queue_penumbra_rays(context, wavefront, block, found, queue);
    if (queue.size() >= kBatch) trace_penumbra_rays(context, wavefront, queue);
  }
  if (queue.size() > 0) trace_penumbra_rays(context, wavefront, queue);
}

}  // namespace oktett
