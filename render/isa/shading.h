#pragma once
/// \file Shading of hits in columns, for one instruction set.

#include "accel/surface/offset_origin.h"
#include "render/context.h"
#include "render/shading_columns.h"
#include "render/shading_lanes.h"

namespace oktett {

/// Lanes for shading; one hit at a time without vector registers.
template <class A>
using ShadingLanes = Simd<float, std::is_same_v<A, ScalarIsa> ? 1 : 8, A>;

template <class F>
OKTETT_INLINE Vec3<F> load_lanes(const float (&column)[3][ShadingColumns::kMost], std::size_t i) {
  return {F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
}

template <class F>
OKTETT_INLINE void store_lanes(const Vec3<F>& v, float (&column)[3][ShadingColumns::kMost], std::size_t i) {
  v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
}

template <class A>
void face_rays_code(const InteractionBlock& s, ShadingColumns& c) {
  using F = ShadingLanes<A>;
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    Vec3<F> ng, ns;
    face_ray(load_lanes<F>(c.direction, i), load_lanes<F>(s.geometric_normal, i),
             load_lanes<F>(s.shading_normal, i), ng, ns);
    store_lanes(ng, c.ng, i), store_lanes(ns, c.ns, i);
  }
}

/// x to the power of whole exponents by squaring: portable::whole_power in lanes.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> whole_powers(Simd<double, W, A> x, const Simd<std::int32_t, W, A>& exponent,
                                              std::int32_t greatest_exponent) {
  Simd<double, W, A> product(1.0);
  for (std::int32_t digit = 1; digit <= greatest_exponent; digit *= 2, x = x * x)
    product = select(mask_cast<double>(has_bits(exponent, digit)), product * x, product);
  return product;
}

template <class A>
void meet_light_code(const InteractionBlock& s, const LightSource& light, ShadingColumns& c) {
  using F = ShadingLanes<A>;
  using I = Simd<std::int32_t, F::kWidth, A>;
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    const Vec3<F> position = load_lanes<F>(s.position, i);
    Vec3<F> l = broadcast<F>(light.place);
    if (!light.directional) {
      F falloff;
      turn_to_light(light.place, position, l, falloff);
      falloff.store(c.falloff + i);
    }
    const Vec3<F> origin =
        offset_lanes(position, load_lanes<F>(s.position_error, i), load_lanes<F>(s.geometric_normal, i), l);
    store_lanes(origin, c.origin, i);
    const auto cosines =
        phong_cosines(load_lanes<F>(c.direction, i), load_lanes<F>(c.ng, i), load_lanes<F>(c.ns, i), l);
    cosines.cosine.store(c.cosine + i), cosines.highlight.store(c.highlight + i);
    const auto x = to_double(min(F(1.0f), cosines.highlight));
    to_float(whole_powers(x, I::load(c.exponent + i), c.greatest_exponent)).store(c.power + i);
  }
}

}  // namespace oktett
