#pragma once
/// \file Directions for the light that facets of glass send to each other, in lanes. It leaves them at
/// grazing angles if they are narrow.

#include "render/bsdf/lobe_lanes.h"

namespace oktett {

/// The cosine has a density in proportion to its power t: t = -1/2 for narrow facets, 0 for wider ones, 1 for
/// the widest. Of these, each has the least variance in its range of alpha.
inline constexpr double kNarrowFacets = 0.0625, kWideFacets = 0.16;

/// A direction above the surface.
template <class D>
Vec3<D> grazing_above(double alpha, const D& x, const D& y) {
  if (alpha > kWideFacets) return cosine_above(x, y);
  const D cosine = alpha > kNarrowFacets ? x : x * x, size = sqrt(D(1.0) - cosine * cosine);
  D sine_turn, cosine_turn;
  sin_cos_of_turn(y, sine_turn, cosine_turn);
  return {size * cosine_turn, size * sine_turn, cosine};
}

/// The density of `grazing_above` per solid angle.
template <class D>
D grazing_density(const D& cosine, double alpha) {
  if (alpha > kWideFacets) return cosine * D(1 / std::numbers::pi);
  if (alpha > kNarrowFacets) return D(1 / (2 * std::numbers::pi));
  return D(1.0) / (D(4 * std::numbers::pi) * sqrt(cosine));
}

}  // namespace oktett
