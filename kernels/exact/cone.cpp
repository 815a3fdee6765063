#include "kernels/exact/cone.h"

#include <algorithm>
#include <cmath>

#include "kernels/exact/cylinder.h"

namespace oktett {

void Cone::add(Pool& pool, const ConeShape& s, const ExactPlace& place) {
  const double axis = length(s.to - s.from), radius = std::max(s.from_radius, s.to_radius);
  if (!(s.from_radius >= 0 && s.to_radius >= 0 && radius > 0 && axis > 0)) return;
  if (!std::isfinite(radius) || !std::isfinite(axis)) return;
  const double r0 = s.from_radius / radius, r1 = s.to_radius / radius;
  add_element(pool, {0.5 * (r0 + r1), 0.5 * (r1 - r0), s.open},
              place.to_world * along_axis(s.from, s.to, radius), place);
  add_cell(pool, {-1, -1, -1}, {1, 1, 1});
}

Box Cone::world_bounds(const Pool& pool, std::size_t i) {
  const ConeElement& e = pool.elements[i];
  return frustum_bounds(pool.frames[i], e.middle - e.slope, e.middle + e.slope);
}

bool Cone::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  return slope_at<Cone>(pool, i, 0, p).value < 0 && std::abs(p.z) < 1;
}

SurfaceUv Cone::uv(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const ConeElement& e = pool.elements[i];
  const double radius = part == 1 ? e.middle - e.slope : e.middle + e.slope;
  return frustum_uv(part, radius > 0 ? radius : 1, p);
}

bool Cone::is_kept_by(const Affine& to_world) { return RoundFrame(to_world).is_round(); }

SurfaceNearest Cone::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p) {
  const ConeElement& e = pool.elements[i];
  RoundFrame frame(to_world);
  const double scale = frame.radial_scale();
  return closest_on_frustum(frame, (e.middle - e.slope) * scale, (e.middle + e.slope) * scale,
                            frame.axial_scale(), e.open, p);
}

}  // namespace oktett
