#pragma once
/// \file The GGX microfacet distribution (Trowbridge and Reitz 1975; Walter 2007), isotropic, with Smith's
/// height-correlated masking and shadowing (Heitz 2014), in lanes.
///
/// All directions have unit length; z is the normal of the surface. `alpha` > 0 is the width of the
/// distribution: the root mean square of the facets' slopes has that order.

#include "core/elementary.h"
#include "core/lanes.h"

namespace oktett {

/// The density of facet normals `m`, per solid angle of `m`, such that the facets cover the surface once:
/// the integral of D(m) m.z is 1.
template <class D>
OKTETT_INLINE D ggx_density(const Vec3<D>& m, const D& alpha) {
  const D a2 = alpha * alpha;
  // From x and y rather than from 1 - z^2, which cancels near the normal.
  const D t = (m.x * m.x + m.y * m.y) + a2 * (m.z * m.z);
  return a2 / (D(std::numbers::pi) * t * t);
}

/// Smith's Lambda for GGX: the area of hidden facets relative to that of visible ones, from direction `w` on
/// either side of the surface (Heitz 2014, equation 72). Infinite along the surface.
template <class D>
OKTETT_INLINE D ggx_lambda(const Vec3<D>& w, const D& alpha) {
  const D tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z), a2t2 = alpha * alpha * tan2;
  const D root = sqrt(D(1.0) + a2t2), two(2.0);
  // (sqrt(1 + x) - 1) / 2 without cancellation.
  return select(a2t2 > D(1.0), (root - D(1.0)) / two, a2t2 / (two * (D(1.0) + root)));
}

/// How far down the cap of visible normals goes of which facets may reflect above the surface, relative to
/// the whole cap (Eto 2023).
template <class D>
OKTETT_INLINE D reflecting_bound(const Vec3<D>& w, const D& alpha) {
  const D s = D(1.0) + sqrt(w.x * w.x + w.y * w.y), s2 = s * s, a2 = alpha * alpha;
  return (D(1.0) - a2) * s2 / (s2 + a2 * w.z * w.z);
}

/// The reflected direction of ggx_normal with reflecting_bound, if it lies above the surface, has the
/// density D(m) times this.
template <class D>
OKTETT_INLINE D ggx_reflected_scale(const Vec3<D>& w, const D& alpha) {
  const D size = length_lanes(Vec3<D>{alpha * w.x, alpha * w.y, w.z});
  return D(1.0) / (D(2.0) * (reflecting_bound(w, alpha) * w.z + size));
}

/// A facet normal visible from `w`, w.z > 0, with density D(m) max(0, w.m) / ((1 + Lambda(w)) w.z): the point
/// (x: azimuth, y: height) of the cap from the pole down to z = -bound of a stretched sphere (Dupuy 2023).
/// `bound` is 1 or reflecting_bound.
template <class D>
OKTETT_INLINE Vec3<D> ggx_normal(const Vec3<D>& w, const D& alpha, const D& bound, const D& x, const D& y) {
  const Vec3<D> stretched = unit_lanes(Vec3<D>{alpha * w.x, alpha * w.y, w.z});
  // z = 1 - below; the sine from `below`, so that it keeps its digits near the pole.
  const D below = y * (D(1.0) + bound * stretched.z);
  const D size = sqrt(max(D(0.0), below * (D(2.0) - below)));
  D sine, cosine;
  sin_cos_of_turn(x, sine, cosine);
  const Vec3<D> halfway = Vec3<D>{size * cosine, size * sine, D(1.0) - below} + stretched;
  return unit_lanes(Vec3<D>{alpha * halfway.x, alpha * halfway.y, max(D(0.0), halfway.z)});
}

}  // namespace oktett
