#include "render/transport/veils.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "core/lanes.h"
#include "render/shading_lanes.h"
#include "render/transport/light_rays.h"
#include "render/transport/medium_march.h"

namespace oktett {
namespace {

using VeilFloat = Simd<float, 1, ScalarIsa>;

/// Light of a lamp at a place, if nothing is in its way.
struct LampLight {
  Vec3f towards;  ///< unit vector
  Vec3f target;   ///< its place, or a direction
  Color color;    ///< as of a surface that faces it
};

LampLight lamp_light(const LightSource& light, const Vec3f& place) {
  LampLight lit{light.place, light.place, light.color};
  if (light.directional) return lit;
  Vec3<VeilFloat> l;
  const auto square = turn_to_light(light.place, broadcast<VeilFloat>(place), l);
  lit.towards = only_lane(l);
  if (light.falloff) lit.color = lit.color * only_lane(falloff(square));
  if (light.spot) {
    const VeilFloat cosine = -dot_lanes(l, broadcast<VeilFloat>(light.axis));
    lit.color = lit.color * only_lane(spot_share(cosine, light.cos_inner, light.cos_outer));
  }
  if (light.profile.profile != nullptr) lit.color = lit.color * light.profile(-Vec3d(lit.towards));
  return lit;
}

/// What fills one way of a ray.
class FilledWay {
 public:
  FilledWay(const RenderContext& context, Wavefront& wavefront, std::uint32_t ray, double length)
      : context_(context), wavefront_(wavefront), ray_(ray) {
    const Ray r = wavefront.rays.rays[ray];
    way_ = {Vec3d(r.origin), normalize(Vec3d(r.direction)), length};
  }

  Veil veil() {
    const Insides& insides = wavefront_.rays.insides[ray_];
    Veil all;
    const bool open = insides.is_open();
    if (open) {
      // Fog lies before bows.
      all = pass_fogs(context_.fogs, way_.origin, way_.direction, way_.length);
      if (!context_.rainbows.empty()) {
        const Veil bows = pass_rainbows(context_.rainbows, way_.direction, way_.length);
        all.light = all.light + bows.light * all.left, all.left = all.left * bows.left;
      }
    }
    const auto add = [&](std::uint32_t number) {
      if (number >= context_.marched.size()) return;
      const Medium& medium = context_.marched[number];
      const Color before = all.left;
      const Veil veil = march_medium(context_, medium, way_, [&](const Vec3d& place, const Color& part) {
        scatter(medium, place, part * before);
      });
      all.light = all.light + veil.light * before;
      all.left = all.left * veil.left;
    };
    insides.for_each_medium(add);
    if (open && context_.outer_medium != kNoId) add(context_.outer_medium);
    return all;
  }

 private:
  void scatter(const Medium& medium, const Vec3d& place, const Color& part) {
    const Color arriving = wavefront_.rays.throughput[ray_] * part;
    const Vec3f origin(place);
    for (std::size_t n = 0; n < context_.lights.size(); ++n) {
      const LightSource& light = context_.lights[n];
      const LampLight lit = lamp_light(light, origin);
      const double phase = phase_of(medium, -Vec3d(lit.towards), way_.direction);
      const Color scattered = arriving * lit.color * static_cast<float>(phase * std::numbers::pi);
      if (max_component(scattered) == 0) continue;
      ShadowQueue& queue = wavefront_.shadows[n];
      const std::size_t first = queue.size();
      Ray ray;
      ray.origin = origin, ray.direction = light.directional ? lit.target : lit.target - origin;
      queue.push_back(ray, ray_, scattered);
      finish_light_rays(light, context_.fogs, first, queue);
    }
  }

  const RenderContext& context_;
  Wavefront& wavefront_;
  const std::uint32_t ray_;
  MediumWay way_;
};

}  // namespace

void veil_misses(const RenderContext& context, Wavefront& wavefront) {
  for (std::uint32_t i = 0; i < wavefront.rays.size(); ++i) {
    if (wavefront.hits.item[i] != kNoId) continue;
    const Veil veil = FilledWay(context, wavefront, i, std::numeric_limits<double>::infinity()).veil();
    wavefront.radiance.set(i, wavefront.radiance[i] * veil.left + wavefront.rays.throughput[i] * veil.light);
  }
}

void veil_hits(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
               std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = which[k];
    const Veil veil = FilledWay(context, wavefront, i, double{wavefront.hits.t[i]}).veil();
    const Color arriving = wavefront.rays.throughput[i], left = arriving * veil.left;
    wavefront.radiance.add(i, arriving * veil.light);
    wavefront.rays.throughput.set(i, left);
    // What fills the way covers what is behind it.
    if (!context.all_opaque && wavefront.rays.from_camera[i] != 0)
      wavefront.samples.alpha[wavefront.rays.sample[i]] +=
          std::max(0.0f, channel_mean(arriving) - channel_mean(left));
  }
}

Insides insides_behind(const RenderContext& context, const Wavefront& wavefront, std::uint32_t ray,
                       const InteractionBlock& found, std::size_t k) {
  Insides insides = wavefront.rays.insides[ray];
  const std::uint16_t entry =
      inside_of(*context.world, wavefront.hits[ray], found.user[k], found.material_slot[k]);
  if (entry == 0) return insides;
  const Vec3f normal = InteractionBlock::get(found.geometric_normal, k);
  if (dot(wavefront.rays.rays[ray].direction, normal) > 0)
    insides.leave(entry);
  else
    insides.enter(entry);
  return insides;
}

}  // namespace oktett
