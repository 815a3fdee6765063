#include "render/transport/light_rays.h"

#include <algorithm>
#include <limits>

#include "render/light/light_share.h"
#include "render/shading_lanes.h"

namespace oktett {

/// Takes from the light of the rays from `first` on what its distance and its angle to the axis of the light
/// cost.
static void fade_light(const LightSource& light, std::size_t first, ShadowQueue& queue) {
  for (std::size_t i = first; i < queue.size(); ++i) {
    const Vec3d way(queue.rays[i].direction);
    const double distance = length(way);
    const float left = faded_share(light.fade, distance) *
                       tight_share(-dot(way, Vec3d(light.axis)) / distance, light.tightness);
    queue.light.set(i, queue.light[i] * left);
  }
}

/// The same of a directional light that has a place. Its shadow rays end there.
static void end_light(const LightSource& light, std::size_t first, ShadowQueue& queue) {
  for (std::size_t i = first; i < queue.size(); ++i) {
    const Vec3d towards(light.place), way = light.from - Vec3d(queue.rays[i].origin);
    const double distance = dot(way, towards);
    float left = faded_share(light.fade, std::max(distance, 0.0));
    if (light.beam.ends())
      left *= distance > 0 ? beam_share(light.beam, length(way - towards * distance)) : 0;
    queue.light.set(i, queue.light[i] * left);
    if (light.shadows) queue.rays.tmax[i] = static_cast<float>(std::max(distance, 0.0));
  }
}

/// Of a directional light fog lies before its place, if it has one.
static void dim_light(const LightSource& light, std::span<const Fog> fogs, std::size_t first,
                      ShadowQueue& queue) {
  for (std::size_t i = first; i < queue.size(); ++i) {
    const Ray ray = queue.rays[i];
    const Vec3d origin(ray.origin), way(ray.direction);
    double distance = length(way);
    if (light.directional) distance = std::numeric_limits<double>::infinity();
    if (light.from_place) distance = std::max(dot(light.from - origin, Vec3d(light.place)), 0.0);
    queue.light.set(i, queue.light[i] * pass_fogs(fogs, origin, normalize(way), distance).left);
  }
}

void finish_light_rays(const LightSource& light, std::span<const Fog> fogs, std::size_t first,
                       ShadowQueue& queue) {
  if (!light.directional && (light.fade.fades() || light.tightness > 0)) fade_light(light, first, queue);
  const Ray like;
  std::fill_n(queue.rays.tmin.data() + first, queue.size() - first, like.tmin);
  // A ray of no length meets nothing.
  const float tmax = !light.shadows ? 0 : light.directional ? like.tmax : kBeforeLight;
  std::fill_n(queue.rays.tmax.data() + first, queue.size() - first, tmax);
  if (light.from_place) end_light(light, first, queue);
  if (light.dimmed_by_fog) dim_light(light, fogs, first, queue);
}

}  // namespace oktett
