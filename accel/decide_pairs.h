#pragma once
/// \file The exact decision for pairs: each lane has a ray and a triangle of its own. Traversals that put
/// decisions off keep one candidate per ray and decide them here, all lanes busy.

#include "accel/leaf.h"

namespace oktett {

/// Ray i of `r` against triangle `triangle[i]` = block * TriangleBlock::kSize + lane, for all i at once: the
/// same bits as decide_watertight of the two alone. The rays may differ in their axes of greatest direction.
/// Returns a bit for each ray that meets its triangle at tmin < t <= tmax; lanes that serve nothing may name
/// any triangle and any finite ray.
template <int N, class A>
OKTETT_INLINE unsigned decide_pairs(const RayState<N, A>& r, const TriangleBlock* blocks,
                                    const std::uint32_t (&triangle)[N], HitLanes<Simd<float, N, A>>& hit) {
  using F = Simd<float, N, A>;
  using D = Simd<double, N, A>;
  constexpr std::uint32_t kSize = TriangleBlock::kSize;
  // Permuted while gathering: afterwards every lane's z is the axis of its own ray.
  alignas(64) float o[3][N], corner[3][3][N];
  for (int i = 0; i < N; ++i) {
    const int z = r.z_axis_of(i), x = z == 2 ? 0 : z + 1, y = z == 0 ? 2 : z - 1;
    const auto& v = blocks[triangle[i] / kSize].v;
    const std::uint32_t lane = triangle[i] % kSize;
    o[0][i] = r.o[x][i], o[1][i] = r.o[y][i], o[2][i] = r.o[z][i];
    for (int k = 0; k < 3; ++k)
      corner[k][0][i] = v[k][x][lane], corner[k][1][i] = v[k][y][lane], corner[k][2][i] = v[k][z][lane];
  }
  const auto load = [](const float(&columns)[3][N]) {
    return Vec3<F>{F::load(columns[0]), F::load(columns[1]), F::load(columns[2])};
  };
  const ShearLanes<D> shear{to_double(load(o)), D::load(r.inv_dz), D::load(r.shear_x), D::load(r.shear_y)};
  const TriangleLanes<F> tri{load(corner[0]), load(corner[1]), load(corner[2])};
  return bits(decide_watertight(shear, tri, F::load(r.tmin), F::load(r.tmax), hit));
}

}  // namespace oktett
