#pragma once
/// \file What the lobes of all materials share: limits of their parameters, results and the choice of a lobe.
/// Lobes compute in lanes of doubles D. Single surfaces use them with one lane, so a surface gets the same
/// bits alone and in a group.

#include <algorithm>

#include "core/affine_lanes.h"
#include "core/lane_math.h"
#include "render/bsdf/optics.h"

namespace oktett {

/// Scattering from one direction.
struct BsdfValue {
  Color value;    ///< f |cos(wi)|, the sum of all lobes that are not delta
  float pdf = 0;  ///< density per solid angle of `sample` choosing wi by those lobes
};

/// A sampled direction.
struct BsdfSample {
  Vec3f direction;
  Color weight;              ///< value / pdf; for delta lobes their coefficient / probability
  float pdf = 0;             ///< as in BsdfValue; 0 for delta lobes
  bool delta = false;        ///< the direction is one of finitely many
  bool transmitted = false;  ///< the direction leads below the surface
};

/// `x` within [least, most]; `least` for NaN.
inline double limited(double x, double least, double most) { return x > least ? std::min(x, most) : least; }
inline Vec3d limited(const Color& c, double least, double most) {
  return {limited(c.x, least, most), limited(c.y, least, most), limited(c.z, least, most)};
}

/// BsdfValue in lanes.
template <class D>
struct BsdfValues {
  Vec3<FloatsOf<D>> value;
  FloatsOf<D> pdf;
};

/// BsdfSample in lanes. The members of lanes that are not `found` hold no defined value.
template <class D>
struct BsdfSamples {
  using M = typename FloatsOf<D>::M;
  Vec3<FloatsOf<D>> direction, weight;
  FloatsOf<D> pdf;  ///< 0: a delta lobe
  M found;
  M transmitted;
};

/// The direction to a viewer, of unit length in double and not below or along the surface.
template <class D>
OKTETT_INLINE Vec3<D> direction_above(const Vec3<FloatsOf<D>>& wo) {
  const Vec3<D> w = to_double(wo);
  return unit_lanes(Vec3<D>{w.x, w.y, max(D(1e-6), w.z)});
}

/// A direction above the surface with density cos / pi, from a point of the unit square.
template <class D>
OKTETT_INLINE Vec3<D> cosine_above(const D& x, const D& y) {
  const D radius = sqrt(x);
  D sine, cosine;
  sin_cos_of_turn(y, sine, cosine);
  return {radius * cosine, radius * sine, sqrt(D(1.0) - x)};
}

/// Probabilities of N lobes.
template <class D, int N>
class LobeChances {
 public:
  LobeChances() {
    for (D& p : probability_) p = D(0.0);
  }
  D& operator[](int lobe) { return probability_[lobe]; }
  const D& operator[](int lobe) const { return probability_[lobe]; }

  /// Scales weights >= 0 to probabilities.
  OKTETT_INLINE void normalize() {
    D sum(0.0);
    for (const D& p : probability_) sum = sum + p;
    const auto some = sum > D(0.0);
    for (D& p : probability_) p = select(some, p / sum, D(0.0));
  }

  /// The number of the lobe at place `u` in [0, 1); `u` becomes the place within that lobe, [0, 1). -1 if
  /// there is none.
  OKTETT_INLINE D pick(D& u) const {
    const D zero(0.0);
    D chosen(-1.0), begin = zero, end = zero, size(1.0);
    auto done = zero < zero;
    for (int i = 0; i < N; ++i) {
      const D& p = probability_[i];
      const auto here = (p > zero) & ~done;
      chosen = select(here, D(i), chosen), size = select(here, p, size);
      begin = select(here, end, begin), end = select(here, end + p, end);
      done = done | (here & (u < end));
    }
    u = within((u - begin) / size, zero, D(1 - 0x1p-53));
    return chosen;
  }

 private:
  D probability_[N];
};

}  // namespace oktett
