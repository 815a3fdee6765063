#include "render/transport/shadow.h"

#include <span>
#include <vector>

#include "accel/accel.h"
#include "render/shading_point.h"
#include "render/transport/grouped_light.h"

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

/// Follows the rays numbered in `left` through transparent surfaces; `passed` holds the fraction of light for
/// each ray.
static void follow_through(const RenderContext& context, const ShadowQueue& queue, ShadowRule rule,
                           std::vector<std::uint32_t> left, std::vector<Color>& passed) {
  const Accel& accel = *context.world->accel;
  RayBatch rays, rest;
  for (const std::uint32_t i : left) rays.push_back(queue.rays[i]);
  HitBatch hits;
  std::vector<std::uint32_t> kept;  // of `left`
  InteractionBlock behind;
  for (int layer = 0; layer < kMostShadowLayers && !left.empty(); ++layer) {
    hits.resize_uninitialized(rays.size());
    closest_hit(accel, rays.span(), hits.span(), context.isa);
    kept.clear();
    for (std::uint32_t k = 0; k < left.size(); ++k) {
      const Hit hit = hits[k];
      if (!hit.valid()) continue;
      Color& light = passed[left[k]];
      // Most materials are opaque, and the names are enough to find the material.
      const SurfaceInteraction names = identify(accel, hit);
      const bool opaque = is_opaque(material_at(*context.world, names), rule);
      light = opaque ? Color{0, 0, 0} : light * transmittance(context, rays[k], hit, names, rule);
      if (!is_black(light)) kept.push_back(k);
    }
    rest.resize_uninitialized(0);
    for (std::size_t first = 0; first < kept.size(); first += InteractionBlock::kMost) {
      const std::size_t count = std::min(InteractionBlock::kMost, kept.size() - first);
      surface_interactions(accel, rays, hits, std::span(kept).subspan(first, count), behind, context.isa);
      for (std::size_t k = 0; k < count; ++k) {
        rest.push_back(continue_behind(rays[kept[first + k]], behind[k]));
        left[first + k] = left[kept[first + k]];
      }
    }
    left.resize(kept.size());
    std::swap(rays, rest);
  }
  for (const std::uint32_t i : left) passed[i] = {0, 0, 0};
}

void add_arriving(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue,
                  std::size_t entry, const Color& light) {
  wavefront.radiance.add(queue.owner[entry], light);
  if (context.light_groups != nullptr) add_shadow_to_layers(context, wavefront, queue, entry, light);
}

/// Multiplies the light of the blocked rays by what the surfaces in their way leave of it.
static void pass_surfaces(const RenderContext& context, ShadowQueue& queue, ShadowRule rule) {
  std::vector<Color> passed(queue.size(), {1, 1, 1});
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < queue.size(); ++i)
    if (queue.occluded[i]) left.push_back(i);
  follow_through(context, queue, rule, left, passed);
  for (const std::uint32_t i : left)
    queue.light.set(i, is_black(passed[i]) ? Color{0, 0, 0} : queue.light[i] * passed[i]);
}

void find_arriving(const RenderContext& context, ShadowQueue& queue, ShadowRule rule) {
  queue.occluded.resize_uninitialized(queue.size());
  any_hit(*context.world->accel, queue.rays, queue.occluded, context.isa);
  if (context.world->see_through) return pass_surfaces(context, queue, rule);
  for (std::size_t i = 0; i < queue.size(); ++i)
    if (queue.occluded[i]) queue.light.set(i, {0, 0, 0});
}

void trace_shadows(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue, ShadowRule rule) {
  if (queue.size() == 0) return;
  find_arriving(context, queue, rule);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Color light = queue.light[i];
    if (!is_black(light)) add_arriving(context, wavefront, queue, i, light);
  }
}

}  // namespace oktett
