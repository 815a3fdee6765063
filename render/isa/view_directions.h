#pragma once
/// \file view_directions for one instruction set.

#include <algorithm>

#include "core/lanes.h"
#include "core/simd_native.h"
#include "render/transport/render_code.h"

namespace oktett {

/// In groups of eight points; one at a time without vector registers.
template <class A>
void view_directions_code(const ViewPlane& plane, const ViewPoints& points) {
  constexpr int W = kDoubleLanes<A>;
  using D = Simd<double, W, A>;
  const Vec3<D> corner = broadcast<D>(plane.corner), across = broadcast<D>(plane.per_pixel_x),
                down = broadcast<D>(plane.per_pixel_y);
  const auto directions = [&](const double* x_column, const double* y_column, float* out_x, float* out_y,
                              float* out_z) {
    const D x = D::load(x_column), y = D::load(y_column);
    const Vec3<D> place{corner.x + across.x * x + down.x * y, corner.y + across.y * x + down.y * y,
                        corner.z + across.z * x + down.z * y};
    const auto direction = float_quotients(place, sqrt(dot_lanes(place, place)));
    direction.x.store(out_x), direction.y.store(out_y), direction.z.store(out_z);
  };
  float* const* out = points.direction;
  std::size_t i = 0;
  for (; i + W <= points.count; i += W)
    directions(points.x + i, points.y + i, out[0] + i, out[1] + i, out[2] + i);
  if (i == points.count) return;
  double x[W] = {}, y[W] = {};
  float d[3][W];
  const std::size_t rest = points.count - i;
  for (std::size_t k = 0; k < rest; ++k) x[k] = points.x[i + k], y[k] = points.y[i + k];
  directions(x, y, d[0], d[1], d[2]);
  for (std::size_t k = 0; k < rest; ++k)
    for (int axis = 0; axis < 3; ++axis) out[axis][i + k] = d[axis][k];
}

}  // namespace oktett
