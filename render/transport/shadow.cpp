#include "render/transport/shadow.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "accel/accel.h"
#include "render/shading_point.h"
#include "render/transport/grouped_light.h"
#include "render/transport/render_code.h"

namespace oktett {

Ray continue_behind(const Ray& ray, const SurfaceInteraction& s) {
  Ray rest = ray;
  rest.origin = offset_origin(s, ray.direction);
  if (ray.tmax < std::numeric_limits<float>::infinity()) {
    rest.direction = ray.origin + ray.direction * ray.tmax - rest.origin;
    rest.tmax = 1 - 0x1p-24f;
    // The surface may be so close to the end of the ray that the offset moves past the end.
    if (!(dot(rest.direction, ray.direction) > 0)) rest.tmax = 0;
  }
  return rest;
}

/// Looks at what the rays of `p.left` have met: how much light passes there, and which rays go on behind it.
static void look_at_surfaces(const RenderContext& context, const RaySpan& rays, ShadowRule rule,
                             PassingRays& p) {
  p.kept.clear();
  for (std::uint32_t k = 0; k < p.left.size(); ++k) {
    const Hit hit = p.hits[k];
    if (!hit.valid()) continue;
    Color& light = p.passed[p.left[k]];
    // Most materials are opaque, and the names are enough to find the material.
    const SurfaceInteraction names = identify(*context.world->accel, hit);
    const bool opaque = is_opaque(material_at(*context.world, names), rule);
    light = opaque ? Color{0, 0, 0} : light * transmittance(context, rays[k], hit, names, rule);
    if (!is_black(light)) p.kept.push_back(k);
  }
}

/// Sets `p.behind` to the parts of the rays of `p.kept` behind what they have met, and `p.left` to their
/// numbers.
static void go_behind_surfaces(const RenderContext& context, const RaySpan& rays, PassingRays& p) {
  InteractionBlock surfaces;
  p.behind.resize_uninitialized(p.kept.size());
  for (std::size_t first = 0; first < p.kept.size(); first += InteractionBlock::kMost) {
    const std::size_t count = std::min(InteractionBlock::kMost, p.kept.size() - first);
    surface_interactions(*context.world->accel, rays, p.hits, std::span(p.kept).subspan(first, count),
                         surfaces, context.isa);
    for (std::size_t k = first; k < first + count; ++k) {
      p.behind.set(k, continue_behind(rays[p.kept[k]], surfaces[k - first]));
      p.left[k] = p.left[p.kept[k]];
    }
  }
  p.left.resize(p.kept.size());
}

void add_arriving(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue,
                  std::size_t entry, const Color& light) {
  wavefront.radiance.add(queue.owner[entry], light);
  if (context.light_groups != nullptr) add_shadow_to_layers(context, wavefront, queue, entry, light);
}

/// Multiplies the light of each ray by what the surfaces in its way leave of it.
static void pass_surfaces(const RenderContext& context, ShadowQueue& queue, ShadowRule rule) {
  PassingRays& p = queue.passing;
  p.passed.assign(queue.size(), {1, 1, 1});
  p.left.resize(queue.size());
  std::iota(p.left.begin(), p.left.end(), 0u);
  RaySpan rays = queue.rays;
  for (unsigned layer = 0; layer < kMostPassages && !p.left.empty(); ++layer) {
    p.hits.resize_uninitialized(p.left.size());
    closest_hit(*context.world->accel, rays, p.hits.span(), context.isa);
    look_at_surfaces(context, rays, rule, p);
    go_behind_surfaces(context, rays, p);
    std::swap(p.rays, p.behind);
    rays = p.rays;
  }
  for (const std::uint32_t i : p.left) p.passed[i] = {0, 0, 0};
  for (std::size_t i = 0; i < queue.size(); ++i)
    queue.light.set(i, is_black(p.passed[i]) ? Color{0, 0, 0} : queue.light[i] * p.passed[i]);
}

void find_arriving(const RenderContext& context, ShadowQueue& queue, ShadowRule rule) {
  const World& world = *context.world;
  // Where light may pass, the nearest surface is looked for at once: most blocked rays need to know it.
  if (world.has_holes || (world.has_clear && rule == ShadowRule::transparent_passes))
    return pass_surfaces(context, queue, rule);
  queue.occluded.resize_uninitialized(queue.size());
  any_hit(*world.accel, queue.rays, queue.occluded, context.isa);
  render_code(context.isa).block_light(queue.occluded, queue.light);
}

void trace_shadows(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue, ShadowRule rule) {
  if (queue.size() == 0) return;
  find_arriving(context, queue, rule);
  render_code(context.isa).add_colors(queue.light, queue.owner, wavefront.radiance);
  if (context.light_groups == nullptr) return;
  for (std::size_t i = 0; i < queue.size(); ++i)
    if (!is_black(queue.light[i])) add_shadow_to_layers(context, wavefront, queue, i, queue.light[i]);
}

}  // namespace oktett
