#include "render/wave.h"

#include <algorithm>
#include <utility>

#include "accel/accel.h"
#include "accel/offset_origin.h"
#include "core/random.h"
#include "render/integrators.h"
#include "render/sampling.h"
#include "render/shadow.h"
#include "render/whitted_block.h"

namespace oktett {
namespace {

/// Holes that a camera path may lead through, in addition to its bounces.
constexpr unsigned kMostHoles = 128;
/// Bound on the growth of a tree of rays where materials give out more light than they receive.
constexpr std::uint16_t kMostRaysPerLevel = 256;
constexpr float kLeastThroughput = 1 / 4096.0f;
/// Shadow rays are traced when this many have gathered.
constexpr std::size_t kShadowBatch = 4096;
/// Hits whose surfaces are found together.
constexpr std::size_t kShadeBlock = SurfaceBlock::kMost;

void find_hits(const RenderContext& context, Wave& wave) {
  wave.hits.resize_uninitialized(wave.rays.size());
  closest_hit(*context.world->accel, wave.rays.rays.span(), wave.hits.span(), context.isa);
}

/// Gives every ray its radiance if it escapes, none yet if not, and lists those that do not.
void start_level(const RenderContext& context, Wave& wave) {
  const std::size_t count = wave.rays.size();
  wave.radiance.resize_uninitialized(count);
  wave.hit_rays.resize_uninitialized(count);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool hit = wave.hits.item[i] != kNoId;
    wave.hit_rays[hits] = static_cast<std::uint32_t>(i);
    hits += hit;
    wave.radiance[i] = hit ? Color{} : wave.rays.throughput[i] * context.background;
  }
  wave.hit_rays.resize_uninitialized(hits);
  std::fill_n(wave.samples.spawned.data(), wave.samples.size(), std::uint16_t{0});
  wave.next.clear();
}

/// A background that is part of the picture covers it.
void cover_background(const RenderContext& context, Wave& wave) {
  if (!context.opaque_background) return;
  for (std::size_t i = 0; i < wave.rays.size(); ++i)
    if (wave.rays.from_camera[i] && wave.hits.item[i] == kNoId)
      wave.samples.alpha[wave.rays.sample[i]] += wave.rays.throughput[i].x;
}

void record_first_hit(const RenderContext& context, Wave& wave, std::size_t ray, const ShadingPoint& p) {
  const std::uint32_t sample = wave.rays.sample[ray];
  wave.samples.alpha[sample] += wave.rays.throughput[ray].x * p.opacity;
  if (!context.data_layers) return;
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

/// The order of the lights, and within a light that of the rays, is that in which each ray gets its light.
void flush_shadows(const RenderContext& context, Wave& wave) {
  for (ShadowQueue& queue : wave.shadows) {
    trace_shadows(context, queue, wave.radiance);
    wave.counts.shadow += queue.size();
    queue.clear();
  }
}

bool shadows_are_full(const Wave& wave) {
  for (const ShadowQueue& queue : wave.shadows)
    if (queue.size() >= kShadowBatch) return true;
  return false;
}

/// In blocks, so that what is known of a hit stays in the nearest cache until it has been shaded.
void shade_hits(const RenderContext& context, Wave& wave) {
  const Integrator integrator = integrator_for(context.settings.kind);
  const bool in_blocks = context.settings.kind == IntegratorKind::whitted && !context.data_layers;
  SurfaceBlock found;
  for (std::size_t first = 0; first < wave.hit_rays.size(); first += kShadeBlock) {
    const std::size_t count = std::min(kShadeBlock, wave.hit_rays.size() - first);
    const std::uint32_t* which = wave.hit_rays.data() + first;
    surfaces(*context.world->accel, wave.rays.rays.span(), wave.hits.span(), which, count, context.isa,
             found);
    if (in_blocks) {
      shade_whitted_block(context, wave, which, count, found);
      if (shadows_are_full(wave)) flush_shadows(context, wave);
      continue;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = which[k];
      const bool from_camera = wave.rays.from_camera[i] != 0;
      const ShadingPoint p = shading_point(context, wave.rays.rays[i], wave.hits[i],
                                           {wave.rays.distance[i], from_camera}, found[k]);
      if (from_camera) record_first_hit(context, wave, i, p);
      integrator(context, wave, i, p);
    }
    if (shadows_are_full(wave)) flush_shadows(context, wave);
  }
  flush_shadows(context, wave);
}

void add_to_samples(Wave& wave) {
  for (std::size_t i = 0; i < wave.rays.size(); ++i)
    wave.samples.color[wave.rays.sample[i]] += wave.radiance[i];
}

bool meets_anything(const Wave& wave) {
  for (const std::uint32_t item : wave.hits.item)
    if (item != kNoId) return true;
  return false;
}

/// Columns in which all camera rays are alike.
void fill_camera_rays(Wave& wave) {
  const std::size_t count = wave.rays.size();
  const RayQueue::Entry like;
  RayQueue& rays = wave.rays;
  for (std::size_t i = 0; i < count; ++i) rays.sample[i] = static_cast<std::uint32_t>(i);
  std::fill_n(rays.throughput.data(), count, like.throughput);
  std::fill_n(rays.distance.data(), count, like.distance);
  std::fill_n(rays.bounces.data(), count, like.bounces);
  std::fill_n(rays.from_camera.data(), count, std::uint8_t{1});
}

/// Samples that have found nothing yet.
void fill_samples(SampleBatch& samples) {
  const std::size_t count = samples.size();
  std::fill_n(samples.color.data(), count, Color{});
  std::fill_n(samples.alpha.data(), count, 0.0f);
  for (FirstHit& first : samples.first) {
    // The rest of a first hit is written when it is found.
    first.found = false, first.primitive = first.object = kNoId;
  }
}

}  // namespace

void start_wave(const RenderContext& context, std::span<const WavePixel> pixels, std::uint32_t first,
                std::uint32_t last, Wave& wave) {
  const std::size_t count = pixels.size() * (last - first);
  wave.level = 0;
  wave.whole_pixels = last - first == context.settings.samples;
  wave.next.clear();
  wave.shadows.resize(std::max<std::size_t>(1, context.lights.size()));
  wave.film_x.resize_uninitialized(count), wave.film_y.resize_uninitialized(count);
  SampleBatch& s = wave.samples;
  s.resize_uninitialized(count, context.data_layers);
  wave.rays.resize_uninitialized(count);
  std::size_t i = 0;
  const auto add = [&](const WavePixel& pixel, std::uint32_t number, std::uint64_t key,
                       const SquareSample& at) {
    wave.film_x[i] = pixel.x + at.x, wave.film_y[i] = pixel.y + at.y;
    s.pixel[i] = pixel.number, s.number[i] = number, s.key[i] = key;
    s.offset[i++] = {static_cast<float>(at.x - 0.5), static_cast<float>(at.y - 0.5)};
  };
  for (const WavePixel& pixel : pixels) {
    const std::uint64_t index = static_cast<std::uint64_t>(pixel.y) * context.full_width + pixel.x;
    const std::uint64_t key = pixel_key(context.settings.seed, index);
    if (context.settings.samples == 1) {
      add(pixel, 0, key, kSquareCentre);
      continue;
    }
    const StratifiedPattern pattern(context.settings.samples, pattern_key(key, 0));
    for (std::uint32_t number = first; number < last; ++number) add(pixel, number, key, pattern[number]);
  }
  camera_rays(context.camera, {wave.film_x, wave.film_y}, context.isa, wave.rays.rays);
  wave.counts.camera += count;
}

bool trace_wave(const RenderContext& context, Wave& wave) {
  const unsigned most_levels = context.settings.depth + kMostHoles;
  for (wave.level = 0; wave.level <= most_levels && !wave.rays.empty(); ++wave.level) {
    find_hits(context, wave);
    if (wave.level == 0) {
      // Waves that share a pixel are all needed for its mean.
      if (wave.whole_pixels && !context.opaque_background && !meets_anything(wave)) return false;
      fill_samples(wave.samples);
      fill_camera_rays(wave);
    }
    start_level(context, wave);
    cover_background(context, wave);
    shade_hits(context, wave);
    add_to_samples(wave);
    std::swap(wave.rays, wave.next);
  }
  return true;
}

void push_bounce(Wave& wave, std::size_t ray, const ShadingPoint& p, const Vec3f& direction,
                 const Color& throughput, Bounce bounce) {
  if (max_component(throughput) < kLeastThroughput) return;
  const std::uint32_t sample = wave.rays.sample[ray];
  if (wave.samples.spawned[sample] >= kMostRaysPerLevel) return;
  ++wave.samples.spawned[sample];
  const bool straight = bounce == Bounce::straight;
  RayQueue::Entry entry;
  offset_origin(p.surface, direction, entry.ray.origin);
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
