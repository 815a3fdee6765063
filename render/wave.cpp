#include "render/wave.h"

#include <utility>

#include "accel/accel.h"
#include "core/random.h"
#include "render/integrators.h"
#include "render/sampling.h"
#include "render/shadow.h"

namespace oktett {
namespace {

/// Holes that a camera path may lead through, in addition to its bounces.
constexpr unsigned kMostHoles = 128;
/// Bound on the growth of a tree of rays where materials give out more light than they receive.
constexpr std::uint16_t kMostRaysPerLevel = 256;
constexpr float kLeastThroughput = 1 / 4096.0f;
/// Shadow rays are traced when this many have gathered.
constexpr std::size_t kShadowBatch = 4096;

void find_hits(const RenderContext& context, Wave& wave) {
  wave.hits.resize_uninitialized(wave.rays.size());
  closest_hit(*context.world->accel, wave.rays.rays.span(), wave.hits.span(), context.isa);
}

void start_level(Wave& wave) {
  wave.radiance.resize_uninitialized(wave.rays.size());
  for (Color& c : wave.radiance) c = {};
  for (std::uint16_t& n : wave.samples.spawned) n = 0;
  wave.next.clear();
}

void escape(const RenderContext& context, Wave& wave, std::size_t ray) {
  wave.radiance[ray] = wave.rays.throughput[ray] * context.background;
  if (wave.rays.from_camera[ray] && context.opaque_background)
    wave.samples.alpha[wave.rays.sample[ray]] += wave.rays.throughput[ray].x;
}

void record_first_hit(const RenderContext& context, Wave& wave, std::size_t ray, const ShadingPoint& p) {
  const std::uint32_t sample = wave.rays.sample[ray];
  wave.samples.alpha[sample] += wave.rays.throughput[ray].x * p.opacity;
  FirstHit& first = wave.samples.first[sample];
  if (first.found || p.opacity == 0) return;
  const Surface& s = p.surface;
  first = {true,
           static_cast<float>(camera_depth(context.camera, s.position)),
           s.shading_normal,
           s.position,
           p.color,
           s.uv,
           s.primitive,
           s.user};
}

void flush_shadows(const RenderContext& context, Wave& wave) {
  trace_shadows(context, wave.shadows, wave.radiance);
  wave.counts.shadow += wave.shadows.size();
  wave.shadows.clear();
}

void shade_hits(const RenderContext& context, Wave& wave) {
  const Integrator integrator = integrator_for(context.settings.kind);
  for (std::size_t i = 0; i < wave.rays.size(); ++i) {
    const Hit hit = wave.hits[i];
    if (!hit.valid()) {
      escape(context, wave, i);
      continue;
    }
    const bool from_camera = wave.rays.from_camera[i] != 0;
    const ShadingPoint p =
        shading_point(context, wave.rays.rays[i], hit, {wave.rays.distance[i], from_camera});
    if (from_camera) record_first_hit(context, wave, i, p);
    integrator(context, wave, i, p);
    if (wave.shadows.size() >= kShadowBatch) flush_shadows(context, wave);
  }
  flush_shadows(context, wave);
}

void add_to_samples(Wave& wave) {
  for (std::size_t i = 0; i < wave.rays.size(); ++i)
    wave.samples.color[wave.rays.sample[i]] += wave.radiance[i];
}

}  // namespace

void Wave::clear() {
  SampleBatch& s = samples;
  s.pixel.resize_uninitialized(0), s.number.resize_uninitialized(0), s.key.resize_uninitialized(0);
  s.offset.resize_uninitialized(0), s.color.resize_uninitialized(0), s.alpha.resize_uninitialized(0);
  s.spawned.resize_uninitialized(0), s.first.resize_uninitialized(0);
  rays.clear(), next.clear(), shadows.clear();
  level = 0;
}

void add_sample(const RenderContext& context, Wave& wave, std::uint32_t pixel, std::uint32_t x,
                std::uint32_t y, std::uint32_t number) {
  const std::uint64_t index = static_cast<std::uint64_t>(y) * context.full_width + x;
  const std::uint64_t key = pixel_key(context.settings.seed, index);
  const SquareSample at = stratified_sample(number, context.settings.samples, pattern_key(key, 0));
  SampleBatch& s = wave.samples;
  RayQueue::Entry entry;
  entry.ray = camera_ray(context.camera, x + at.x, y + at.y);
  entry.sample = static_cast<std::uint32_t>(s.size());
  entry.from_camera = true;
  wave.rays.push_back(entry);
  s.pixel.push_back(pixel), s.number.push_back(number), s.key.push_back(key);
  s.offset.push_back({static_cast<float>(at.x - 0.5), static_cast<float>(at.y - 0.5)});
  s.color.push_back({}), s.alpha.push_back(0), s.spawned.push_back(0), s.first.push_back({});
  ++wave.counts.camera;
}

void trace_wave(const RenderContext& context, Wave& wave) {
  const unsigned most_levels = context.settings.depth + kMostHoles;
  for (wave.level = 0; wave.level <= most_levels && !wave.rays.empty(); ++wave.level) {
    start_level(wave);
    find_hits(context, wave);
    shade_hits(context, wave);
    add_to_samples(wave);
    std::swap(wave.rays, wave.next);
  }
}

void push_bounce(Wave& wave, std::size_t ray, const ShadingPoint& p, const Vec3f& direction,
                 const Color& throughput, Bounce bounce) {
  if (max_component(throughput) < kLeastThroughput) return;
  const std::uint32_t sample = wave.rays.sample[ray];
  if (wave.samples.spawned[sample] >= kMostRaysPerLevel) return;
  ++wave.samples.spawned[sample];
  const bool straight = bounce == Bounce::straight;
  RayQueue::Entry entry;
  entry.ray.origin = offset_origin(p.surface, direction);
  entry.ray.direction = direction;
  entry.sample = sample;
  entry.throughput = throughput;
  entry.distance = wave.rays.distance[ray] + p.t;
  entry.bounces = static_cast<std::uint8_t>(wave.rays.bounces[ray] + (straight ? 0 : 1));
  entry.from_camera = straight && wave.rays.from_camera[ray];
  wave.next.push_back(entry);
  ++(bounce == Bounce::reflected ? wave.counts.reflected : wave.counts.refracted);
}

}  // namespace oktett
