#pragma once
/// \file Samples of emitters in lanes, see emitter.h: what all kinds share. Single points use one lane.

#include "core/elementary.h"
#include "core/lanes.h"
#include "render/light/emitter.h"
#include "render/light/emitter_kinds.h"

namespace oktett {

/// LightSample in lanes, without what is known of the emitter.
template <class D>
struct LightSamples {
  using F = Simd<float, D::kWidth, typename D::Isa>;
  Vec3<F> direction;
  F distance, pdf;
  D u, v;
  typename F::M found;  ///< the other lanes hold no defined values
};

/// sample_at of emitter_kinds.h in lanes; the light must be finite.
template <class D>
OKTETT_INLINE LightSamples<D> samples_at(const Vec3<D>& to, const D& pdf, const D& u, const D& v) {
  using F = typename LightSamples<D>::F;
  const D size = length_lanes(to);
  const F most(3.4e38f), zero(0.0f);
  LightSamples<D> s;
  s.direction = to_float(Vec3<D>{to.x / size, to.y / size, to.z / size});
  s.distance = to_float(size), s.pdf = to_float(pdf), s.u = u, s.v = v;
  s.found = (zero < s.distance) & (s.distance < most) & (zero < s.pdf) & (s.pdf < most);
  return s;
}

/// One lane, for single points.
using Lane = Simd<double, 1, ScalarIsa>;

/// The sample in a single lane.
std::optional<LightSample> only_sample(const LightSamples<Lane>& s, const Color& radiance);

/// The unit vectors at angles from the unit vectors `axis` whose cosines are 1 - `one_minus_cos`. `turn` in
/// [0, 1) goes once around.
template <class D>
OKTETT_INLINE Vec3<D> around_lanes(const Vec3<D>& axis, const D& one_minus_cos, const D& turn) {
  Vec3<D> tangent, bitangent;
  basis_lanes(axis, tangent, bitangent);
  const D size = sqrt(max(D(0.0), one_minus_cos * (D(2.0) - one_minus_cos)));
  D sine, cosine;
  sin_cos_of_turn(turn, sine, cosine);
  return tangent * (size * cosine) + bitangent * (size * sine) + axis * (D(1.0) - one_minus_cos);
}

}  // namespace oktett
