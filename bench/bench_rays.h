#pragma once
/// \file The rays that benchmarks trace: camera rays over a framed mesh, and rays from their hits.

#include "accel/accel.h"
#include "core/random.h"

namespace oktett::bench {

/// A square picture of a mesh, from outside (all of it in view) or from the middle of its bounds.
struct View {
  int resolution = 1024;  ///< multiple of 16
  bool inside = false;
};

/// One ray through the centre of each pixel, in tiles of 16x16 pixels of 4x4 blocks.
RayBatch primary_rays(const Box& bounds, const View& view);

/// For each hit of `rays`: a ray to a point light above the mesh.
RayBatch shadow_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds,
                     const View& view);

/// For each hit of `rays`: `count` rays in cosine-distributed directions about the normal, at most `reach`
/// long. Another `seed` gives other directions.
RayBatch diffuse_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds, int count,
                      float reach, std::uint32_t seed = 0);

/// The second to the fourth bounce of diffuse paths, whose first bounce leaves the hits of `rays`: all rays
/// of a bounce after those of the bounce before, in the order of the paths.
RayBatch bounce_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds, Isa isa);

/// `count` random segments, each from one face of a box to another; the box is a little smaller than
/// `bounds`.
RayBatch random_segments(const Box& bounds, std::size_t count);

}  // namespace oktett::bench
