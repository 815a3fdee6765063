#pragma once
/// \file A sphere against the groups of a beam in float: which rays surely miss it, and which surely hit it.
/// The bounds are derived in docs/numerics.md.

#include <cmath>

#include "accel/traverse/beam/beam_rays.h"
#include "kernels/closed/sphere.h"

namespace oktett {

/// A sphere as seen from the apex. The line (x, y) passes its centre at a distance whose square is
/// depth^2 (dx^2 + dy^2 + (dx y - dy x)^2) / (1 + x^2 + y^2), with (dx, dy) the distance from the centre.
struct BeamSphere {
  float x, y;          ///< the centre
  float outer, inner;  ///< squares of the radius over the depth, more and less by the error
  float near, far;     ///< bounds of its depth
  bool may_be_sure;    ///< the whole sphere is farther than 1 / near_s, see BeamRays

  /// False if the sphere is too near or too large for the bounds.
  template <class A>
  OKTETT_INLINE bool set(const Sphere::Pool& pool, std::uint32_t k, const BeamRays<A>& beam) {
    const double c[3] = {pool.x[k], pool.y[k], pool.z[k]}, radius = pool.radius[k];
    double m[3];
    for (int i = 0; i < 3; ++i) m[i] = c[beam.axis[i]] - beam.apex[i];
    if (beam.mirrored) m[2] = -m[2];
    const double inverse = 1 / m[2], cx = m[0] * inverse, cy = m[1] * inverse, size = radius * inverse;
    if (!(m[2] > 0 && size <= 0.5 && std::fabs(cx) <= 4 && std::fabs(cy) <= 4)) return false;
    const double spread = std::max({double{beam.spread}, std::fabs(cx), std::fabs(cy)});
    const double error = 0x1p-20 * spread * (1 + spread) + 0x1p-19 * size +
                         4 * (double{beam.slip} + beam.behind + beam.margin) * inverse;
    x = static_cast<float>(cx), y = static_cast<float>(cy);
    const double more = size + error, less = size - error;
    outer = static_cast<float>(more * more), inner = less > 0 ? static_cast<float>(less * less) : 0.0f;
    near = static_cast<float>((m[2] - radius) * (1 - 0x1p-20)),
    far = static_cast<float>((m[2] + radius) * (1 + 0x1p-20));
    may_be_sure = near * beam.near_s > 1 + 0x1p-20f;
    return error < 1;
  }

  template <class A>
  OKTETT_INLINE void filter(const BeamRays<A>& beam, unsigned groups, BeamLanes& lanes) const {
    using F = Simd<float, kBeamGroup, A>;
    const F one(1.0f);
    for (; groups != 0; groups &= groups - 1) {
      const int g = __builtin_ctz(groups), base = g * kBeamGroup;
      const F rx = F::load(beam.x + base), ry = F::load(beam.y + base), dx = rx - F(x), dy = ry - F(y);
      const F turn = fast_fms(dx, ry, dy * rx), square = fast_fma(dx, dx, fast_fma(dy, dy, turn * turn));
      const F length = fast_fma(rx, rx, fast_fma(ry, ry, one));
      // A ray that has met something before the sphere begins misses it, too.
      const auto misses = (F(outer) * length < square) | (one < F(near) * F::load(beam.hit_lo + base));
      const auto sure = (square < F(inner) * length) & (F(far) * F::load(beam.hit_hi + base) < one);
      const unsigned maybe = lanes.maybe[g] & ~bits(misses);
      lanes.maybe[g] = static_cast<std::uint16_t>(maybe);
      lanes.sure[g] = static_cast<std::uint16_t>(may_be_sure ? maybe & bits(sure) : 0);
    }
  }
};

}  // namespace oktett
