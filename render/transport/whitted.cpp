#include <algorithm>
#include <bit>

#include "accel/accel_data.h"
#include "core/math.h"
#include "render/specular.h"
#include "render/transport/direct_light.h"
#include "render/transport/integrators.h"
#include "render/transport/render_code.h"

namespace oktett {
namespace {

/// Limits the rays of a sample in one bounce, which mirrors and glass would double each time.
constexpr std::uint16_t kMostRaysPerLevel = 256;
/// The limit cannot be met below this bounce: a hit sends at most three rays, and 3^5 = 243.
constexpr unsigned kFirstLimitedLevel = 5;

/// Whether a ray of this throughput may be queued for the sample of entry `ray`. Counts it.
bool admit(Wavefront& wavefront, std::size_t ray, const Color& throughput) {
  if (max_component(throughput) < kLeastThroughput) return false;
  std::uint16_t& spawned = wavefront.samples.spawned[wavefront.rays.sample[ray]];
  if (spawned >= kMostRaysPerLevel) return false;
  ++spawned;
  return true;
}

/// Queues the ray that leaves `p` if it is worth it.
void push_admitted(Wavefront& wavefront, std::size_t ray, const ShadingPoint& p, const Vec3f& direction,
                   const Color& throughput, Bounce bounce) {
  if (!admit(wavefront, ray, throughput)) return;
  RayQueue& queue = bounce == Bounce::refracted ? wavefront.refracted : wavefront.next;
  push_bounce(wavefront, queue, ray, p, direction, throughput, bounce);
}

/// The part of the light that passes the interior of the solid that a ray leaves at `p` (Beer's law).
Color passing_interior(const RenderContext& context, const ShadingPoint& p) {
  const auto material = static_cast<std::size_t>(p.material - context.world->materials.data());
  if (p.front || context.interiors.empty()) return {1, 1, 1};
  const Vec3d depth = context.interiors[material] * static_cast<double>(p.t);
  return Color(Vec3d{portable::exp(-depth.x), portable::exp(-depth.y), portable::exp(-depth.z)});
}

/// Adds the light of a hit that needs no lamp. `throughput` includes the opacity of the surface.
void add_unlit(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
               const Color& throughput) {
  wavefront.radiance.add(ray, throughput * (p.emission + p.color * p.values.ambient * context.ambient_light));
}

/// Queues the rays that leave a hit: straight through holes, mirrored and refracted.
void push_bounces(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                  const ShadingPoint& p) {
  const Color arriving = wavefront.rays.throughput[ray], throughput = arriving * p.opacity;
  if (p.opacity < 1)
    push_admitted(wavefront, ray, p, p.direction, arriving * (1 - p.opacity), Bounce::straight);
  if (wavefront.rays.bounces[ray] >= context.settings.depth) return;
  const SpecularRays specular = specular_rays(p);
  if (!is_black(specular.mirror))
    push_admitted(wavefront, ray, p, specular.mirror_direction, throughput * specular.mirror,
                  Bounce::reflected);
  if (!is_black(specular.refracted))
    push_admitted(wavefront, ray, p, specular.refracted_direction, throughput * specular.refracted,
                  Bounce::refracted);
}

/// Names the rays and materials of the hits. The last is repeated to the end of its group of lanes.
void name_hits(const RenderContext& context, const std::uint32_t* which, const InteractionBlock& found,
               ShadingColumns& c) {
  for (std::size_t k = 0; k < c.count; ++k) {
    c.ray[k] = which[k];
    c.material[k] = material_index(*context.world, found.user[k], found.material_slot[k]);
  }
  for (std::size_t k = c.count; k % ShadingColumns::kGroup != 0; ++k)
    c.ray[k] = c.ray[c.count - 1], c.material[k] = c.material[c.count - 1];
}

ShadedRays shaded_rays(Wavefront& wavefront) {
  ShadedRays rays;
  for (int k = 0; k < 3; ++k) {
    rays.direction[k] = wavefront.rays.rays.direction[k].data();
    rays.throughput[k] = wavefront.rays.throughput.part[k].data();
    rays.radiance[k] = wavefront.radiance.part[k].data();
  }
  return rays;
}

/// Sets what varies over a surface, for hit `k`.
void put_varying(const ShadingPoint& p, const Color& throughput, std::size_t k, ShadingColumns& c) {
  InteractionBlock::put(c.throughput, k, throughput);
  InteractionBlock::put(c.color, k, p.color), InteractionBlock::put(c.specular_color, k, p.specular_color);
  InteractionBlock::put(c.ng, k, p.ng), InteractionBlock::put(c.ns, k, p.ns);
  c.diffuse[k] = p.values.diffuse, c.specular[k] = p.values.specular, c.phong[k] = p.values.phong;
  c.reflection[k] = p.values.reflection;
  c.exponent[k] = highlight_exponent(p.values.specular, p.values.phong);
}

/// What hit `k` needs beyond lanes: its textures, and the rays that leave it. Returns what the interior that
/// the ray comes through leaves of its light.
OKTETT_NOINLINE Color finish_alone(const RenderContext& context, Wavefront& wavefront,
                                   const SurfaceInteraction& found, std::size_t k, ShadingColumns& c) {
  const std::uint32_t i = c.ray[k];
  const bool from_camera = wavefront.rays.from_camera[i] != 0;
  const ShadingPoint p = shading_point(context, wavefront.rays.rays[i], wavefront.hits[i],
                                       {wavefront.rays.distance[i], from_camera}, found);
  if (from_camera) {
    record_first_hit(context, wavefront, i, {p.surface, p.color, p.opacity});
    cover(context, wavefront, i, p.opacity);
  }
  const Color left = passing_interior(context, p);
  if (context.materials[c.material[k]].varies) {
    const Color throughput = wavefront.rays.throughput[i] * p.opacity;
    add_unlit(context, wavefront, i, p, throughput * left);
    put_varying(p, throughput, k, c);
  }
  if (!(left == Color{1, 1, 1})) wavefront.rays.throughput.set(i, wavefront.rays.throughput[i] * left);
  push_bounces(context, wavefront, i, p);
  return left;
}

/// Adds hit `k`, on a material that does not vary, to alpha and the data layers if its ray is a camera ray.
void record_camera_hit(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                       std::size_t k, const ShadingColumns& c) {
  const std::uint32_t i = c.ray[k];
  if (!wavefront.rays.from_camera[i]) return;
  cover(context, wavefront, i, 1);
  if (!context.data_layers) return;
  record_first_hit(context, wavefront, i,
                   shown_surface(context, wavefront.rays.rays[i], wavefront.hits[i],
                                 {wavefront.rays.distance[i], true}, found[k]));
}

/// Takes out rays beyond the depth of the picture or the limit of rays per sample.
void limit_bounces(const RenderContext& context, Wavefront& wavefront, const ShadingColumns& c,
                   BounceColumns& mirrored, BounceColumns& refracted) {
  if (wavefront.level < std::min(context.settings.depth, kFirstLimitedLevel)) return;
  for (std::size_t k = 0; k < c.count; ++k) {
    const bool deep = wavefront.rays.bounces[c.ray[k]] >= context.settings.depth;
    std::uint16_t& spawned = wavefront.samples.spawned[wavefront.rays.sample[c.ray[k]]];
    for (BounceColumns* b : {&mirrored, &refracted}) {
      if ((b->sent >> k & 1) == 0) continue;
      if (deep || spawned >= kMostRaysPerLevel)
        b->sent &= ~(std::uint64_t{1} << k);
      else
        ++spawned;
    }
  }
}

void queue_bounces(const RenderContext& context, const Wavefront& wavefront, const ShadingColumns& c,
                   const BounceColumns& sent, RayQueue& queue) {
  if (sent.sent == 0) return;
  const std::size_t first = queue.size(), end = first + static_cast<std::size_t>(std::popcount(sent.sent));
  queue.resize_uninitialized(end + ShadingColumns::kGroup);
  QueuedRays to;
  for (int k = 0; k < 3; ++k) {
    to.origin[k] = queue.rays.origin[k].data() + first;
    to.direction[k] = queue.rays.direction[k].data() + first;
    to.throughput[k] = queue.throughput.part[k].data() + first;
  }
  to.tmin = queue.rays.tmin.data() + first, to.tmax = queue.rays.tmax.data() + first;
  to.distance = queue.distance.data() + first, to.sample = queue.sample.data() + first;
  to.bounces = queue.bounces.data() + first, to.from_camera = queue.from_camera.data() + first;
  const RayQueue& rays = wavefront.rays;
  render_code(context.isa)
      .queue_rays(sent, c.ray,
                  {rays.sample.data(), rays.distance.data(), wavefront.hits.t.data(), rays.bounces.data()},
                  to);
  queue.resize_uninitialized(end);
}

/// Queues the mirrored and refracted rays of hits on materials that do not vary, of which the columns know
/// all.
void push_bounces(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                  const ShadingColumns& c) {
  const auto deep = [&](std::uint32_t ray) { return wavefront.rays.bounces[ray] >= context.settings.depth; };
  if (std::all_of(c.ray, c.ray + c.count, deep)) return;
  BounceColumns mirrored, refracted;
  render_code(context.isa).bounce_rays(found, c, mirrored, refracted);
  limit_bounces(context, wavefront, c, mirrored, refracted);
  queue_bounces(context, wavefront, c, mirrored, wavefront.next);
  queue_bounces(context, wavefront, c, refracted, wavefront.refracted);
  wavefront.counts.reflected += static_cast<unsigned>(std::popcount(mirrored.sent));
  wavefront.counts.refracted += static_cast<unsigned>(std::popcount(refracted.sent));
}

/// Queues the rays to one light.
void push_shadow_rays(const RenderContext& context, const InteractionBlock& found, const LightSource& light,
                      const ShadingColumns& c, ShadowQueue& queue) {
  const std::size_t first = queue.size();
  queue.resize_uninitialized(first + c.count + ShadingColumns::kGroup);
  ShadowColumns out;
  for (int k = 0; k < 3; ++k) {
    out.origin[k] = queue.rays.origin[k].data() + first;
    out.direction[k] = queue.rays.direction[k].data() + first;
    out.light[k] = queue.light.part[k].data() + first;
  }
  out.owner = queue.owner.data() + first;
  const std::size_t count = render_code(context.isa).shadow_rays(found, light, c, out);
  const Ray like;
  std::fill_n(queue.rays.tmin.data() + first, count, like.tmin);
  std::fill_n(queue.rays.tmax.data() + first, count, light.directional ? like.tmax : kBeforeLight);
  queue.resize_uninitialized(first + count);
}

/// Which points of the area lights the hit of a ray asks.
std::uint32_t pattern_of(const RenderContext& context, const Wavefront& wavefront, std::size_t ray) {
  return context.area_lights.empty() ? 0 : oktett::pattern_of(wavefront, ray);
}

}  // namespace

void shade_whitted(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                   const ShadingPoint& p) {
  const Color left = passing_interior(context, p);
  if (!(left == Color{1, 1, 1})) wavefront.rays.throughput.set(ray, wavefront.rays.throughput[ray] * left);
  const Color throughput = wavefront.rays.throughput[ray] * p.opacity;
  add_unlit(context, wavefront, ray, p, throughput);
  add_direct_light(context, p, throughput, pattern_of(context, wavefront, ray),
                   static_cast<std::uint32_t>(ray), wavefront.shadows);
  push_bounces(context, wavefront, ray, p);
}

void shade_whitted_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                         std::size_t count, const InteractionBlock& found) {
  ShadingColumns c;
  c.count = count;
  name_hits(context, which, found, c);
  count_lanes(wavefront, count, render_code(context.isa).whitted_lanes);
  render_code(context.isa).begin_shading(found, context.materials.data(), shaded_rays(wavefront), c);
  const bool alone = c.varying != 0, sends = c.sending != 0;
  // The rays of a sample must be queued in the order of its hits: one by one if any of them is.
  if (!alone && sends) push_bounces(context, wavefront, found, c);
  const bool records = context.data_layers || !context.all_opaque;
  for (std::size_t k = 0; k < count && (alone || records); ++k) {
    if (!alone || ((c.varying | c.sending) >> k & 1) == 0) {
      record_camera_hit(context, wavefront, found, k, c);
      continue;
    }
    const Color left = finish_alone(context, wavefront, found[k], k, c);
    if (!(left == Color{1, 1, 1}))
      InteractionBlock::put(c.throughput, k, InteractionBlock::get(c.throughput, k) * left);
  }
  for (std::size_t n = 0; n < context.lights.size(); ++n)
    push_shadow_rays(context, found, context.lights[n], c, wavefront.shadows[n]);
  const AreaLights& area = context.area_lights;
  const LightSource* points = area.points.data() + area.samples * pattern_of(context, wavefront, which[0]);
  for (std::size_t n = 0; n < area.samples; ++n)
    push_shadow_rays(context, found, points[n], c, wavefront.shadows[context.lights.size() + n]);
}

void drop_dark_hits(const RenderContext& context, Wavefront& wavefront) {
  if (!context.some_only_send_rays || wavefront.level < context.settings.depth) return;
  const World& world = *context.world;
  const auto is_dark = [&](std::uint32_t ray) {
    // The object of a hit in an instance takes longer to find, so such hits are shaded.
    if (wavefront.hits.instance[ray] != kNoId || wavefront.rays.from_camera[ray]) return false;
    if (wavefront.rays.bounces[ray] < context.settings.depth) return false;
    const std::uint32_t user = world.accel->users[world.accel->geometry_of(wavefront.hits.item[ray])];
    if (user >= world.objects.size()) return false;
    // An object without a material of its own has one for each slot of its mesh.
    const std::uint32_t material = world.objects[user].material;
    return material < context.materials.size() && context.materials[material].only_sends_rays();
  };
  std::size_t left = 0;
  for (std::size_t i = 0; i < wavefront.hit_rays.size(); ++i) {
    const std::uint32_t ray = wavefront.hit_rays[i];
    wavefront.hit_rays[left] = ray;
    left += is_dark(ray) ? 0 : 1;
  }
  wavefront.hit_rays.resize_uninitialized(left);
}

void queue_penumbra_rays(const RenderContext& context, Wavefront& wavefront,
                         std::span<const std::uint32_t> which, const InteractionBlock& found,
                         ShadowQueue& queue) {
  const AreaLights& area = context.area_lights;
  const std::uint32_t own = pattern_of(context, wavefront, which[0]), begin = area.first_in_penumbra(own);
  const auto for_other_points = [&](auto&& visit) {
    for (std::uint32_t p = begin; p < begin + area.penumbra; ++p)
      for (std::uint32_t n = 0; n < area.samples && p != own; ++n) visit(area.points[p * area.samples + n]);
  };
  const auto point_at = [&](std::size_t k) {
    const std::uint32_t i = which[k];
    const bool from_camera = wavefront.rays.from_camera[i] != 0;
    return shading_point(context, wavefront.rays.rays[i], wavefront.hits[i],
                         {wavefront.rays.distance[i], from_camera}, found[k]);
  };
  if (!shades_in_blocks(context)) {
    for (std::size_t k = 0; k < which.size(); ++k) {
      const ShadingPoint p = point_at(k);
      const Color throughput = wavefront.rays.throughput[which[k]] * p.opacity;
      for_other_points([&](const LightSource& point) { add_light(p, throughput, point, which[k], queue); });
    }
    return;
  }
  ShadingColumns c;
  c.count = which.size();
  name_hits(context, which.data(), found, c);
  // Their light that needs no lamp has been added before.
  Color radiance[ShadingColumns::kMost];
  for (std::size_t k = 0; k < which.size(); ++k) radiance[k] = wavefront.radiance[which[k]];
  render_code(context.isa).begin_shading(found, context.materials.data(), shaded_rays(wavefront), c);
  for (std::size_t k = 0; k < which.size(); ++k) {
    wavefront.radiance.set(which[k], radiance[k]);
    if (!context.materials[c.material[k]].varies) continue;
    const ShadingPoint p = point_at(k);
    put_varying(p, wavefront.rays.throughput[which[k]] * p.opacity, k, c);
  }
  for_other_points([&](const LightSource& point) { push_shadow_rays(context, found, point, c, queue); });
}

}  // namespace oktett
