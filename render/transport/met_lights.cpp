#include "render/transport/met_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "render/hit_object.h"
#include "render/transport/integrators.h"
#include "render/transport/path.h"
#include "render/transport/path_block.h"
#include "render/transport/render_code.h"
#include "render/transport/shadow.h"

namespace oktett {
namespace {

/// Rays on their way from emitter to emitter.
struct EmitterWalks {
  RayBatch rays;
  std::vector<std::uint32_t> entry;  ///< of the wavefront's rays
  std::vector<float> before;         ///< length of the way before the ray's origin

  void push_back(const Ray& ray, std::uint32_t i, float length) {
    rays.push_back(ray), entry.push_back(i), before.push_back(length);
  }
};

/// Whether a light sample could have chosen what entry `ray` leads to.
bool competes(const Wavefront& wavefront, std::uint32_t ray) {
  return wavefront.paths.pdf[ray] > 0 && wavefront.paths.unsampled[ray] < kAllMet;
}

/// The part of the way to an emitter that a shadow ray goes, see kPlaceError.
float before_emitter(const Vec3f& place, float distance) {
  const float blur = kPlaceError * max_component(abs(place)) / distance;
  return 1 - std::max(std::min(blur, 0.5f), kLeastGap);
}

/// What entry `i` finds of the emitter number `emitter` whose surface it meets at `hit`, `distance` away.
void list_emitter(const RenderContext& context, Wavefront& wavefront, std::uint32_t i, const Ray& ray,
                  const Hit& hit, std::uint32_t emitter, float distance) {
  const PathColumns& paths = wavefront.paths;
  const SurfaceInteraction s = surface_interaction(*context.world->accel, ray, hit);
  const LightPoint& from = paths.from[i];
  if (!lights(*context.world, s.user, from.lists)) return;
  const Color emission =
      path_surface(shading_point(context, ray, hit, {wavefront.rays.distance[i], false}, s)).emission;
  if (is_black(emission)) return;
  const bool sampled = !(distance < paths.unsampled[i]);
  const float other = sampled ? context.sampled->set().pdf(from, emitter, ray.direction, distance) : 0;
  Ray shadow = wavefront.rays.rays[i];
  shadow.tmax = distance * before_emitter(s.position, distance);
  wavefront.met_lights.push_back(
      {i, emitter, shadow, wavefront.rays.throughput[i] * emission * power_weight(paths.pdf[i], other)});
}

void find_emitters(const RenderContext& context, Wavefront& wavefront) {
  const SceneLights& lights = *context.sampled;
  if (lights.emitter_surfaces() == nullptr) return;
  EmitterWalks walks, rest;
  for (std::uint32_t i = 0; i < wavefront.rays.size(); ++i)
    if (competes(wavefront, i)) walks.push_back(wavefront.rays.rays[i], i, 0);
  HitBatch hits;
  for (unsigned layer = 0; layer < kMostPassages && !walks.entry.empty(); ++layer) {
    hits.resize_uninitialized(walks.entry.size());
    closest_hit(*lights.emitter_surfaces(), walks.rays.span(), hits.span(), context.isa);
    rest = {};
    for (std::size_t k = 0; k < walks.entry.size(); ++k) {
      if (!hits[k].valid()) continue;
      const Ray ray = walks.rays[k];
      const float distance = walks.before[k] + hits.t[k];
      const Hit hit = lights.world_hit(hits[k]);
      if (const std::uint32_t emitter = lights.emitter_at(hit); emitter != kNoId)
        list_emitter(context, wavefront, walks.entry[k], ray, hit, emitter, distance);
      const SurfaceInteraction s = surface_interaction(*lights.emitter_surfaces(), ray, hits[k]);
      Ray behind = ray;
      behind.origin = offset_origin(s, ray.direction);
      rest.push_back(behind, walks.entry[k], distance);
    }
    std::swap(walks, rest);
  }
}

/// Environments, of up to 64 rays at once.
void find_environments(const RenderContext& context, Wavefront& wavefront) {
  const LightSet& set = context.sampled->set();
  if (set.visible().empty()) return;
  constexpr std::size_t kMost = EnvironmentValues::kMost;
  std::vector<std::uint32_t> which;
  for (std::uint32_t i = 0; i < wavefront.rays.size(); ++i)
    if (competes(wavefront, i)) which.push_back(i);
  for (std::size_t first = 0; first < which.size(); first += kMost) {
    const std::size_t count = std::min(kMost, which.size() - first);
    float direction[3][kMost] = {};
    LightPoint from[kMost];
    for (std::size_t k = 0; k < count; ++k) {
      from[k] = wavefront.paths.from[which[first + k]];
      InteractionBlock::put(direction, k, wavefront.rays.rays[which[first + k]].direction);
    }
    EnvironmentValues found;
    set.environment_values(render_code(context.isa).lights.map, count, from,
                           {direction[0], direction[1], direction[2]}, found);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = which[first + k];
      const Color light = wavefront.rays.throughput[i] * InteractionBlock::get(found.radiance, k) *
                          power_weight(wavefront.paths.pdf[i], found.pdf[k]);
      if (!is_black(light))
        wavefront.met_lights.push_back({i, set.visible().front(), wavefront.rays.rays[i], light});
    }
  }
}

}  // namespace

void find_met_lights(const RenderContext& context, Wavefront& wavefront) {
  wavefront.met_lights.clear();
  if (wavefront.level == 0) return;
  find_emitters(context, wavefront);
  find_environments(context, wavefront);
}

void add_met_lights(const RenderContext& context, Wavefront& wavefront) {
  std::vector<MetLight> left = std::move(wavefront.met_lights);
  wavefront.met_lights.clear();
  // A ray knows one emitter at a time, so those that it has met come one after the other.
  std::stable_sort(left.begin(), left.end(),
                   [](const MetLight& a, const MetLight& b) { return a.ray < b.ray; });
  ShadowQueue& queue = wavefront.shadows[kAreaQueue];
  while (!left.empty()) {
    std::vector<MetLight> later;
    for (const MetLight& met : left) {
      if (queue.size() > 0 && queue.owner[queue.size() - 1] == met.ray) {
        later.push_back(met);
        continue;
      }
      queue.push_back(met.shadow, met.ray, met.light);
      if (context.tracks_dielectrics) queue.dielectrics.push_back(wavefront.paths.dielectrics[met.ray]);
      if (context.light_groups != nullptr) wavefront.sampled_emitter[met.ray] = met.emitter;
    }
    flush_area_shadows(context, wavefront);
    left = std::move(later);
  }
}

}  // namespace oktett
