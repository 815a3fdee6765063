#pragma once
/// \file Rays of cameras, for one instruction set.

#include <algorithm>
#include <numbers>

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/simd_native.h"
#include "render/camera.h"
#include "render/sampling/owen_sobol.h"
#include "render/transport/render_code.h"

namespace oktett {

// ---- Points of Sobol's sequence for consecutive samples.

/// sobol_point for the samples [first, last) of one sequence. Plain loops of fixed length, which compilers
/// turn into vector code.
template <class A>
void sobol_points_code(std::uint32_t first, std::uint32_t last, std::uint64_t key, double* x, double* y) {
  constexpr std::uint32_t kGroup = 16;
  const auto seed_x = static_cast<std::uint32_t>(key), seed_y = static_cast<std::uint32_t>(key >> 32);
  for (std::uint32_t begin = first; begin < last; begin += kGroup) {
    std::uint32_t number[kGroup];
    double at[2][kGroup];
    for (std::uint32_t k = 0; k < kGroup; ++k) number[k] = shuffled_sample(begin + k, key);
    for (std::uint32_t k = 0; k < kGroup; ++k)
      at[0][k] = reversed_bits(scrambled_upwards(number[k], seed_x)) * 0x1p-32;
    for (std::uint32_t k = 0; k < kGroup; ++k)
      at[1][k] = reversed_bits(scrambled_upwards(pascal_product(number[k]), seed_y)) * 0x1p-32;
    const std::uint32_t count = std::min(kGroup, last - begin);
    for (std::uint32_t k = 0; k < count; ++k) x[begin - first + k] = at[0][k];
    for (std::uint32_t k = 0; k < count; ++k) y[begin - first + k] = at[1][k];
  }
}

// ---- Rays of a camera with a lens.

/// disk_point in lanes, with the same bits.
template <class D>
OKTETT_INLINE void disk_points(const D& u, const D& v, D& x, D& y) {
  constexpr double kQuarter = std::numbers::pi / 4;
  const D zero(0.0), a = D(2.0) * u - D(1.0), b = D(2.0) * v - D(1.0);
  const auto wide = abs(b) < abs(a);
  const D radius = select(wide, a, b);
  const D angle = D(kQuarter) * (select(wide, b, a) / radius);
  // At an eighth of a turn portable::sin and portable::cos count from the quarter.
  const auto end = angle == D(kQuarter);
  const D rest = select(end, zero - angle, angle), sine = sin_of_eighth(rest), cosine = cos_of_eighth(rest);
  const D along = radius * select(end, zero - sine, cosine), across = radius * select(end, cosine, sine);
  const auto middle = radius == zero;
  x = select(middle, zero, select(wide, along, across));
  y = select(middle, zero, select(wide, across, along));
}

/// In groups of eight points; one at a time without vector registers.
template <class A>
void lens_rays_code(const CameraFrame& camera, const FilmPoints& points, RayBatch& rays) {
  constexpr int W = kDoubleLanes<A>;
  using D = Simd<double, W, A>;
  const auto wide = [](const Vec3d& v) { return broadcast<D>(v); };
  const Vec3<D> corner = wide(camera.corner), per_x = wide(camera.per_pixel_x),
                per_y = wide(camera.per_pixel_y), right = wide(camera.right), up = wide(camera.up),
                ahead = wide(camera.forward * camera.focus), middle = wide(camera.origin);
  const bool perspective = camera.projection == Projection::perspective;
  const D size(camera.lens_radius), focus(camera.focus);
  const std::size_t count = rays.size();
  for (std::size_t i = 0; i < count; i += W) {
    const std::size_t lanes = std::min<std::size_t>(W, count - i);
    const auto load = [&](const Column<double>& column) {
      if (lanes == W) return D::load(column.data() + i);
      double filled[W] = {};
      std::copy_n(column.data() + i, lanes, filled);
      return D::load(filled);
    };
    D disk_x, disk_y;
    disk_points(load(*points.lens_x), load(*points.lens_y), disk_x, disk_y);
    const Vec3<D> lens = add_lanes(scale_lanes(right, size * disk_x), scale_lanes(up, size * disk_y));
    const Vec3<D> place =
        add_lanes(add_lanes(corner, scale_lanes(per_x, load(points.x))), scale_lanes(per_y, load(points.y)));
    const Vec3<D> from = perspective ? lens : add_lanes(lens, place);
    const Vec3<D> to = perspective ? scale_lanes(place, focus) : add_lanes(place, ahead);
    const Vec3<D> way = sub_lanes(to, from);
    const auto origin = to_float(add_lanes(middle, from));
    const auto direction = float_quotients(way, sqrt(dot_lanes(way, way)));
    const auto store_part = [&](const auto& part, Column<float>& column) {
      if (lanes == W) return part.store(column.data() + i);
      float stored[W];
      part.store(stored);
      std::copy_n(stored, lanes, column.data() + i);
    };
    const auto store = [&](const auto& v, Column<float>* columns) {
      store_part(v.x, columns[0]), store_part(v.y, columns[1]), store_part(v.z, columns[2]);
    };
    store(origin, rays.origin), store(direction, rays.direction);
  }
}

// ---- Directions of a pinhole camera.

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
