#include "kernels/exact/torus.h"

#include <cmath>

#include "kernels/exact/surface_uv.h"

namespace oktett {

void Torus::add(Pool& pool, const TorusShape& s, const ExactPlace& place) {
  const double size = s.major + s.minor;
  if (!(s.major >= 0 && s.minor > 0 && std::isfinite(size))) return;
  const TorusElement e{s.major / size, s.minor / size};
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
  add_cell(pool, {-1, -1, -e.minor}, {1, 1, e.minor});
}

SurfaceUv Torus::uv(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const TorusElement& e = pool.elements[i];
  const SpaceFunction rho = radius_of(component(p, 0), component(p, 1));
  return {turn_around_z(p), turn_of(component(p, 2), rho - e.major)};
}

bool Torus::is_kept_by(const Affine& to_world) { return RoundFrame(to_world).is_similar(); }

SurfaceNearest Torus::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p) {
  RoundFrame frame(to_world);
  const double scale = frame.radial_scale();
  const double major = pool.elements[i].major * scale, minor = pool.elements[i].minor * scale;
  const HalfPlanePoint at = frame.in_profile(p);
  // The profile is a circle about (major, 0), cut off at the axis. To its centre the outermost point is
  // nearest.
  HalfPlanePoint n{at.rho - major, at.z};
  const double away = std::sqrt(n.rho * n.rho + n.z * n.z);
  n = away > 0 ? HalfPlanePoint{n.rho / away, n.z / away} : HalfPlanePoint{1, 0};
  const HalfPlanePoint foot{major + minor * n.rho, minor * n.z};
  if (foot.rho >= 0) return frame.in_world({(away - minor) * (away - minor), foot, n});
  // Beyond the ends of the arc, which lie on the axis.
  const double end = std::sqrt((minor - major) * (minor + major));
  const HalfPlanePoint tip{0, at.z < 0 ? -end : end};
  const double rise = at.z - tip.z;
  return frame.in_world({at.rho * at.rho + rise * rise, tip, {-major, tip.z}});
}

}  // namespace oktett
