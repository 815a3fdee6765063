#include "kernels/exact/cyclide.h"

#include <algorithm>
#include <cmath>

#include "kernels/exact/surface_uv.h"

namespace oktett {

void Cyclide::add(Pool& pool, const CyclideShape& s, const ExactPlace& place) {
  const double size = s.major + s.minor + s.taper;
  if (!(s.major > s.taper && s.taper >= 0 && s.minor >= 0 && s.minor + s.taper > 0)) return;
  if (!std::isfinite(size)) return;
  const double a = s.major / size, c = s.taper / size, d = s.minor / size;
  const CyclideElement e{a, std::sqrt((a - c) * (a + c)), c, d};
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
  // The solid lies in the balls of radius a + d about (-c, 0, 0) and |a - d| about (c, 0, 0).
  add_cell(pool, {-1, -(a + d), -(c + d)}, {std::max(a + d - c, a - d + c), a + d, c + d});
}

SurfaceUv Cyclide::uv(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const CyclideElement& e = pool.elements[i];
  const SpaceFunction across = component(p, 0) * e.a - e.c * e.d, along = component(p, 1) * e.b;
  const SpaceFunction out{0.5 * (dot(p, p) - e.b * e.b - e.d * e.d), p};
  return {turn_of(along, across), turn_of(component(p, 2) * e.b, out)};
}

}  // namespace oktett
