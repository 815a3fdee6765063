#include "render/photon/caustics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <span>
#include <string>
#include <utility>

#include "accel/accel.h"
#include "core/bytes.h"
#include "core/error.h"
#include "core/random.h"
#include "render/context.h"
#include "render/hit_object.h"
#include "render/light/emitter_kinds.h"
#include "render/moments.h"
#include "render/photon/photon_map.h"
#include "render/photon/photon_source.h"
#include "render/photon/trace_photons.h"
#include "render/sampling/owen_sobol.h"

namespace oktett {

// ---- What photons depend on, in a few numbers.

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

}  // namespace

/// Hashes of what light meets in the scene: where some thousand rays hit and in which materials, how the
/// first photons start, and where they are kept. So two scenes have the same numbers if photons cannot tell
/// them apart, however the scenes came to be; a change that none of these rays and photons meets is not seen.
/// Of a scene with motion: at all moments, with the source of each.
static SceneFingerprint fingerprint(std::span<const RenderContext> moments,
                                    const std::deque<PhotonSource>& sources, const PhotonPlan& plan) {
  Hasher geometry, materials, lights;
  for (std::size_t m = 0; m < moments.size(); ++m) {
    geometry.add(geometry_hash(moments[m]));
    materials.add(materials_hash(moments[m], sources[m], plan));
    lights.add(lights_hash(moments[m], sources[m]));
  }
  return {geometry.value(), materials.value(), lights.value()};
}

/// What differs between the scene that a map was made for and this one, as one phrase; empty if nothing does.
static std::string difference(const PhotonMap& map, const PhotonPlan& plan, const SceneFingerprint& scene) {
  const auto number = [](const char* what, double has, double wanted) {
    return fmt::format("it has {} {}, the scene wants {}", what, has, wanted);
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

/// Below this cosine between light and surface the surface counts as lit at this cosine.
static constexpr float kLeastPhotonCosine = 1e-3f;
/// The number of the random bits that choose a pixel's first pass.
static constexpr std::uint32_t kPassDimension = 0xfffffffcu;

Caustics::Caustics(std::shared_ptr<const PhotonMap> map, const PassRange& passes, const PhotonSource& source)
    : map_(std::move(map)),
      passes_(passes),
      brings_distant_(source.brings_distant()),
      depth_(map_->plan.depth) {
  for (std::uint32_t i = 0; i < source.emitter_count(); ++i) brings_.push_back(source.brings(i) ? 1 : 0);
}

std::uint32_t PassRange::pass(std::uint64_t key, std::uint32_t sample) const {
  const std::uint32_t number = sample / cycle * asking + (sample % cycle - begin);
  const std::uint64_t offset = at_random ? random_bits(key, 0, kPassDimension) % count : 0;
  return first + step * static_cast<std::uint32_t>((number + offset) % count);
}

Color Caustics::light(std::uint64_t key, std::uint32_t sample, unsigned bounces, const ShadingPoint& p,
                      const SurfaceBsdf& bsdf, Color* of_group) const {
  const PhotonPass& pass = map_->passes[passes_.pass(key, sample)];
  Color sum;
  pass.visit_near(p.surface.position, p.ng, [&](const Photon& photon, float weight) {
    if (photon.bounces + bounces > depth_) return;
    const Vec3f to_light = -unpack_direction(photon.direction);
    // Photons arrive in proportion to the cosine at the true surface.
    const float cosine = std::max(kLeastPhotonCosine, std::abs(dot(to_light, p.ng)));
    const Color found = bsdf.evaluate(to_light).value * photon.power * (weight / cosine);
    sum += found;
    if (of_group != nullptr) of_group[photon.light_group] += found;
  });
  return sum;
}

PhotonPlan photon_plan(const IntegratorSettings& settings, std::uint32_t moments) {
  const CausticSettings& caustics = settings.caustics;
  return {caustics.photons,
          std::max(caustics.passes, 1u),
          std::min(settings.depth, 64u),
          settings.seed,
          caustics.radius,
          moments};
}

static std::shared_ptr<PhotonMap> trace_map(std::span<const RenderContext> moments,
                                            const std::deque<PhotonSource>& sources, const PhotonPlan& plan,
                                            std::uint32_t passes) {
  auto map = std::make_shared<PhotonMap>();
  map->plan = plan;
  // Photons that all lie in one place need some radius, too.
  const double target = sources.front().target_radius();
  const double least = 0x1p-16 * (target > 0 ? target : 1);
  double first = plan.radius;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    const std::size_t moment = pass % moments.size();
    TracedPhotons traced = trace_photons(moments[moment], sources[moment], plan, pass);
    if (pass == 0 && first == 0) first = std::max(least, usual_radius(traced.photons));
    map->passes.emplace_back(std::move(traced.photons), static_cast<float>(pass_radius(first, pass)));
  }
  return map;
}

std::vector<Caustics> make_caustics(std::span<const RenderContext> moments, const PhotonOptions& options) {
  std::vector<RenderContext> unseen(moments.begin(), moments.end());
  std::deque<PhotonSource> sources;
  for (RenderContext& c : unseen) {
    // Textures are looked up as finely as they are, wherever the camera stands.
    c.camera = {}, c.data_layers = false;
    sources.emplace_back(*c.world, *c.sampled, c.textures, find_casters(*c.world));
  }
  const IntegratorSettings& s = moments.front().settings;
  const auto count = static_cast<std::uint32_t>(moments.size());
  const PhotonPlan plan = photon_plan(s, count);
  // Passes that no sample asks are left out where that changes no other sample's pass.
  const bool one_each = s.error == 0 && count == 1;
  const std::uint32_t samples = std::min(s.samples, ~options.added_samples) + options.added_samples;
  const std::uint32_t asked = one_each ? std::min(plan.passes, samples) : plan.passes;
  std::shared_ptr<const PhotonMap> map = options.given;
  if (map != nullptr) {
    const std::string differs = difference(*map, plan, fingerprint(unseen, sources, plan));
    if (!differs.empty())
      throw Error(Location{map->path}, "the photon map is for another picture: " + differs);
  } else {
    const auto traced = trace_map(unseen, sources, plan, options.all_passes ? plan.passes : asked);
    if (options.all_passes) traced->scene = fingerprint(unseen, sources, plan);
    map = traced;
  }
  std::vector<Caustics> caustics;
  for (std::uint32_t m = 0; m < count; ++m) {
    PassRange passes{.first = m, .step = count, .count = (asked - m + count - 1) / count};
    if (count > 1) {
      passes.cycle = s.samples, passes.begin = first_sample_of_moment(m, count, s.samples);
      passes.asking = first_sample_of_moment(m + 1, count, s.samples) - passes.begin;
    }
    passes.at_random = s.error > 0;
    caustics.push_back({map, passes, sources[m]});
  }
  return caustics;
}

}  // namespace oktett
