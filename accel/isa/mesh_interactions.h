#pragma once
/// \file Surfaces of groups of mesh hits, for one instruction set.

#include "accel/surface/mesh_hits.h"

namespace oktett {

/// Without vector registers one hit at a time.
template <class A>
void mesh_surfaces_code(MeshHits& hits) {
  constexpr int W = std::is_same_v<A, ScalarIsa> ? 1 : 8;
  using F = Simd<float, W, A>;
  for (std::size_t i = 0; i < hits.count; i += W) {
    const auto load = [i](const float(&column)[3][MeshHits::kMost]) {
      return Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
    };
    const auto store = [i](const Vec3<F>& v, float(&column)[3][MeshHits::kMost]) {
      v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
    };
    Vec3<F> corners[3], normals[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = place_corner(hits.frame, load(hits.corner[k]));
      if (hits.frame.smooth) normals[k] = load(hits.normal[k]);
    }
    const MeshSurface<F> s =
        mesh_surface(hits.frame, corners, normals, F::load(hits.u + i), F::load(hits.v + i));
    store(s.position, hits.position), store(s.position_error, hits.position_error);
    store(s.geometric_normal, hits.geometric_normal), store(s.shading_normal, hits.shading_normal);
  }
}

}  // namespace oktett
