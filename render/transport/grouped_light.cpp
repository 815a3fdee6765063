#include "render/transport/grouped_light.h"

#include <algorithm>

#include "render/light_groups.h"
#include "render/shading_point.h"

namespace oktett {
namespace {

/// Adds `light`, which comes from the unit vector `direction`, to the groups of infinite emitters by what
/// each of them gives. `total` is the radiance of all of them.
void add_shares(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const Vec3f& direction,
                const Color& total, const Color& light) {
  const LightSet& set = context.sampled->set();
  for (const std::uint32_t number : set.visible()) {
    const Color part = infinite_radiance(set.emitters()[number], direction);
    Color share;
    for (int k = 0; k < 3; ++k)
      if (part[k] != 0) share[k] = light[k] * (part[k] / total[k]);
    add_to_layer(wavefront, ray, context.sampled->group(number), share);
  }
}

void add_infinite(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const Vec3f& direction,
                  const Color& total, const Color& light) {
  if (const auto group = context.sampled->environment_group())
    return add_to_layer(wavefront, ray, *group, light);
  add_shares(context, wavefront, ray, direction, total, light);
}

}  // namespace

void start_layers(const RenderContext& context, Wavefront& wavefront) {
  if (context.light_groups == nullptr) return;
  wavefront.samples.grouped.resize(context.light_groups->names.size());
  const std::size_t count = wavefront.samples.size();
  for (ColorColumn& layer : wavefront.samples.grouped)
    layer.resize_uninitialized(count), layer.fill(count, {0, 0, 0});
}

void add_emission_to_layer(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                           std::uint32_t material, const Color& light) {
  if (context.light_groups == nullptr) return;
  add_to_layer(wavefront, ray, context.light_groups->material(material), light);
}

void add_shadow_to_layers(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue,
                          std::size_t entry, const Color& light) {
  const std::uint32_t ray = queue.owner[entry], number = wavefront.sampled_emitter[ray];
  const std::vector<std::uint32_t>& visible = context.sampled->set().visible();
  const bool overlaps = visible.size() > 1 && std::binary_search(visible.begin(), visible.end(), number);
  if (!overlaps) return add_to_layer(wavefront, ray, context.sampled->group(number), light);
  // A sample of one of them has the light of all.
  const Vec3f direction = queue.rays[entry].direction;
  add_infinite(context, wavefront, ray, direction, context.sampled->set().environment_radiance(direction),
               light);
}

void add_environment_to_layers(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                               const Color& environment, float weight) {
  const Color throughput = wavefront.rays.throughput[ray];
  const Vec3f direction = wavefront.rays.rays[ray].direction;
  add_to_layer(wavefront, ray, 0, throughput * background_color(context, direction));
  add_infinite(context, wavefront, ray, direction, environment, throughput * (environment * weight));
}

}  // namespace oktett
