#pragma once
/// \file The rays that mirrors and glass send out, for hits in columns.

#include "render/bsdf/optics.h"
#include "render/isa/shading.h"

namespace oktett {

/// Writes rays that leave hits i, i + 1, ... in `lanes` with these directions and weights, except those that
/// are not worth tracing.
template <class F>
OKTETT_INLINE void put_bounces(const InteractionBlock& s, const ShadingColumns& c, std::size_t i,
                               unsigned lanes, const Vec3<F>& direction, const Vec3<F>& weight,
                               BounceColumns& out) {
  const F zero(0.0f), least(kLeastThroughput);
  const Vec3<F> arriving = load_lanes<F>(c.throughput, i);
  const Vec3<F> throughput{arriving.x * weight.x, arriving.y * weight.y, arriving.z * weight.z};
  const unsigned sent = lanes & ~bits((weight.x == zero) & (weight.y == zero) & (weight.z == zero)) &
                        ~bits((throughput.x < least) & (throughput.y < least) & (throughput.z < least));
  if (sent == 0) return;
  out.sent |= std::uint64_t{sent} << i;
  store_lanes(offset_lanes(load_lanes<F>(s.position, i), load_lanes<F>(s.position_error, i),
                           load_lanes<F>(s.geometric_normal, i), direction),
              out.origin, i);
  store_lanes(direction, out.direction, i), store_lanes(throughput, out.throughput, i);
}

template <class A>
void bounce_rays_code(const InteractionBlock& s, const ShadingColumns& c, BounceColumns& mirrored,
                      BounceColumns& refracted) {
  using F = ShadingLanes<A>;
  const F zero(0.0f), one(1.0f);
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    const F reflection = F::load(c.reflection + i), transparency = F::load(c.transparency + i);
    const unsigned real = real_lanes<F>(c, i);
    const unsigned clear = ~bits(transparency == zero) & real;
    if (((~bits(reflection == zero) & real) | clear) == 0) continue;
    const Vec3<F> d = load_lanes<F>(c.direction, i), ns = load_lanes<F>(c.ns, i), ng = load_lanes<F>(c.ng, i);
    Vec3<F> mirror = scale_lanes(load_lanes<F>(c.specular_color, i), reflection);
    if (clear != 0) {
      const F eta = F::load(c.eta + i);
      Vec3<F> direction;
      auto exists = refract_lanes(d, ns, eta, direction);
      // The direction must lead below the true surface.
      const auto above = exists & (zero <= dot_lanes(direction, ng));
      if (any(above)) {
        Vec3<F> other;
        const auto there = refract_lanes(d, ng, eta, other);
        direction = select_lanes(above, other, direction);
        exists = (exists & ~above) | (above & there);
      }
      const F reflectance =
          select(exists, to_float(fresnel_lanes(to_double(-dot_lanes(d, ns)), to_double(eta))), one);
      const F more = transparency * reflectance;
      mirror = {mirror.x + more, mirror.y + more, mirror.z + more};
      put_bounces(s, c, i, clear & bits(exists), direction,
                  scale_lanes(load_lanes<F>(c.color, i), transparency * (one - reflectance)), refracted);
    }
    put_bounces(s, c, i, real, reflect_above_lanes(d, ns, ng), mirror, mirrored);
  }
}

template <class A>
void queue_rays_code(const BounceColumns& leaving, const std::uint32_t* rays, const ArrivingRays& from,
                     const QueuedRays& to) {
  using F = ShadingLanes<A>;
  constexpr std::size_t W = F::kWidth;
  std::size_t end = 0;
  for (std::size_t i = 0; i < ShadingColumns::kMost; i += W) {
    const auto lanes = static_cast<unsigned>(leaving.sent >> i) & ((1u << W) - 1);
    if (lanes == 0) continue;
    store_compact(lanes, load_lanes<F>(leaving.origin, i), to.origin, end);
    store_compact(lanes, load_lanes<F>(leaving.direction, i), to.direction, end);
    store_compact(lanes, load_lanes<F>(leaving.throughput, i), to.throughput, end);
    for (unsigned left = lanes; left != 0; left &= left - 1, ++end) {
      const std::uint32_t ray = rays[i + static_cast<unsigned>(__builtin_ctz(left))];
      to.sample[end] = from.sample[ray];
      to.distance[end] = from.distance[ray] + from.t[ray];
      to.bounces[end] = static_cast<std::uint8_t>(from.bounces[ray] + 1);
    }
  }
  const Ray like;
  for (std::size_t i = 0; i < end; ++i) to.tmin[i] = like.tmin, to.tmax[i] = like.tmax, to.from_camera[i] = 0;
}

}  // namespace oktett
