#include "kernels/exact/torus.h"

#include <cmath>
#include <numbers>

#include "core/math.h"

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
  s.uv = {static_cast<float>(0.5 + portable::atan2(p.y, p.x) * 0.5 / std::numbers::pi),
          static_cast<float>(0.5 + portable::atan2(p.z, rho - e.major) * 0.5 / std::numbers::pi)};
  s.tangent = Vec3f(Vec3d{-p.y, p.x, 0} * (2 * std::numbers::pi));
}

}  // namespace oktett
