#pragma once
/// \file A wave: the camera samples of some pixels, traced together level by level.

#include <cstdint>

#include "render/context.h"
#include "render/ray_queue.h"
#include "render/shading_point.h"

namespace oktett {

/// What the data layers show: the nearest surface that a sample's camera ray meets.
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
  Column<FirstHit> first;

  std::size_t size() const { return pixel.size(); }
};

/// How many rays of each kind were traced.
struct RayCounts {
  std::uint64_t camera = 0, shadow = 0, reflected = 0, refracted = 0;
  std::uint64_t total() const { return camera + shadow + reflected + refracted; }
};

/// A sample's result depends on the sample alone, not on what else is in its wave: each of its rays sums its
/// own light in a fixed order, and a sample sums its rays in the order of the queue, which the others cannot
/// change.
struct Wave {
  SampleBatch samples;
  RayQueue rays, next;     ///< of this level and the next
  HitBatch hits;           ///< of `rays`
  Column<Color> radiance;  ///< light found by each of `rays`, throughput included
  ShadowQueue shadows;     ///< owners are entries of `rays`
  unsigned level = 0;      ///< 0 = camera rays
  RayCounts counts;

  void clear();
};

/// Adds sample `number` of the pixel (x, y) of the full frame to the wave.
void add_sample(const RenderContext& context, Wave& wave, std::uint32_t pixel, std::uint32_t x,
                std::uint32_t y, std::uint32_t number);

/// Traces the samples to the end: fills their colour, alpha and first hit.
void trace_wave(const RenderContext& context, Wave& wave);

/// How a ray goes on from a surface.
enum class Bounce {
  reflected,
  refracted,
  straight,  ///< through a hole: not counted as a bounce
};

/// Adds to the next level the ray that leaves `p`, found by entry `ray` of this level, in `direction`. Rays
/// that could change the picture by less than anyone can see are dropped, and so are those beyond 256 of one
/// sample in one level.
void push_bounce(Wave& wave, std::size_t ray, const ShadingPoint& p, const Vec3f& direction,
                 const Color& throughput, Bounce bounce);

}  // namespace oktett
