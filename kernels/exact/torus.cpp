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

}  // namespace oktett
