#pragma once
/// \file Surfaces of groups of mesh hits, for one instruction set.

#include "accel/surface/interaction_code.h"
#include "core/simd_memory.h"

namespace oktett {

/// Without vector registers one hit at a time.
template <class A>
void mesh_surfaces_code(const MeshHits& hits) {
  constexpr int W = std::is_same_v<A, ScalarIsa> ? 1 : 8;
  using F = Simd<float, W, A>;
  for (std::size_t i = 0; i < hits.count; i += W) {
    const auto load = [i](const float(&column)[3][MeshHits::kMost]) {
      return Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
    };
    const PickedLanes<F> entry(hits.entry + i);
    const auto store = [&](const Vec3<F>& v, float(&column)[3][InteractionBlock::kMost]) {
      entry.store(v.x, column[0]), entry.store(v.y, column[1]), entry.store(v.z, column[2]);
    };
    Vec3<F> corners[3], normals[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = place_corner(hits.frame, load(hits.corner[k]));
      if (hits.frame.smooth) normals[k] = load(hits.normal[k]);
    }
    const MeshSurface<F> s =
        mesh_surface(hits.frame, corners, normals, F::load(hits.u + i), F::load(hits.v + i));
    store(s.position, hits.out->position), store(s.position_error, hits.out->position_error);
    store(s.geometric_normal, hits.out->geometric_normal), store(s.shading_normal, hits.out->shading_normal);
  }
}

}  // namespace oktett
