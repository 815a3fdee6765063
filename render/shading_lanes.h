#pragma once
/// \file The formulas of local shading, in lanes: which way normals face, the way to a light, Phong's
/// cosines.

#include "core/lanes.h"
#include "render/shading_columns.h"

namespace oktett {

/// tmax of shadow rays whose direction is the vector to the light: they end just before it.
inline constexpr float kBeforeLight = 1 - 0x1p-24f;

/// Turns the normals of surfaces towards the origins of rays along `direction`: `n` to `ng`, `shading` to
/// `ns`. Returns the lanes in which `n` pointed away from the origin.
template <class F>
OKTETT_INLINE typename F::M face_ray(const Vec3<F>& direction, const Vec3<F>& n, const Vec3<F>& shading,
                                     Vec3<F>& ng, Vec3<F>& ns) {
  const F zero(0.0f), one(1.0f), least(1e-3f);
  const auto behind = dot_lanes(direction, n) > zero;
  ng = scale_lanes(n, select(behind, -one, one));
  ns = scale_lanes(shading, select(dot_lanes(shading, ng) < zero, -one, one));
  // An interpolated normal may lean away from the ray at a silhouette. It is bent back until the ray just
  // sees the front of the surface.
  const F away = dot_lanes(direction, ns);
  const auto leans = away > -least;
  if (any(leans))
    ns = select_lanes(leans, unit_lanes(sub_lanes(ns, scale_lanes(direction, away + least))), ns);
  return behind;
}

/// Unit vectors `l` from `position` to a light at `place`, computed in double; returns the squared distances.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> turn_to_light(const Vec3f& place, const Vec3<Simd<float, W, A>>& position,
                                               Vec3<Simd<float, W, A>>& l) {
  using D = Simd<double, W, A>;
  const Vec3<D> towards = sub_lanes(broadcast<D>(place), to_double(position));
  const D square = dot_lanes(towards, towards);
  l = float_quotients(towards, sqrt(square));
  return square;
}

/// What is left of the light of an emitter at a distance, where it falls off.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> falloff(const Simd<double, W, A>& squared_distance) {
  return to_float(Simd<double, W, A>(1.0) / squared_distance);
}

/// What a spot gives at an angle from the middle of its cone, by the cosine of that angle: 1 up to the inner
/// angle, 0 from the outer one on.
template <class F>
OKTETT_INLINE F spot_share(const F& cosine, float cos_inner, float cos_outer) {
  const F t = min(max((cosine - F(cos_outer)) / F(cos_inner - cos_outer), F(0.0f)), F(1.0f));
  return t * t * (F(3.0f) - F(2.0f) * t);
}

/// The part of the light of a point of a glowing surface that leaves towards `-l`: the cosine at the surface,
/// or 0 behind a surface that glows at the front only. Sets the end of the shadow ray.
template <class F>
OKTETT_INLINE F glow(const Vec3<F>& l, const LightSource& light, Vec3<F>& end) {
  const Vec3<F> axis = broadcast<F>(light.axis);
  const F cosine = -dot_lanes(l, axis), zero(0.0f);
  const auto behind = cosine < zero;
  end =
      add_lanes(broadcast<F>(light.place), scale_lanes(axis, select(behind, F(-light.lift), F(light.lift))));
  return select(behind, F(-light.back) * cosine, cosine);
}

/// What Phong's model needs of the directions at a surface.
template <class F>
struct PhongCosines {
  F cosine;     ///< between shading normal and light; 0 where the light is behind the true surface
  F highlight;  ///< between the mirrored light and the viewer
};

/// Those of the shading normal alone. The light is in the unit direction `l`; the viewer's ray travels along
/// `direction`. NaN stays NaN.
template <class F>
OKTETT_INLINE PhongCosines<F> smooth_cosines(const Vec3<F>& direction, const Vec3<F>& ns, const Vec3<F>& l) {
  const F cosine = dot_lanes(ns, l);
  return {cosine, dot_lanes(l, direction) - F(2.0f) * cosine * dot_lanes(ns, direction)};
}

/// The same, but for light behind the true surface.
template <class F>
OKTETT_INLINE PhongCosines<F> phong_cosines(const Vec3<F>& direction, const Vec3<F>& ng, const Vec3<F>& ns,
                                            const Vec3<F>& l) {
  const F zero(0.0f);
  const PhongCosines<F> at = smooth_cosines(direction, ns, l);
  return {select(dot_lanes(ng, l) <= zero, zero, at.cosine), at.highlight};
}

}  // namespace oktett
