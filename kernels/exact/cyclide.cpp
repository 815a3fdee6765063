#include "kernels/exact/cyclide.h"

#include <algorithm>
#include <cmath>

#include "kernels/exact/round_uv.h"

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

void Cyclide::uv(const Pool& pool, std::size_t i, int, const Vec3d& p, SurfaceInteraction& s) {
  const CyclideElement& e = pool.elements[i];
  const double across = e.a * p.x - e.c * e.d, along = e.b * p.y;
  const double out = 0.5 * (dot(p, p) - e.b * e.b - e.d * e.d);
  set_uv(s, turn_of(along, across), turn_of(e.b * p.z, out));
  // Circles of equal u lie in planes through the line x = c d / a, y = 0; those of equal v are perpendicular
  // to them. So the tangent is the normal of the plane without its part along that of the surface.
  const Vec3d plane{-e.a * along, e.b * across, 0}, n = slope_at<Cyclide>(pool, i, 0, p).gradient;
  const double nn = dot(n, n);
  const Vec3d t = nn > 0 ? plane - n * (dot(plane, n) / nn) : plane;
  const double turn = (across * e.b * t.y - along * e.a * t.x) / (across * across + along * along);
  s.tangent = Vec3f(t * (2 * std::numbers::pi / turn));
}

}  // namespace oktett
