#include <algorithm>
#include <bit>
#include <iterator>

#include "accel/accel.h"
#include "accel/accel_data.h"
#include "core/math.h"
#include "core/random.h"
#include "render/angle_colors.h"
#include "render/hit_object.h"
#include "render/light/light_share.h"
#include "render/shading_lanes.h"
#include "render/transport/integrators.h"
#include "render/transport/light_rays.h"
#include "render/transport/render_code.h"
#include "render/transport/veils.h"

namespace oktett {
namespace {

/// Limits the rays of a sample in one bounce, which mirrors and glass would double each time.
constexpr std::uint16_t kMostRaysPerLevel = 256;
/// The limit cannot be met below this bounce: a hit sends at most three rays, and 3^5 = 243.
constexpr unsigned kFirstLimitedLevel = 5;

/// Adds the light of a hit that needs no emitter. `throughput` includes the opacity of the surface.
void add_unlit(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
               const Color& throughput) {
  wavefront.radiance.add(ray, throughput * (p.emission + p.color * p.values.ambient * context.ambient_light));
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

/// Between the normal and the direction back along the ray.
double arriving_cosine(const ShadingPoint& p) { return -dot(Vec3d(p.direction), Vec3d(p.ns)); }

/// The colour of light that is mirrored.
Color mirror_color(const ShadingPoint& p) {
  Color color = p.reflection_color.value_or(p.specular_color);
  if (p.material->reflection_fades && !p.material->principled)
    color = faded(color, metal_fade(arriving_cosine(p)));
  return color;
}

/// A number in [0, 1) that looks random, and is the same wherever a ray meets this place.
float random_of_place(const Vec3f& place) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) key = mix_bits(key + std::bit_cast<std::uint32_t>(place[k]) + kGoldenBits);
  return static_cast<float>(key >> 40) * 0x1p-24f;
}

/// The colour of light that passes.
Color passing_color(const ShadingPoint& p) {
  const Color filter = p.filter.value_or(p.color);
  if (!p.material->conserve_energy || p.material->principled) return filter;
  Color left;
  for (int k = 0; k < 3; ++k)
    left[k] = filter[k] * std::max(0.0f, 1 - mirror_color(p)[k] * p.values.reflection);
  return left;
}

/// Sets what varies over a surface, for hit `k`.
void put_varying(const ShadingPoint& p, const Color& throughput, std::size_t k, ShadingColumns& c) {
  InteractionBlock::put(c.throughput, k, throughput);
  InteractionBlock::put(c.color, k, p.color);
  InteractionBlock::put(c.specular_color, k, p.specular_color);
  InteractionBlock::put(c.filter, k, passing_color(p));
  InteractionBlock::put(c.ng, k, p.ng);
  InteractionBlock::put(c.ns, k, p.ns);
  Color mirrored = mirror_color(p);
  if (p.values.brilliance != 1 || p.values.grain != 0) {
    c.uneven |= std::uint64_t{1} << k;
    c.brilliance[k] = p.values.brilliance;
    c.grain[k] = p.values.grain != 0 ? p.values.grain * random_of_place(p.surface.position) : 0;
  }
  if (p.values.specular_blinn != 0) {
    c.blinned |= std::uint64_t{1} << k;
    c.specular_blinn[k] = p.values.specular_blinn, c.blinn[k] = p.values.blinn;
  }
  if (p.values.diffuse_back != 0) {
    c.lit_behind |= std::uint64_t{1} << k;
    c.diffuse_back[k] = p.values.diffuse_back;
  }
  if (p.values.film != 0) {
    c.filmed |= std::uint64_t{1} << k;
    c.film[k] = p.values.film, c.film_thickness[k] = p.values.film_thickness;
    mirrored = mirrored * film_color(p.values.film, p.values.film_thickness, 2 * arriving_cosine(p));
  }
  InteractionBlock::put(c.mirror_color, k, mirrored);
  if (p.material->specular_fades && !p.material->principled) c.fading |= std::uint64_t{1} << k;
  c.diffuse[k] = p.values.diffuse;
  c.specular[k] = p.values.specular;
  c.phong[k] = p.values.phong;
  c.exponent[k] = highlight_exponent(p.values.specular, p.values.phong);
  c.reflection[k] = p.values.reflection;
  c.transparency[k] = p.values.transparency;
  c.eta[k] = p.front ? p.ior : 1 / p.ior;
  if (!p.material->fresnel && !p.material->principled) c.unsplit |= std::uint64_t{1} << k;
  // A texture may make a mirror of what is none elsewhere.
  if (p.values.reflection != 0 || p.values.transparency != 0) c.sending |= std::uint64_t{1} << k;
}

/// Finishes the columns of hit `k`, whose material varies, and adds its light that needs no emitter. Returns
/// the light that passes straight through holes.
OKTETT_NOINLINE Color finish_varying(const RenderContext& context, Wavefront& wavefront,
                                     const SurfaceInteraction& found, std::size_t k, ShadingColumns& c) {
  const std::uint32_t i = c.ray[k];
  const bool from_camera = wavefront.rays.from_camera[i] != 0;
  const ShadingPoint p = shading_point(context, wavefront.rays.rays[i], wavefront.hits[i],
                                       {wavefront.rays.distance[i], from_camera}, found);
  if (from_camera) {
    record_first_hit(context, wavefront, i, shown_surface(p));
    cover(context, wavefront, i, p.opacity);
  }
  const Color arriving = wavefront.rays.throughput[i], throughput = arriving * p.opacity;
  add_unlit(context, wavefront, i, p, throughput);
  put_varying(p, throughput, k, c);
  return p.opacity < 1 ? arriving * (1 - p.opacity) : Color{0, 0, 0};
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

/// Whether one more ray may be queued for the sample of entry `ray`. Counts it.
bool admit(Wavefront& wavefront, std::size_t ray) {
  std::uint16_t& spawned = wavefront.samples.spawned[wavefront.rays.sample[ray]];
  if (spawned >= kMostRaysPerLevel) return false;
  ++spawned;
  return true;
}

/// Takes out rays beyond the depth of the picture or the limit of rays per sample.
void limit_bounces(const RenderContext& context, Wavefront& wavefront, const ShadingColumns& c,
                   BounceColumns& mirrored, BounceColumns& refracted) {
  if (wavefront.level < std::min(context.settings.depth, kFirstLimitedLevel)) return;
  for (std::size_t k = 0; k < c.count; ++k) {
    const bool deep = wavefront.rays.bounces[c.ray[k]] >= context.settings.depth;
    for (BounceColumns* b : {&mirrored, &refracted})
      if ((b->sent >> k & 1) != 0 && (deep || !admit(wavefront, c.ray[k])))
        b->sent &= ~(std::uint64_t{1} << k);
  }
}

void queue_bounces(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                   const ShadingColumns& c, const BounceColumns& sent, RayKind kind, RayQueue& queue) {
  if (sent.sent == 0) return;
  const std::size_t first = queue.size();
  OnwardColumns to = end_of(queue, static_cast<std::size_t>(std::popcount(sent.sent)));
  render_code(context.isa).queue_rays(sent, c.ray, arriving_rays(wavefront), to);
  queue.resize_uninitialized(to.size);
  finish_rays(queue, first);
  if (context.bounces_differ) std::fill_n(queue.kind.data() + first, queue.size() - first, kind);
  if (!context.tracks_insides) return;
  std::size_t next = first;
  for (std::uint64_t left = sent.sent; left != 0; left &= left - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(left));
    queue.insides[next++] = kind == RayKind::transmission
                                ? insides_behind(context, wavefront, c.ray[k], found, k)
                                : wavefront.rays.insides[c.ray[k]];
  }
}

/// Bit k: what passes hit k goes on as it came, and counts as no bounce.
std::uint64_t unbent_hits(const ShadingColumns& c) {
  std::uint64_t all = 0;
  for (std::size_t k = 0; k < c.count && c.sending != 0; ++k)
    all |= std::uint64_t{c.transparency[k] != 0 && c.eta[k] == 1} << k;
  return all & c.sending;
}

/// Queues the rays that leave holes, mirrors and glass one by one, as those of a sample follow the order of
/// its hits. `straight`: the light that passes holes; null if there are none. `unbent`: see unbent_hits.
void queue_in_order(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                    const ShadingColumns& c, const Color* straight, std::uint64_t unbent,
                    const BounceColumns& mirrored, const BounceColumns& refracted) {
  for (std::size_t k = 0; k < c.count; ++k) {
    const std::uint32_t i = c.ray[k];
    if (straight != nullptr && max_component(straight[k]) >= c.cutoff && admit(wavefront, i)) {
      const Vec3f direction = InteractionBlock::get(c.direction, k);
      push_bounce(wavefront, wavefront.next, i, offset_origin(found[k], direction), direction, straight[k],
                  Bounce::straight);
      if (context.tracks_insides)
        wavefront.next.insides.back() = insides_behind(context, wavefront, i, found, k);
    }
    const bool deep = wavefront.rays.bounces[i] >= context.settings.depth, is_unbent = (unbent >> k & 1) != 0;
    const auto push = [&](const BounceColumns& sent, RayQueue& queue, Bounce bounce) {
      if ((sent.sent >> k & 1) == 0 || !admit(wavefront, i)) return;
      push_bounce(wavefront, queue, i, InteractionBlock::get(sent.origin, k),
                  InteractionBlock::get(sent.direction, k), InteractionBlock::get(sent.throughput, k),
                  bounce);
      if (context.tracks_insides && bounce != Bounce::reflected)
        queue.insides.back() = insides_behind(context, wavefront, i, found, k);
    };
    if (!deep) push(mirrored, wavefront.next, Bounce::reflected);
    if (is_unbent)
      push(refracted, wavefront.refracted, Bounce::unbent);
    else if (!deep)
      push(refracted, wavefront.refracted, Bounce::refracted);
  }
}

/// Queues the rays that leave the hits of a block. `straight` is null if there are no holes.
void push_bounces(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                  const ShadingColumns& c, const Color* straight) {
  const auto deep = [&](std::uint32_t ray) { return wavefront.rays.bounces[ray] >= context.settings.depth; };
  const std::uint64_t unbent = unbent_hits(c);
  const bool sends = unbent != 0 || (c.sending != 0 && !std::all_of(c.ray, c.ray + c.count, deep));
  BounceColumns mirrored, refracted;
  if (sends) render_code(context.isa).bounce_rays(found, c, mirrored, refracted);
  if (straight != nullptr || unbent != 0)
    return queue_in_order(context, wavefront, found, c, straight, unbent, mirrored, refracted);
  if (!sends) return;
  limit_bounces(context, wavefront, c, mirrored, refracted);
  queue_bounces(context, wavefront, found, c, mirrored, RayKind::glossy, wavefront.next);
  queue_bounces(context, wavefront, found, c, refracted, RayKind::transmission, wavefront.refracted);
  wavefront.counts.reflected += static_cast<unsigned>(std::popcount(mirrored.sent));
  wavefront.counts.refracted += static_cast<unsigned>(std::popcount(refracted.sent));
}

/// Takes out the rays from `first` on whose hits a light of this list does not light.
void keep_listed(const RenderContext& context, const Wavefront& wavefront, const InteractionBlock& found,
                 std::uint8_t list, const ShadingColumns& c, std::size_t first, ShadowQueue& queue) {
  std::size_t left = first, k = 0;
  for (std::size_t i = first; i < queue.size(); ++i) {
    const std::uint32_t owner = queue.owner[i];
    while (c.ray[k] != owner) ++k;
    if ((light_lists_at(*context.world, wavefront.hits[owner], found.user[k]) >> list & 1) == 0) continue;
    queue.set(left++, queue.rays[i], owner, queue.light[i]);
  }
  queue.resize_uninitialized(left);
}

/// Hits without highlights.
ShadingColumns dull(const ShadingColumns& c) {
  ShadingColumns without = c;
  std::fill(std::begin(without.specular), std::end(without.specular), 0.0f);
  without.blinned = 0;
  return without;
}

/// Queues the rays to one light.
void push_shadow_rays(const RenderContext& context, const Wavefront& wavefront, const InteractionBlock& found,
                      const LightSource& light, const ShadingColumns& c, ShadowQueue& queue) {
  const std::size_t first = queue.size();
  ShadowColumns out = end_of(queue, c.count);
  if (light.highlights)
    render_code(context.isa).shadow_rays(found, light, c, out);
  else
    render_code(context.isa).shadow_rays(found, light, dull(c), out);
  queue.resize_uninitialized(out.size);
  if (light.list != kNoLightList) {
    keep_listed(context, wavefront, found, light.list, c, first, queue);
    out.size = queue.size();
  }
  finish_light_rays(light, context.fogs, first, queue);
}

/// Which points of the area lights the hit of a ray asks.
std::uint32_t pattern_of(const RenderContext& context, const Wavefront& wavefront, std::size_t ray) {
  return context.area_lights.empty() ? 0 : oktett::pattern_of(wavefront, ray);
}

}  // namespace

void shade_whitted_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                         std::size_t count, const InteractionBlock& found) {
  if (context.tracks_insides) veil_hits(context, wavefront, which, count);
  ShadingColumns c;
  RaisedPoints raised = raised_points(context, wavefront, which, found);
  c.count = count, c.raised = &raised, c.cutoff = static_cast<float>(context.settings.cutoff);
  name_hits(context, which, found, c);
  count_lanes(wavefront, count, render_code(context.isa).whitted_lanes);
  render_code(context.isa).begin_shading(found, context.materials.data(), arriving_rays(wavefront), c);
  const bool records = context.data_layers || !context.all_opaque;
  Color straight[ShadingColumns::kMost];
  bool has_holes = false;
  for (std::size_t k = 0; k < count && (c.varying != 0 || records); ++k) {
    const bool varies = c.varying >> k & 1;
    straight[k] = varies ? finish_varying(context, wavefront, found[k], k, c) : Color{0, 0, 0};
    if (!varies) record_camera_hit(context, wavefront, found, k, c);
    has_holes = has_holes || !is_black(straight[k]);
  }
  push_bounces(context, wavefront, found, c, has_holes ? straight : nullptr);
  for (std::size_t n = 0; n < context.lights.size(); ++n)
    push_shadow_rays(context, wavefront, found, context.lights[n], c, wavefront.shadows[n]);
  const AreaLights& area = context.area_lights;
  const LightSource* points = area.points.data() + area.samples * pattern_of(context, wavefront, which[0]);
  for (std::size_t n = 0; n < area.samples; ++n)
    push_shadow_rays(context, wavefront, found, points[n], c, wavefront.shadows[context.lights.size() + n]);
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
    return material < context.materials.size() && context.materials[material].only_sends_rays() &&
           !context.materials[material].passes_unbent();
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
  ShadingColumns c;
  RaisedPoints raised = raised_points(context, wavefront, which.data(), found);
  c.count = which.size(), c.raised = &raised;
  name_hits(context, which.data(), found, c);
  // Their light that needs no emitter has been added before.
  Color radiance[ShadingColumns::kMost];
  for (std::size_t k = 0; k < which.size(); ++k) radiance[k] = wavefront.radiance[which[k]];
  render_code(context.isa).begin_shading(found, context.materials.data(), arriving_rays(wavefront), c);
  for (std::size_t k = 0; k < which.size(); ++k) {
    wavefront.radiance.set(which[k], radiance[k]);
    if (!context.materials[c.material[k]].varies) continue;
    const ShadingPoint p = point_at(k);
    put_varying(p, wavefront.rays.throughput[which[k]] * p.opacity, k, c);
  }
  for_other_points(
      [&](const LightSource& point) { push_shadow_rays(context, wavefront, found, point, c, queue); });
}

}  // namespace oktett
