#include "kernels/exact/torus.h"

#include <cmath>

#include "kernels/exact/round_uv.h"

namespace oktett {

void Torus::add(Pool& pool, const TorusShape& s, const ExactPlace& place) {
  const double size = s.major + s.minor;
  if (!(s.major >= 0 && s.minor > 0 && std::isfinite(size))) return;
  const TorusElement e{s.major / size, s.minor / size};
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
  add_cell(pool, {-1, -1, -e.minor}, {1, 1, e.minor});
}

void Torus::uv(const Pool& pool, std::size_t i, int, const Vec3d& p, SurfaceInteraction& s) {
  const TorusElement& e = pool.elements[i];
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  set_uv_around_z(s, p, turn_of(p.z, rho - e.major));
}

}  // namespace oktett
