#include "render/transport/wavefront.h"

#include <algorithm>
#include <span>
#include <utility>

#include "accel/accel.h"
#include "accel/surface/offset_origin.h"
#include "render/photon/caustics.h"
#include "render/shading_point.h"
#include "render/transport/grouped_light.h"
#include "render/transport/integrators.h"
#include "render/transport/medium_paths.h"
#include "render/transport/met_lights.h"
#include "render/transport/path.h"
#include "render/transport/render_code.h"
#include "render/transport/shadow.h"
#include "render/transport/veils.h"

namespace oktett {

// ---- Penumbras of emitters in Whitted's model: a hit that sees some points of its pattern and not others
// asks more points. Penumbras are a small part of most pictures but hold nearly all noise of soft shadows.

namespace {

/// What Wavefront::emitter_view holds of a ray's hit.
enum View : std::uint8_t { kSeesPoint = 1, kMissesPoint = 2, kBoth = 3, kListed = 4 };

/// Rays are traced when this many have gathered.
constexpr std::size_t kBatch = 4096;

std::span<ShadowQueue> emitter_queues(const RenderContext& context, Wavefront& wavefront) {
  return std::span(wavefront.shadows).subspan(context.lights.size(), context.area_lights.samples);
}

float share_of_pattern(const AreaLights& area) { return 1.0f / static_cast<float>(area.penumbra); }

/// Notes which points the owners of `queue` see.
void note_view(const ShadowQueue& queue, Column<std::uint8_t>& view) {
  for (std::size_t i = 0; i < queue.size(); ++i)
    view[queue.owner[i]] |= is_black(queue.light[i]) ? kMissesPoint : kSeesPoint;
}

void add_emitter_light(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue) {
  const float share = share_of_pattern(context.area_lights);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::uint32_t owner = queue.owner[i];
    std::uint8_t& view = wavefront.emitter_view[owner];
    Color light = queue.light[i];
    if (context.area_lights.penumbra > 1 && (view & kBoth) == kBoth) {
      if ((view & kListed) == 0) wavefront.penumbra.push_back(owner);
      view |= kListed;
      light = light * share;
    }
    if (!is_black(light)) add_arriving(context, wavefront, queue, i, light);
  }
}

void trace_penumbra_rays(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue) {
  const float share = share_of_pattern(context.area_lights);
  find_arriving(context, queue, ShadowRule::transparent_passes);
  for (std::size_t i = 0; i < queue.size(); ++i)
    if (const Color light = queue.light[i] * share; !is_black(light))
      add_arriving(context, wavefront, queue, i, light);
  count_shadow_rays(wavefront, queue.size());
  queue.clear();
}

}  // namespace

/// Makes the wavefront ready for the hits of a bounce, none of which is in a penumbra yet.
static void start_penumbras(const RenderContext& context, Wavefront& wavefront) {
  if (context.area_lights.empty()) return;
  wavefront.emitter_view.resize_uninitialized(wavefront.rays.size());
  std::fill_n(wavefront.emitter_view.data(), wavefront.rays.size(), std::uint8_t{0});
  wavefront.penumbra.clear();
}

/// Traces the queued shadow rays to points of area lights and adds the light that arrives. A hit in a
/// penumbra receives only the share of the points that it has asked so far, and is put on
/// `wavefront.penumbra`. All rays of a hit must be queued at once.
static void flush_emitter_shadows(const RenderContext& context, Wavefront& wavefront) {
  const std::span<ShadowQueue> queues = emitter_queues(context, wavefront);
  for (ShadowQueue& queue : queues) {
    count_shadow_rays(wavefront, queue.size());
    if (queue.size() == 0) continue;
    find_arriving(context, queue, ShadowRule::transparent_passes);
    note_view(queue, wavefront.emitter_view);
  }
  for (ShadowQueue& queue : queues) {
    add_emitter_light(context, wavefront, queue);
    queue.clear();
  }
}

/// Asks the other points for all hits on `wavefront.penumbra`, and adds their share of the light.
static void shade_penumbras(const RenderContext& context, Wavefront& wavefront) {
  const std::span<const std::uint32_t> hits(wavefront.penumbra);
  const auto pattern = [&](std::uint32_t ray) { return pattern_of(wavefront, ray); };
  ShadowQueue& queue = wavefront.penumbra_shadows;
  InteractionBlock found;
  for (std::size_t first = 0, last; first < hits.size(); first = last) {
    for (last = first + 1; last < hits.size() && last < first + InteractionBlock::kMost &&
                           pattern(hits[last]) == pattern(hits[first]);)
      ++last;
    const std::span<const std::uint32_t> block = hits.subspan(first, last - first);
    surface_interactions(*context.world->accel, wavefront.rays.rays, wavefront.hits, block, found,
                         context.isa);
    queue_penumbra_rays(context, wavefront, block, found, queue);
    if (queue.size() >= kBatch) trace_penumbra_rays(context, wavefront, queue);
  }
  if (queue.size() > 0) trace_penumbra_rays(context, wavefront, queue);
}

// ---- Columns.

ArrivingRays arriving_rays(Wavefront& wavefront) {
  ArrivingRays rays;
  for (int k = 0; k < 3; ++k) {
    rays.direction[k] = wavefront.rays.rays.direction[k].data();
    rays.throughput[k] = wavefront.rays.throughput.part[k].data();
    rays.radiance[k] = wavefront.radiance.part[k].data();
  }
  rays.distance = wavefront.rays.distance.data();
  rays.t = wavefront.hits.t.data();
  rays.sample = wavefront.rays.sample.data();
  rays.bounces = wavefront.rays.bounces.data();
  return rays;
}

RaisedPoints raised_points(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                           const InteractionBlock& found) {
  return {*context.world->accel, wavefront.rays.rays, wavefront.hits, which, found, context.isa};
}

/// Entries that the code of an instruction set may overwrite behind what it adds.
static constexpr std::size_t kOverwritten = ShadingColumns::kGroup;

ShadowColumns end_of(ShadowQueue& queue, std::size_t more) {
  ShadowColumns to;
  to.size = queue.size();
  queue.resize_uninitialized(to.size + more + kOverwritten);
  for (int k = 0; k < 3; ++k) {
    to.origin[k] = queue.rays.origin[k].data();
    to.direction[k] = queue.rays.direction[k].data();
    to.light[k] = queue.light.part[k].data();
  }
  to.tmax = queue.rays.tmax.data();
  to.owner = queue.owner.data();
  return to;
}

OnwardColumns end_of(RayQueue& queue, std::size_t more) {
  OnwardColumns to;
  to.size = queue.size();
  queue.resize_uninitialized(to.size + more + kOverwritten);
  for (int k = 0; k < 3; ++k) {
    to.origin[k] = queue.rays.origin[k].data();
    to.direction[k] = queue.rays.direction[k].data();
    to.throughput[k] = queue.throughput.part[k].data();
  }
  to.distance = queue.distance.data();
  to.sample = queue.sample.data();
  to.bounces = queue.bounces.data();
  return to;
}

void finish_rays(RayQueue& queue, std::size_t first) {
  const Ray like;
  const std::size_t count = queue.size() - first;
  std::fill_n(queue.rays.tmin.data() + first, count, like.tmin);
  std::fill_n(queue.rays.tmax.data() + first, count, like.tmax);
  std::fill_n(queue.from_camera.data() + first, count, std::uint8_t{0});
}

// ---- Wavefronts.

namespace {

/// Shadow rays are traced when this many have gathered.
constexpr std::size_t kShadowBatch = 4096;
/// Number of hits that are shaded together.
constexpr std::size_t kShadeBlock = InteractionBlock::kMost;

/// What entry `ray` is for.
RayKind kind_of(const RenderContext& context, const Wavefront& wavefront, std::size_t ray) {
  if (wavefront.level == 0 || wavefront.rays.from_camera[ray] != 0) return RayKind::camera;
  return context.bounces_differ ? wavefront.rays.kind[ray] : RayKind::diffuse;
}

/// Where rays of different kinds meet different objects.
void find_hits_by_kind(const RenderContext& context, Wavefront& wavefront) {
  const std::size_t count = wavefront.rays.size();
  std::vector<const Accel*> met(count);
  for (std::size_t i = 0; i < count; ++i) met[i] = &seen_by(*context.world, kind_of(context, wavefront, i));
  RayBatch rays;
  HitBatch hits;
  std::vector<std::uint32_t> which;
  for (std::size_t first = 0; first < count; ++first) {
    const Accel* const accel = met[first];
    if (accel == nullptr) continue;
    rays.resize_uninitialized(0), which.clear();
    for (std::size_t i = first; i < count; ++i) {
      if (met[i] != accel) continue;
      rays.push_back(wavefront.rays.rays[i]), which.push_back(static_cast<std::uint32_t>(i));
      met[i] = nullptr;
    }
    hits.resize_uninitialized(which.size());
    closest_hit(*accel, rays.span(), hits.span(), context.isa);
    for (std::size_t k = 0; k < which.size(); ++k) wavefront.hits.span().set(which[k], hits[k]);
  }
}

void find_hits(const RenderContext& context, Wavefront& wavefront) {
  wavefront.hits.resize_uninitialized(wavefront.rays.size());
  if (context.hides_objects && wavefront.level > 0) return find_hits_by_kind(context, wavefront);
  closest_hit(seen_by(*context.world, RayKind::camera), wavefront.rays.rays.span(), wavefront.hits.span(),
              context.isa);
}

/// Sets the radiance of up to 64 rays that meet nothing.
void add_environment(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* misses,
                     std::size_t count) {
  constexpr std::size_t kMost = EnvironmentValues::kMost;
  const bool path = traits(context.settings.kind).traces_paths && wavefront.level > 0;
  float direction[3][kMost] = {};
  LightPoint from[kMost];
  for (std::size_t k = 0; k < count; ++k) {
    for (int axis = 0; axis < 3; ++axis) direction[axis][k] = wavefront.rays.rays.direction[axis][misses[k]];
    if (path) from[k] = wavefront.paths.from[misses[k]];
  }
  EnvironmentValues found;
  context.sampled->set().environment_values(render_code(context.isa).lights.map, count, path ? from : nullptr,
                                            {direction[0], direction[1], direction[2]}, found);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = misses[k];
    const float pdf = path ? wavefront.paths.pdf[i] : 0;
    const bool by_photons = is_caustic(context, wavefront, i) && context.caustics->brings_distant();
    const bool is_met = context.shadows_decide && pdf > 0;
    const float weight = by_photons || is_met ? 0 : pdf == 0 ? 1 : power_weight(pdf, found.pdf[k]);
    const Color light = InteractionBlock::get(found.radiance, k);
    const Color background = background_color(context, wavefront.rays.rays[i].direction);
    wavefront.radiance.set(i, wavefront.rays.throughput[i] * (background + light * weight));
    if (context.light_groups != nullptr) add_environment_to_layers(context, wavefront, i, light, weight);
  }
}

/// For rays that meet nothing: sets the light of the environment and of a textured background, and adds the
/// background to the layer of its light group.
void add_background(const RenderContext& context, Wavefront& wavefront) {
  std::uint32_t misses[EnvironmentValues::kMost];
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < wavefront.rays.size(); ++i) {
    if (wavefront.hits.item[i] != kNoId) continue;
    if (!context.sampled->has_environment()) {
      if (context.background_texture != kNoId)
        wavefront.radiance.set(
            i, wavefront.rays.throughput[i] * background_color(context, wavefront.rays.rays[i].direction));
      add_to_layer(wavefront, i, 0, wavefront.radiance[i]);
      continue;
    }
    misses[count++] = i;
    if (count < EnvironmentValues::kMost) continue;
    add_environment(context, wavefront, misses, count);
    count = 0;
  }
  if (count > 0) add_environment(context, wavefront, misses, count);
}

/// Sets the radiance of each ray, the background's if it hit nothing and 0 if it did, and lists the rays that
/// hit.
void start_level(const RenderContext& context, Wavefront& wavefront) {
  const std::size_t count = wavefront.rays.size();
  render_code(context.isa)
      .split_rays(wavefront.hits.item, wavefront.rays.throughput, context.background, wavefront.radiance,
                  wavefront.hit_rays);
  if (context.light_groups != nullptr) wavefront.sampled_emitter.resize_uninitialized(count);
  if (wavefront.hit_rays.size() < count &&
      (context.sampled->has_environment() || context.light_groups != nullptr ||
       context.background_texture != kNoId))
    add_background(context, wavefront);
  std::fill_n(wavefront.samples.spawned.data(), wavefront.samples.size(), std::uint16_t{0});
  start_penumbras(context, wavefront);
  wavefront.next.clear(), wavefront.next_paths.clear(), wavefront.refracted.clear();
}

/// A background that is part of the picture counts as covering.
void cover_background(const RenderContext& context, Wavefront& wavefront) {
  if (!context.opaque_background || context.all_opaque) return;
  for (std::size_t i = 0; i < wavefront.rays.size(); ++i)
    if (wavefront.rays.from_camera[i] && wavefront.hits.item[i] == kNoId)
      wavefront.samples.alpha[wavefront.rays.sample[i]] += channel_mean(wavefront.rays.throughput[i]);
}

/// Traces the rays of a queue of shadow rays.
void flush_queue(const RenderContext& context, Wavefront& wavefront, std::size_t number) {
  ShadowQueue& queue = wavefront.shadows[number];
  const bool holes = traits(context.settings.kind).traces_paths && number == kAreaQueue;
  const ShadowRule rule = holes ? ShadowRule::holes_pass : ShadowRule::transparent_passes;
  if (context.tracks_dielectrics)
    trace_shadows_in_media(context, wavefront, queue, rule);
  else
    trace_shadows(context, wavefront, queue, rule);
  count_shadow_rays(wavefront, queue.size());
  queue.clear();
}

/// Traces the queued shadow rays. Each ray receives its light in a fixed order: by light, then by queue
/// entry.
void flush_shadows(const RenderContext& context, Wavefront& wavefront) {
  const std::size_t lights = context.area_lights.empty() ? wavefront.shadows.size() : context.lights.size();
  for (std::size_t n = 0; n < lights; ++n) flush_queue(context, wavefront, n);
  if (!context.area_lights.empty()) flush_emitter_shadows(context, wavefront);
}

bool shadows_are_full(const Wavefront& wavefront) {
  for (const ShadowQueue& queue : wavefront.shadows)
    if (queue.size() >= kShadowBatch) return true;
  return false;
}

/// Shades hits in blocks, so that their surface interactions stay in the nearest cache until they are used.
class HitShader {
 public:
  HitShader(const RenderContext& context, Wavefront& wavefront)
      : context_(context),
        wavefront_(wavefront),
        integrator_(integrator(context.settings.kind)),
        block_(context.one_by_one ? 1 : kShadeBlock) {}

  void shade(std::span<const std::uint32_t> hits) {
    for (std::size_t first = 0; first < hits.size(); first += block_) {
      shade_block(hits.subspan(first, std::min(block_, hits.size() - first)));
      if (shadows_are_full(wavefront_)) flush_shadows(context_, wavefront_);
    }
    flush_shadows(context_, wavefront_);
  }

 private:
  void shade_block(std::span<const std::uint32_t> which) {
    surface_interactions(*context_.world->accel, wavefront_.rays.rays, wavefront_.hits, which, found_,
                         context_.isa, shows_uv(which));
    if (integrator_.shade_block != nullptr)
      return integrator_.shade_block(context_, wavefront_, which.data(), which.size(), found_);
    for (std::size_t k = 0; k < which.size(); ++k) {
      const std::uint32_t i = which[k];
      const bool from_camera = wavefront_.rays.from_camera[i] != 0;
      const ShadingPoint p = shading_point(context_, wavefront_.rays.rays[i], wavefront_.hits[i],
                                           {wavefront_.rays.distance[i], from_camera}, found_[k]);
      if (from_camera) {
        record_first_hit(context_, wavefront_, i, shown_surface(p));
        cover(context_, wavefront_, i, p.opacity);
      }
      if (p.opacity == 0) {
        // There is no surface here.
        push_bounce(wavefront_, wavefront_.next, i, p, wavefront_.rays.rays[i].direction,
                    wavefront_.rays.throughput[i], Bounce::straight);
        continue;
      }
      integrator_.shade(context_, wavefront_, i, p);
    }
  }

  /// Whether uv of these hits is part of the picture.
  bool shows_uv(std::span<const std::uint32_t> which) const {
    const auto from_camera = [&](std::uint32_t i) { return wavefront_.rays.from_camera[i] != 0; };
    return traits(context_.settings.kind).uv ||
           (context_.data_layers && std::ranges::any_of(which, from_camera));
  }

  const RenderContext& context_;
  Wavefront& wavefront_;
  const Integrator& integrator_;
  std::size_t block_;  ///< hits that are shaded together
  InteractionBlock found_;
};

/// Shades all hits; those that ask the same points of area lights together.
void shade_hits(const RenderContext& context, Wavefront& wavefront) {
  drop_dark_hits(context, wavefront);
  HitShader shader(context, wavefront);
  const std::span<std::uint32_t> hits(wavefront.hit_rays.data(), wavefront.hit_rays.size());
  if (context.area_lights.empty()) return shader.shade(hits);
  const auto pattern = [&](std::uint32_t ray) { return pattern_of(wavefront, ray); };
  std::stable_sort(hits.begin(), hits.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return pattern(a) < pattern(b); });
  for (std::size_t first = 0, last; first < hits.size(); first = last) {
    for (last = first + 1; last < hits.size() && pattern(hits[last]) == pattern(hits[first]);) ++last;
    shader.shade(hits.subspan(first, last - first));
  }
  shade_penumbras(context, wavefront);
}

void add_to_samples(const RenderContext& context, Wavefront& wavefront) {
  SampleBatch& samples = wavefront.samples;
  if (wavefront.level == 0) samples.color.fill(samples.size(), {0, 0, 0});
  render_code(context.isa).add_colors(wavefront.radiance, wavefront.rays.sample, samples.color);
}

bool meets_anything(const Wavefront& wavefront) {
  for (const std::uint32_t item : wavefront.hits.item)
    if (item != kNoId) return true;
  return false;
}

/// Adds the samples that stand for what shadow catchers show, with the places and random numbers of the
/// others.
void add_caught_samples(SampleBatch& samples) {
  const std::size_t count = samples.size();
  const auto twice = [&](auto& column) {
    if (column.size() == 0) return;
    column.resize_uninitialized(2 * count);
    std::copy_n(column.data(), count, column.data() + count);
  };
  twice(samples.pixel), twice(samples.number), twice(samples.key), twice(samples.pattern);
  twice(samples.offset), twice(samples.first), twice(samples.spawned), twice(samples.alpha);
  samples.color.resize_uninitialized(2 * count), samples.behind.resize_uninitialized(2 * count);
  samples.behind.fill(2 * count, {0, 0, 0});
}

/// Has rays of the camera, as far as they come, belong to the second half of the samples where they meet a
/// shadow catcher. Without other objects only these count: the others end here, as far as they can.
void catch_rays(const RenderContext& context, Wavefront& wavefront) {
  const World& world = *context.world;
  SampleBatch& samples = wavefront.samples;
  for (std::size_t i = 0; i < wavefront.rays.size(); ++i) {
    if (wavefront.rays.from_camera[i] == 0) continue;
    std::uint32_t& sample = wavefront.rays.sample[i];
    sample %= samples.caught();
    if (wavefront.hits.item[i] == kNoId) continue;
    const Hit hit = wavefront.hits[i];
    if (is_shadow_catcher(world, hit, identify(*world.accel, hit).user)) {
      sample += samples.caught();
      const Vec3f direction = wavefront.rays.rays[i].direction;
      const Color light =
          background_color(context, direction) + context.sampled->set().environment_radiance(direction);
      samples.behind.set(sample, light);
    } else if (context.without_others == nullptr && !world.has_holes) {
      wavefront.hits.item[i] = kNoId;
    }
  }
}

/// Fills the columns whose value is the same for all camera rays.
void fill_camera_rays(const RenderContext& context, Wavefront& wavefront) {
  const std::size_t count = wavefront.rays.size();
  const RayQueue::Entry like;
  RayQueue& rays = wavefront.rays;
  rays.throughput.fill(count, like.throughput);
  std::fill_n(rays.distance.data(), count, like.distance);
  std::fill_n(rays.bounces.data(), count, like.bounces);
  std::fill_n(rays.from_camera.data(), count, std::uint8_t{1});
  if (context.tracks_insides) std::fill_n(rays.insides.data(), count, context.camera_insides);
}

/// Takes away the camera rays of film points at which nothing is seen; their samples stay black.
void drop_left_out(Wavefront& wavefront) {
  RayQueue& rays = wavefront.rays;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = rays.rays[i];
    if (leaves_out(ray)) continue;
    rays.rays.set(kept, ray), rays.sample[kept] = rays.sample[i];
    wavefront.hits.span().set(kept, wavefront.hits[i]);
    ++kept;
  }
  rays.resize_uninitialized(kept), wavefront.hits.resize_uninitialized(kept);
}

/// Resets the results of samples, except for their colour.
void fill_samples(const RenderContext& context, SampleBatch& samples) {
  std::fill_n(samples.alpha.data(), samples.size(), context.all_opaque ? 1.0f : 0.0f);
  for (FirstHit& first : samples.first) {
    // The other members are written when a hit is found.
    first.found = false, first.primitive = first.object = kNoId;
  }
}

}  // namespace

void flush_area_shadows(const RenderContext& context, Wavefront& wavefront) {
  flush_queue(context, wavefront, kAreaQueue);
}

static void begin_bounce(Wavefront& wavefront) {
  std::vector<BounceReport>& bounces = wavefront.counts.bounces;
  if (bounces.size() <= wavefront.level) bounces.resize(wavefront.level + 1);
  bounces[wavefront.level].rays += wavefront.rays.size(), ++bounces[wavefront.level].batches;
}

void count_shadow_rays(Wavefront& wavefront, std::size_t rays) {
  wavefront.counts.shadow += rays;
  wavefront.counts.bounces[wavefront.level].shadow_rays += rays;
}

void count_lanes(Wavefront& wavefront, std::size_t hits, std::size_t width) {
  BounceReport& bounce = wavefront.counts.bounces[wavefront.level];
  bounce.shaded += hits, bounce.lanes += (hits + width - 1) / width * width;
}

bool trace_wavefront(const RenderContext& context, Wavefront& wavefront) {
  // The light that leaves the last surface may come from one more, which path tracing looks up.
  const unsigned most_levels = context.settings.depth + 1 + kMostPassages;
  for (wavefront.level = 0; wavefront.level <= most_levels && !wavefront.rays.empty(); ++wavefront.level) {
    begin_bounce(wavefront);
    find_hits(context, wavefront);
    if (wavefront.level == 0) {
      // If several wavefronts share a pixel, all of them are needed for its mean.
      const bool may_be_empty = !context.opaque_background && !context.tracks_dielectrics;
      if (wavefront.whole_pixels && may_be_empty && !meets_anything(wavefront)) return false;
      if (is_curved(context.camera.projection)) drop_left_out(wavefront);
      if (context.catches) add_caught_samples(wavefront.samples);
      fill_samples(context, wavefront.samples);
      fill_camera_rays(context, wavefront);
      start_layers(context, wavefront);
      wavefront.counts.camera_hits += static_cast<std::uint64_t>(
          std::ranges::count_if(wavefront.hits.item, [](std::uint32_t item) { return item != kNoId; }));
      if (context.tracks_dielectrics) enclose_camera_rays(context, wavefront);
    }
    if (context.shadows_decide) find_met_lights(context, wavefront);
    if (context.tracks_dielectrics) pass_media(context, wavefront);
    if (context.catches) catch_rays(context, wavefront);
    start_level(context, wavefront);
    if (context.tracks_insides) veil_misses(context, wavefront), flush_shadows(context, wavefront);
    if (context.shadows_decide) add_met_lights(context, wavefront);
    cover_background(context, wavefront);
    if (context.tracks_dielectrics) shade_media(context, wavefront);
    shade_hits(context, wavefront);
    add_to_samples(context, wavefront);
    if (!wavefront.refracted.empty()) wavefront.next.append(wavefront.refracted);
    std::swap(wavefront.rays, wavefront.next);
    std::swap(wavefront.paths, wavefront.next_paths);
  }
  return true;
}

void cover(const RenderContext& context, Wavefront& wavefront, std::size_t ray, float opacity) {
  if (context.all_opaque) return;
  wavefront.samples.alpha[wavefront.rays.sample[ray]] +=
      channel_mean(wavefront.rays.throughput[ray]) * opacity;
}

void record_first_hit(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                      const ShownSurface& shown) {
  if (!context.data_layers) return;
  FirstHit& first = wavefront.samples.first[wavefront.rays.sample[ray]];
  if (first.found || shown.opacity == 0) return;
  const SurfaceInteraction& s = shown.surface;
  first = {true,
           static_cast<float>(camera_depth(context.camera, s.position)),
           s.shading_normal,
           s.geometric_normal,
           s.position,
           shown.color,
           s.uv,
           s.primitive,
           s.user,
           material_index(*context.world, s.user, s.material_slot),
           context.mattes != nullptr ? whole_object(*context.world, wavefront.hits[ray], s.user) : kNoId};
}

void push_bounce(Wavefront& wavefront, RayQueue& queue, std::size_t ray, const ShadingPoint& p,
                 const Vec3f& direction, const Color& throughput, Bounce bounce) {
  Vec3f origin;
  offset_origin(p.surface, direction, origin);
  push_bounce(wavefront, queue, ray, origin, direction, throughput, bounce);
}

void push_bounce(Wavefront& wavefront, RayQueue& queue, std::size_t ray, const Vec3f& origin,
                 const Vec3f& direction, const Color& throughput, Bounce bounce) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const bool straight = bounce == Bounce::straight, counts = !straight && bounce != Bounce::unbent;
  RayQueue::Entry entry;
  entry.ray.origin = origin, entry.ray.direction = direction;
  entry.sample = sample;
  entry.throughput = throughput;
  entry.distance = wavefront.rays.distance[ray] + wavefront.hits.t[ray];
  entry.bounces = static_cast<std::uint8_t>(wavefront.rays.bounces[ray] + (counts ? 1 : 0));
  entry.from_camera = straight && wavefront.rays.from_camera[ray];
  if (bounce == Bounce::reflected) entry.kind = RayKind::glossy;
  if (bounce == Bounce::refracted || bounce == Bounce::unbent) entry.kind = RayKind::transmission;
  if (straight && wavefront.level > 0) entry.kind = wavefront.rays.kind[ray];
  entry.insides = wavefront.rays.insides[ray];
  queue.push_back(entry);
  ++(bounce == Bounce::reflected ? wavefront.counts.reflected : wavefront.counts.refracted);
}

}  // namespace oktett
