#pragma once
/// \file What the lobes of all materials share: results, choice of a lobe, Fresnel's equations, in lanes of
/// doubles D. Single surfaces use them with one lane, so a surface gets the same bits alone and in a group.

#include "core/affine_lanes.h"
#include "core/lane_math.h"

namespace oktett {

/// The lanes of floats that go with lanes of doubles.
template <class D>
using FloatsOf = Simd<float, D::kWidth, typename D::Isa>;

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

/// fresnel of render/bsdf/optics.h in lanes.
template <class D>
OKTETT_INLINE D fresnel_lanes(const D& cosine, const D& eta) {
  const D sin2_out = (D(1.0) - cosine * cosine) / (eta * eta);
  const D cos_out = sqrt(max(D(0.0), D(1.0) - sin2_out));
  const D parallel = (eta * cosine - cos_out) / (eta * cosine + cos_out);
  const D perpendicular = (cosine - eta * cos_out) / (cosine + eta * cos_out);
  return select(sin2_out >= D(1.0), D(1.0), (parallel * parallel + perpendicular * perpendicular) * D(0.5));
}

/// conductor_fresnel in lanes.
template <class D>
OKTETT_INLINE D conductor_fresnel_lanes(const D& cosine, double eta, double k) {
  const D c2 = cosine * cosine, s2 = D(1.0) - c2;
  const D t = D(eta * eta - k * k) - s2;
  const D sum = sqrt(t * t + D(4 * eta * eta * k * k));
  const D twice = D(2.0) * cosine * sqrt(max(D(0.0), (sum + t) * D(0.5)));
  const D perpendicular = (sum + c2 - twice) / (sum + c2 + twice);
  const D far = c2 * sum + s2 * s2, near = twice * s2;
  const D parallel = (far - near) / (far + near);
  return within(perpendicular * (D(1.0) + parallel) * D(0.5), D(0.0), D(1.0));
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
