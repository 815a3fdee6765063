#pragma once
/// \file A wavefront: the camera samples of some pixels, traced together level by level.

#include <cstdint>
#include <span>
#include <vector>

#include "render/context.h"
#include "render/ray_queue.h"
#include "render/shading_point.h"

namespace oktett {

/// What the data layers show: the nearest surface that a sample's camera ray meets. The rest counts only if
/// one is `found`.
struct FirstHit {
  bool found = false;
  float depth = 0;  ///< along the view axis
  Vec3f normal, position;
  Color albedo;
  Vec2f uv;
  std::uint32_t primitive = kNoId, object = kNoId;
};

/// Camera samples: where they come from and what they found.
struct SampleBatch {
  Column<std::uint32_t> pixel;   ///< the caller's number of the pixel
  Column<std::uint32_t> number;  ///< of the sample in its pixel
  Column<std::uint64_t> key;     ///< of the pixel's random numbers
  Column<Vec2f> offset;          ///< from the pixel's centre, in pixels
  Column<Color> color;
  Column<float> alpha;
  Column<std::uint16_t> spawned;  ///< rays of the next level so far
  Column<FirstHit> first;         ///< empty unless data layers are wanted

  std::size_t size() const { return pixel.size(); }
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
  std::uint64_t total() const { return camera + shadow + reflected + refracted; }
};

/// A sample's result depends on the sample alone, not on what else is in its wavefront: each of its rays sums
/// its own light in a fixed order, and a sample sums its rays in the order of the queue, which the others
/// cannot change.
struct Wavefront {
  SampleBatch samples;
  RayQueue rays, next;     ///< of this level and the next
  HitBatch hits;           ///< of `rays`
  Column<Color> radiance;  ///< light found by each of `rays`, throughput included
  /// One queue per light, so that the rays of a queue share an end; owners are entries of `rays`. Rays to no
  /// light in particular stand in the first.
  std::vector<ShadowQueue> shadows;
  Column<std::uint32_t> hit_rays;  ///< entries of `rays` that hit something
  Column<double> film_x, film_y;   ///< where the camera rays pass the film
  unsigned level = 0;              ///< 0 = camera rays
  bool whole_pixels = true;        ///< all samples of each of its pixels are in this wavefront
  RayCounts counts;
};

/// Begins a wavefront, empty or finished, with the camera rays of samples [first, last) of each of the
/// pixels.
void start_wavefront(const RenderContext& context, std::span<const WavefrontPixel> pixels,
                     std::uint32_t first, std::uint32_t last, Wavefront& wavefront);

/// Traces the samples to the end: fills their colour, alpha and first hit. False if there is nothing to fill
/// in, since whole pixels met nothing and the background is black.
bool trace_wavefront(const RenderContext& context, Wavefront& wavefront);

/// How a ray goes on from a surface.
enum class Bounce {
  reflected,
  refracted,
  straight,  ///< through a hole: not counted as a bounce
};

/// Adds to the next level the ray that leaves `p`, found by entry `ray` of this level, in `direction`. Rays
/// that could change the picture by less than anyone can see are dropped, and so are those beyond 256 of one
/// sample in one level.
void push_bounce(Wavefront& wavefront, std::size_t ray, const ShadingPoint& p, const Vec3f& direction,
                 const Color& throughput, Bounce bounce);

}  // namespace oktett
