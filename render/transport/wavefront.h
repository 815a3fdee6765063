#pragma once
/// \file A wavefront: the rays of one bounce in a tile, traced and shaded together.

#include <cstdint>
#include <span>
#include <vector>

#include "render/context.h"
#include "render/hit_object.h"
#include "render/raised_points.h"
#include "render/render_options.h"
#include "render/shading_point.h"
#include "render/transport/path_block.h"
#include "render/transport/ray_queue.h"

namespace oktett {

/// The surface that a sample's camera ray meets first, for the data layers. The other members hold values
/// only if `found`.
struct FirstHit {
  bool found = false;
  float depth = 0;  ///< along the view axis
  Vec3f normal, geometric_normal, position;
  Color albedo;
  Vec2f uv;
  std::uint32_t primitive = kNoId, object = kNoId;
  std::uint32_t material = kNoId;  ///< index into World::materials
  std::uint32_t whole = kNoId;     ///< the object that mattes name, see whole_object(); only for mattes
};

/// Camera samples in columns: their places and their results.
struct SampleBatch {
  Column<std::uint32_t> pixel;    ///< the caller's number of the pixel
  Column<std::uint32_t> number;   ///< of the sample in its pixel
  Column<std::uint64_t> key;      ///< of the pixel's random numbers, if the integrator draws any
  Column<std::uint32_t> pattern;  ///< of RenderContext::area_lights; empty if there are none
  Column<Vec2f> offset;           ///< from the pixel's centre, in pixels
  ColorColumn color;
  Column<float> alpha;
  Column<std::uint16_t> spawned;     ///< number of rays that Whitted's integrator queued for the next bounce
  Column<FirstHit> first;            ///< empty unless data layers are wanted
  std::vector<ColorColumn> grouped;  ///< per light group its part of `color`; empty unless wanted
  ColorColumn behind;                ///< of RenderContext::catches: the background that a catcher hides

  std::size_t size() const { return pixel.size(); }
  /// Where the light of shadow catchers is kept apart, the samples of the second half stand for what those of
  /// the first see of catchers: this is the number of the first one.
  std::uint32_t caught() const { return static_cast<std::uint32_t>(size() / 2); }
  void resize_uninitialized(std::size_t n, bool data_layers) {
    pixel.resize_uninitialized(n), number.resize_uninitialized(n), key.resize_uninitialized(n);
    offset.resize_uninitialized(n), color.resize_uninitialized(n), alpha.resize_uninitialized(n);
    spawned.resize_uninitialized(n), first.resize_uninitialized(data_layers ? n : 0);
  }
};

/// A pixel whose samples a wavefront holds.
struct WavefrontPixel {
  std::uint32_t number = 0;    ///< the caller's
  std::uint32_t x = 0, y = 0;  ///< in the full frame
};

/// How many rays of each kind were traced.
struct RayCounts {
  std::uint64_t camera = 0, shadow = 0, reflected = 0, refracted = 0;
  std::uint64_t camera_hits = 0;  ///< camera rays that met something
  std::vector<BounceReport> bounces;
  std::uint64_t total() const { return camera + shadow + reflected + refracted; }
};

/// What a ray meets in a medium before it meets a surface.
struct MediumEvent {
  std::uint32_t ray;     ///< entry of the wavefront's rays
  std::uint32_t medium;  ///< index into RenderContext::media
  MediumPassage passage;
};

/// Light that a bounce has led to, if nothing is in the way of a shadow ray; see met_lights.h.
struct MetLight {
  std::uint32_t ray;      ///< entry of the wavefront's rays
  std::uint32_t emitter;  ///< of the LightSet
  Ray shadow;
  Color light;  ///< that of the ray, weighted against light samples
};

/// A hit of a PathBlock that has a surface of its own.
struct LoneHit {
  std::uint32_t entry = 0;  ///< of the block
  PathSurface surface;
  ShadingPoint point;
  Boundary boundary;  ///< if the scene tracks dielectrics
};

/// The rays of one bounce of some samples, and what is kept for the next bounce. The result of a sample does
/// not depend on the other samples of its wavefront: each ray sums its light in a fixed order, and a sample
/// sums its rays in the order of the queue, which other samples do not change.
struct Wavefront {
  SampleBatch samples;
  RayQueue rays, next;  ///< of this bounce and the next
  /// In Whitted's model those rays of the next bounce that are refracted. They follow the others, so that
  /// rays side by side are more alike.
  RayQueue refracted;
  PathColumns paths, next_paths;  ///< of `rays` after the camera rays and of `next`, in path tracing
  HitBatch hits;                  ///< of `rays`
  ColorColumn radiance;           ///< light found by each of `rays`, throughput included
  /// Emitter of the light sample that each of `rays` has queued, if layers of light groups are wanted.
  Column<std::uint32_t> sampled_emitter;
  /// In Whitted's model one queue per light, and one per point of a pattern of area lights, so that all rays
  /// of a queue lead to the same point. In path
  /// tracing the first queue holds rays to lights that are seen as points, the second those to all others.
  /// Rays of ambient occlusion are in the first queue. Owners are entries of `rays`.
  std::vector<ShadowQueue> shadows;
  /// With area lights: which of the points that the hit of a ray has asked it sees (share_of_pattern,
  /// trace_penumbra_rays); the rays whose hits lie in penumbras; and shadow rays of these.
  Column<std::uint8_t> emitter_view;
  std::vector<std::uint32_t> penumbra;
  ShadowQueue penumbra_shadows;
  std::vector<MediumEvent> medium_events;  ///< of rays that are scattered or find light in media
  std::vector<MetLight> met_lights;
  std::vector<LoneHit> lone_hits;  ///< of the present block
  Column<std::uint32_t> hit_rays;  ///< entries of `rays` that hit something
  Column<double> film_x, film_y;   ///< where the camera rays pass the film
  Column<double> lens_x, lens_y;   ///< and the lens, as in FilmPoints
  unsigned level = 0;              ///< number of the bounce; 0 = camera rays
  bool whole_pixels = true;        ///< all samples of each of its pixels are in this wavefront
  RayCounts counts;
};

/// The columns of its rays, whose hits are known.
ArrivingRays arriving_rays(Wavefront& wavefront);
/// The raised points of the hits of its rays which[0], which[1], ..., of surfaces `found`.
RaisedPoints raised_points(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                           const InteractionBlock& found);
/// A queue opened for at most `more` rays, which are added behind those that it holds. Afterwards it must be
/// resized to the rays that it has then.
ShadowColumns end_of(ShadowQueue& queue, std::size_t more);
OnwardColumns end_of(RayQueue& queue, std::size_t more);
/// Sets those columns of the rays from `first` on that are the same for all rays of a bounce.
void finish_rays(RayQueue& queue, std::size_t first);

/// Traces the shadow rays of path tracing to lights that other rays can meet, and adds their light.
void flush_area_shadows(const RenderContext& context, Wavefront& wavefront);

/// Counts shadow rays of the present bounce.
void count_shadow_rays(Wavefront& wavefront, std::size_t rays);

/// The pattern of RenderContext::area_lights that the hit of entry `ray` asks; there are area lights.
inline std::uint32_t pattern_of(const Wavefront& wavefront, std::size_t ray) {
  return wavefront.samples.pattern[wavefront.rays.sample[ray]];
}

/// Counts hits of the present bounce that were shaded in groups of `width` lanes.
void count_lanes(Wavefront& wavefront, std::size_t hits, std::size_t width);

/// Fills a wavefront, which may be new or finished, with the camera rays of samples [first, last) of each
/// pixel.
void start_wavefront(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                     std::uint32_t first, std::uint32_t last, Wavefront& wavefront);

/// Traces all bounces and fills the samples' colour, alpha and first hit. False if nothing was filled in
/// because no sample of the pixels met anything and the background is black.
bool trace_wavefront(const RenderContext& context, Wavefront& wavefront);

/// The mean of the channels: the part of tinted light that counts for alpha.
inline float channel_mean(const Color& c) { return (c.x + c.y + c.z) / 3; }

/// Adds the hit of entry `ray`, a camera ray, to the alpha of its sample. `opacity`: the part of what lies
/// behind that the surface hides.
void cover(const RenderContext& context, Wavefront& wavefront, std::size_t ray, float opacity);

/// Sets the data layers of the sample of entry `ray`, a camera ray, to this hit, unless an earlier one has.
void record_first_hit(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                      const ShownSurface& shown);

/// How a ray continues at a surface.
enum class Bounce {
  reflected,
  refracted,
  straight,  ///< through a hole: not counted as a bounce
  unbent,    ///< through what does not bend it: not counted either
};

/// Queues for the next bounce the ray that leaves `p`, the hit of entry `ray`, in `direction`.
void push_bounce(Wavefront& wavefront, RayQueue& queue, std::size_t ray, const ShadingPoint& p,
                 const Vec3f& direction, const Color& throughput, Bounce bounce);
/// The same from `origin`, see offset_origin.
void push_bounce(Wavefront& wavefront, RayQueue& queue, std::size_t ray, const Vec3f& origin,
                 const Vec3f& direction, const Color& throughput, Bounce bounce);

}  // namespace oktett
