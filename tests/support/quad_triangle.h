#pragma once
/// \file The distance of a point from a triangle with far more digits than double has.

#include <array>

#include "core/vec3.h"

namespace oktett {

#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 Quad;
#else
using Quad = long double;
#endif

inline Vec3<Quad> to_quad(const Vec3d& v) { return {Quad(v.x), Quad(v.y), Quad(v.z)}; }

/// The least squared distance by other means than the kernel's: the normal equations of the face, then the
/// edges and corners.
inline Quad quad_distance2(const Vec3d& point, const std::array<Vec3d, 3>& corners) {
  const Vec3<Quad> p = to_quad(point);
  const std::array<Vec3<Quad>, 3> v{to_quad(corners[0]), to_quad(corners[1]), to_quad(corners[2])};
  const auto square = [](const Vec3<Quad>& a) { return dot(a, a); };
  Quad least = square(p - v[0]);
  const auto take = [&](Quad d2) { least = d2 < least ? d2 : least; };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3<Quad> a = v[k], e = v[(k + 1) % 3] - a;
    take(square(p - a));
    const Quad t = dot(p - a, e), length = dot(e, e);
    if (t > 0 && t < length) take(square(p - a - e * (t / length)));
  }
  const Vec3<Quad> e1 = v[1] - v[0], e2 = v[2] - v[0], f = p - v[0];
  const Quad a = dot(e1, e1), b = dot(e1, e2), c = dot(e2, e2), d = dot(f, e1), e = dot(f, e2);
  const Quad det = a * c - b * b;
  if (det > 0) {
    const Quad u = (c * d - b * e) / det, w = (a * e - b * d) / det;
    if (u >= 0 && w >= 0 && u + w <= 1) take(square(f - e1 * u - e2 * w));
  }
  return least;
}

}  // namespace oktett
