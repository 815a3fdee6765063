#pragma once
/// \file The GGX microfacet distribution (Trowbridge and Reitz 1975; Walter 2007), isotropic, with Smith's
/// height-correlated masking and shadowing (Heitz 2014).
///
/// All directions have unit length; z is the normal of the surface. `alpha` > 0 is the width of the
/// distribution: the root mean square of the facets' slopes has that order.

#include <cmath>
#include <numbers>

#include "core/vec3.h"
#include "render/sampling/square_sample.h"

namespace oktett {

/// The density of facet normals `m`, per solid angle of `m`, such that the facets cover the surface once:
/// the integral of D(m) m.z is 1.
inline double ggx_density(const Vec3d& m, double alpha) {
  const double a2 = alpha * alpha;
  // From x and y rather than from 1 - z^2, which cancels near the normal.
  const double t = (m.x * m.x + m.y * m.y) + a2 * (m.z * m.z);
  return a2 / (std::numbers::pi * t * t);
}

/// Smith's Lambda for GGX: the area of hidden facets relative to that of visible ones, from direction `w` on
/// either side of the surface (Heitz 2014, equation 72). Infinite along the surface.
inline double ggx_lambda(const Vec3d& w, double alpha) {
  const double tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  const double a2t2 = alpha * alpha * tan2;
  // (sqrt(1 + x) - 1) / 2 without cancellation.
  return a2t2 > 1 ? (std::sqrt(1 + a2t2) - 1) / 2 : a2t2 / (2 * (1 + std::sqrt(1 + a2t2)));
}

/// A facet normal with the density of normals visible from `w`, w.z > 0: D(m) max(0, w.m) / ((1 + Lambda(w))
/// w.z) (Dupuy 2023: normals of a sphere's visible cap, stretched).
Vec3d ggx_visible_normal(const Vec3d& w, double alpha, const SquareSample& u);

/// The same for reflection: most normals that reflect below the surface are left out (Eto 2023). The
/// reflected direction, if it lies above the surface, has the density D(m) ggx_reflected_scale(w).
Vec3d ggx_reflecting_normal(const Vec3d& w, double alpha, const SquareSample& u);
double ggx_reflected_scale(const Vec3d& w, double alpha);

}  // namespace oktett
