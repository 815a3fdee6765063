#pragma once
/// \file lens_rays for one instruction set.

#include <algorithm>
#include <numbers>

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/simd_native.h"
#include "render/camera.h"

namespace oktett {

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

}  // namespace oktett
