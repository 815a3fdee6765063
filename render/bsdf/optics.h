#pragma once
/// \file Mirrors, dielectrics and conductors: where light goes, and how much of it. All vectors have unit
/// length. In lanes of floats F or doubles D; single directions are one lane.

#include <optional>

#include "core/elementary.h"
#include "core/lanes.h"

namespace oktett {

/// The lanes of floats that go with lanes of doubles.
template <class D>
using FloatsOf = Simd<float, D::kWidth, typename D::Isa>;

/// The direction in which a ray along `d` leaves a mirror of shading normal `n`, which may differ from the
/// geometric normal `ng` (both on the side `d` comes from): if the mirrored direction would go below the true
/// surface it is folded back above it.
template <class F>
OKTETT_INLINE Vec3<F> reflect_above_lanes(const Vec3<F>& d, const Vec3<F>& n, const Vec3<F>& ng) {
  const F two(2.0f);
  const Vec3<F> r = unit_lanes(sub_lanes(d, scale_lanes(n, two * dot_lanes(d, n))));
  const F height = dot_lanes(r, ng);
  const auto below = height < F(0.0f);
  if (none(below)) return r;
  return select_lanes(below, unit_lanes(sub_lanes(r, scale_lanes(ng, two * height))), r);
}

/// The direction in which a ray along `d` continues behind an interface of normal `n`, dot(d, n) <= 0, by
/// Snell's law. `eta` is the index of refraction behind the interface relative to that before it. Returns the
/// lanes in which there is such a direction, as not all light is reflected.
template <int W, class A>
OKTETT_INLINE Mask<float, W, A> refract_lanes(const Vec3<Simd<float, W, A>>& d,
                                              const Vec3<Simd<float, W, A>>& n, const Simd<float, W, A>& eta,
                                              Vec3<Simd<float, W, A>>& out) {
  using D = Simd<double, W, A>;
  const Vec3<D> dd = to_double(d), nd = to_double(n);
  const D one(1.0), ratio = one / to_double(eta);
  const D cos_in = -dot_lanes(dd, nd);
  const D sin2_out = ratio * ratio * (one - cos_in * cos_in);
  const D cos_out = sqrt(max(one - sin2_out, D(0.0)));
  const Vec3<D> bent = add_lanes(scale_lanes(dd, ratio), scale_lanes(nd, ratio * cos_in - cos_out));
  const auto straight = eta == Simd<float, W, A>(1.0f);
  out = select_lanes(straight, d, float_quotients(bent, length_lanes(bent)));
  return straight | ~mask_cast<float>(one <= sin2_out);
}

/// The fraction of unpolarised light that an interface between dielectrics reflects, by Fresnel's equations:
/// 1 beyond the critical angle. `cosine` is that of the angle of incidence, [0, 1].
template <class D>
OKTETT_INLINE D fresnel_lanes(const D& cosine, const D& eta) {
  const D sin2_out = (D(1.0) - cosine * cosine) / (eta * eta);
  const D cos_out = sqrt(max(D(0.0), D(1.0) - sin2_out));
  const D parallel = (eta * cosine - cos_out) / (eta * cosine + cos_out);
  const D perpendicular = (cosine - eta * cos_out) / (cosine + eta * cos_out);
  return select(sin2_out >= D(1.0), D(1.0), (parallel * parallel + perpendicular * perpendicular) * D(0.5));
}

/// The same for a conductor of complex index of refraction eta + i k, relative to the medium before it, eta >
/// 0 (Born 1999, section 14.2).
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

// ---- Single directions

inline Vec3f reflect_above(const Vec3f& d, const Vec3f& n, const Vec3f& ng) {
  using F = Simd<float, 1, ScalarIsa>;
  return only_lane(reflect_above_lanes(broadcast<F>(d), broadcast<F>(n), broadcast<F>(ng)));
}

inline std::optional<Vec3f> refract(const Vec3f& d, const Vec3f& n, float eta) {
  using F = Simd<float, 1, ScalarIsa>;
  Vec3<F> out;
  if (none(refract_lanes(broadcast<F>(d), broadcast<F>(n), F(eta), out))) return std::nullopt;
  return only_lane(out);
}

inline double fresnel(double cosine, double eta) {
  using D = Simd<double, 1, ScalarIsa>;
  return only_lane(fresnel_lanes(D(cosine), D(eta)));
}

inline double conductor_fresnel(double cosine, double eta, double k) {
  using D = Simd<double, 1, ScalarIsa>;
  return only_lane(conductor_fresnel_lanes(D(cosine), eta, k));
}

}  // namespace oktett
