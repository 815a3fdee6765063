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
/// long.
RayBatch diffuse_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds, int count,
                      float reach);

}  // namespace oktett::bench
