#include "render/photon/fingerprint.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "accel/accel.h"
#include "core/hash.h"
#include "render/light/emitter_kinds.h"
#include "render/photon/trace_photons.h"
#include "render/sampling/owen_sobol.h"

namespace oktett {
namespace {

constexpr std::uint32_t kProbes = 4096;

SquareSample probe(std::uint32_t number, std::uint32_t dimension) {
  return sobol_point(number, sequence_key(kGoldenBits, dimension));
}

/// Rays between places of a sphere around all that has bounds.
std::uint64_t geometry_hash(const RenderContext& context) {
  const World& world = *context.world;
  const bool empty = world.bounds.empty();
  const Vec3d center = empty ? Vec3d{} : Vec3d(world.bounds.center());
  const double radius = empty ? 1 : length(Vec3d(world.bounds.hi) - center) * 1.01;
  Hasher hash;
  hash.add(world.bounds.lo), hash.add(world.bounds.hi);
  hash.add(world.triangles), hash.add(world.primitives);
  RayBatch rays;
  for (std::uint32_t i = 0; i < kProbes; ++i) {
    const SquareSample from = probe(i, 0), to = probe(i, 1);
    Ray ray;
    ray.origin = Vec3f(center + around({0, 0, 1}, 2 * from.x, from.y) * radius);
    ray.direction = Vec3f(center + around({0, 0, 1}, 2 * to.x, to.y) * radius) - ray.origin;
    rays.push_back(ray);
  }
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(*world.accel, rays.span(), hits.span(), context.isa);
  for (std::uint32_t i = 0; i < kProbes; ++i) {
    const Hit hit = hits[i];
    hash.add(hit.t);
    if (!hit.valid()) continue;
    const SurfaceInteraction s = identify(*world.accel, hit);
    hash.add(std::uint64_t{material_index(world, s.user, s.material_slot)} << 32 | s.primitive);
  }
  return hash.value();
}

std::uint64_t lights_hash(const RenderContext& context, const PhotonSource& source) {
  Hasher hash;
  hash.add(std::uint64_t{source.emitter_count()});
  if (source.empty()) return hash.value();
  for (std::uint32_t i = 0; i < kProbes; ++i) {
    const auto start = source.emit(probe(i, 2).x, probe(i, 3), probe(i, 4));
    hash.add(std::uint64_t{start.has_value()});
    if (!start) continue;
    hash.add(start->ray.origin), hash.add(start->ray.direction), hash.add(start->power);
    if (const std::uint8_t group = context.sampled->group(start->emitter); group != 0)
      hash.add(std::uint64_t{group});
  }
  return hash.value();
}

std::uint64_t materials_hash(const RenderContext& context, const PhotonSource& source,
                             const PhotonPlan& plan) {
  PhotonPlan few = plan;
  few.photons = kProbes;
  Hasher hash;
  for (const Photon& photon : trace_photons(context, source, few, 0).photons) {
    hash.add(photon.position), hash.add(photon.power);
    hash.add(std::uint64_t{photon.direction} << 16 | photon.bounces);
  }
  return hash.value();
}

std::string number_text(double x) {
  std::string text = std::to_string(x);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

SceneFingerprint fingerprint(std::span<const RenderContext> moments, const std::deque<PhotonSource>& sources,
                             const PhotonPlan& plan) {
  Hasher geometry, materials, lights;
  for (std::size_t m = 0; m < moments.size(); ++m) {
    geometry.add(geometry_hash(moments[m]));
    materials.add(materials_hash(moments[m], sources[m], plan));
    lights.add(lights_hash(moments[m], sources[m]));
  }
  return {geometry.value(), materials.value(), lights.value()};
}

std::string difference(const PhotonMap& map, const PhotonPlan& plan, const SceneFingerprint& scene) {
  const auto number = [](const char* what, double has, double wanted) {
    return "it has " + std::string(what) + " " + number_text(has) + ", the scene wants " +
           number_text(wanted);
  };
  const PhotonPlan& has = map.plan;
  if (has.photons != plan.photons) return number("photons per pass:", has.photons, plan.photons);
  if (has.passes != plan.passes) return number("passes:", has.passes, plan.passes);
  if (has.depth != plan.depth) return number("depth", has.depth, plan.depth);
  if (has.moments != plan.moments) return number("moments of motion:", has.moments, plan.moments);
  if (has.seed != plan.seed) return number("seed", has.seed, plan.seed);
  if (has.radius != plan.radius) return number("radius", has.radius, plan.radius);
  if (map.scene.geometry != scene.geometry) return "its scene has other geometry";
  if (map.scene.lights != scene.lights) return "its scene has other lights, or mirrors and glass elsewhere";
  if (map.scene.materials != scene.materials) return "its scene has other materials, media or textures";
  return {};
}

}  // namespace oktett
