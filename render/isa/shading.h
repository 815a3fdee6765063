#pragma once
/// \file Shading of hits in columns, for one instruction set.

#include <cmath>

#include "accel/surface/offset_origin.h"
#include "core/simd_memory.h"
#include "core/simd_native.h"
#include "core/simd_order.h"
#include "render/angle_colors.h"
#include "render/bsdf/optics.h"
#include "render/bsdf/phong_lobes.h"
#include "render/context.h"
#include "render/raised_points.h"
#include "render/sampling/owen_sobol.h"
#include "render/shading_columns.h"
#include "render/shading_lanes.h"
#include "render/transport/path_block.h"
#include "render/transport/sample_dimensions.h"

namespace oktett {

/// Lanes for shading: a register of floats, and at least two of doubles, so that one chain of square roots
/// and quotients runs beside another. One hit at a time without vector registers.
template <class A>
using ShadingLanes = Simd<float,
                          std::is_same_v<A, ScalarIsa>   ? 1
                          : std::is_same_v<A, Avx512Isa> ? 16
                                                         : 8,
                          A>;

template <class F>
OKTETT_INLINE Vec3<F> load_lanes(const float (&column)[3][ShadingColumns::kMost], std::size_t i) {
  return {F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
}

template <class F>
OKTETT_INLINE void store_lanes(const Vec3<F>& v, float (&column)[3][ShadingColumns::kMost], std::size_t i) {
  v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
}

/// The lanes of the group of entries i, i + 1, ... that lie before `end`, as bits.
template <class F>
OKTETT_INLINE unsigned lanes_before(std::size_t end, std::size_t i) {
  const std::size_t left = end - i;
  return (left < F::kWidth ? 1u << left : 1u << F::kWidth) - 1u;
}

/// Bit k: entry k of the group is a hit, not what fills the group up.
template <class F>
OKTETT_INLINE unsigned real_lanes(const ShadingColumns& c, std::size_t i) {
  return lanes_before<F>(c.count, i);
}

/// Fills the columns of materials in entries i ... of a group, `eta` as for rays from the front, and sets
/// their bits in `c.varying` and `c.sending`. Returns their unlit light.
template <class F>
OKTETT_INLINE Vec3<F> fetch_materials(const ShadingMaterial* table, ShadingColumns& c, std::size_t i) {
  using I = Simd<std::int32_t, F::kWidth, typename F::Isa>;
  const std::uint32_t* material = c.material + i;
  const I index = I::load(reinterpret_cast<const std::int32_t*>(material));
  const F zero(0.0f);
  Vec3<F> color{zero, zero, zero}, specular_color = color, unlit = color;
  F diffuse = zero, specular = zero, phong = zero, reflection = zero, transparency = zero, ior = zero;
  I exponent(0);
  // Most groups have few materials, so each is set in all its lanes at once.
  unsigned left = (1u << F::kWidth) - 1;
  do {
    const std::uint32_t number = material[__builtin_ctz(left)];
    const ShadingMaterial& m = table[number];
    const auto has = index == I(static_cast<std::int32_t>(number));
    const auto here = mask_cast<float>(has);
    const unsigned lanes = bits(has);
    const auto set = [&](float value, F& to) { to = select(here, F(value), to); };
    const auto set_color = [&](const Color& value, Vec3<F>& to) {
      set(value.x, to.x), set(value.y, to.y), set(value.z, to.z);
    };
    set_color(m.color, color), set_color(m.specular_color, specular_color), set_color(m.unlit, unlit);
    set(m.diffuse, diffuse), set(m.specular, specular), set(m.phong, phong);
    set(m.reflection, reflection), set(m.transparency, transparency), set(m.ior, ior);
    exponent = select(has, I(m.exponent), exponent);
    if (m.varies) c.varying |= std::uint64_t{lanes} << i;
    if (m.sends_rays()) c.sending |= std::uint64_t{lanes} << i;
    left &= ~lanes;
  } while (left != 0);
  store_lanes(color, c.color, i), store_lanes(specular_color, c.specular_color, i);
  diffuse.store(c.diffuse + i), specular.store(c.specular + i), phong.store(c.phong + i);
  reflection.store(c.reflection + i), transparency.store(c.transparency + i), ior.store(c.eta + i);
  exponent.store(c.exponent + i);
  return unlit;
}

template <class A>
void begin_shading_code(const InteractionBlock& s, const ShadingMaterial* table, const ArrivingRays& rays,
                        ShadingColumns& c) {
  using F = ShadingLanes<A>;
  c.varying = c.sending = c.unsplit = c.uneven = c.blinned = 0;
  c.lit_behind = c.filmed = c.fading = 0;
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    const PickedLanes<F> ray(c.ray + i);
    const Vec3<F> direction{ray.load(rays.direction[0]), ray.load(rays.direction[1]),
                            ray.load(rays.direction[2])};
    const Vec3<F> throughput{ray.load(rays.throughput[0]), ray.load(rays.throughput[1]),
                             ray.load(rays.throughput[2])};
    store_lanes(direction, c.direction, i), store_lanes(throughput, c.throughput, i);
    Vec3<F> ng, ns;
    const auto behind =
        face_ray(direction, load_lanes<F>(s.geometric_normal, i), load_lanes<F>(s.shading_normal, i), ng, ns);
    store_lanes(ng, c.ng, i), store_lanes(ns, c.ns, i);
    const Vec3<F> unlit = fetch_materials<F>(table, c, i);
    const F ior = F::load(c.eta + i);
    select(behind, F(1.0f) / ior, ior).store(c.eta + i);
    // Light that varies over the surface is added when it is known.
    const unsigned known = static_cast<unsigned>(~(c.varying >> i)) & real_lanes<F>(c, i);
    ray.add(throughput.x * unlit.x, rays.radiance[0], known);
    ray.add(throughput.y * unlit.y, rays.radiance[1], known);
    ray.add(throughput.z * unlit.z, rays.radiance[2], known);
  }
}

/// x to the power of a whole exponent by squaring: portable::whole_power in lanes.
template <class D>
OKTETT_INLINE D whole_power(D x, std::int32_t exponent) {
  D product(1.0);
  for (; exponent != 0; exponent /= 2, x = x * x)
    if (exponent % 2 != 0) product = product * x;
  return product;
}

/// The same with an exponent for each lane.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> whole_powers(Simd<double, W, A> x, const Simd<std::int32_t, W, A>& exponent,
                                              std::int32_t greatest_exponent) {
  Simd<double, W, A> product(1.0);
  for (std::int32_t digit = 1; digit <= greatest_exponent; digit *= 2, x = x * x)
    product = select(mask_cast<double>(has_bits(exponent, digit)), product * x, product);
  return product;
}

/// phong_power of min(highlight, 1), rounded to float, for hits i ... of the columns.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> highlight_powers(const Simd<float, W, A>& highlight, const ShadingColumns& c,
                                                 std::size_t i) {
  using F = Simd<float, W, A>;
  using I = Simd<std::int32_t, W, A>;
  const F x = min(F(1.0f), highlight);
  const I exponents = I::load(c.exponent + i);
  const std::int32_t first = c.exponent[i];
  if (first >= 0 && none(~(exponents == I(first)))) return to_float(whole_power(to_double(x), first));
  std::int32_t greatest = 0;
  for (int k = 0; k < W; ++k) greatest = greatest < c.exponent[i + k] ? c.exponent[i + k] : greatest;
  const F power = to_float(whole_powers(to_double(x), exponents, greatest));
  if (none(exponents == I(ShadingMaterial::kAnyPower))) return power;
  float cosine[W], lanes[W];
  x.store(cosine), power.store(lanes);
  for (int k = 0; k < W; ++k)
    if (c.exponent[i + k] == ShadingMaterial::kAnyPower)
      lanes[k] = static_cast<float>(phong_power(cosine[k], c.phong[i + k]));
  return F::load(lanes);
}

/// Between the rays and the normals of hits i ..., negative.
template <class F>
OKTETT_INLINE F arriving_cosines(const ShadingColumns& c, std::size_t i) {
  return dot_lanes(load_lanes<F>(c.direction, i), load_lanes<F>(c.ns, i));
}

/// The diffuse light of hits i ... by the `cosine`, in `lanes` with brilliance and grain.
template <class F>
OKTETT_NOINLINE F uneven_diffuse(const F& cosine, const F& diffuse, const ShadingColumns& c, std::size_t i,
                                 unsigned lanes) {
  float all[F::kWidth], weight[F::kWidth];
  cosine.store(all), diffuse.store(weight);
  for (int k = 0; k < F::kWidth; ++k) {
    if ((lanes >> k & 1) == 0) {
      all[k] *= weight[k];
      continue;
    }
    const double x = all[k] > 0 ? all[k] : 0;
    const double lit = weight[k] * phong_power(x < 1 ? x : 1, c.brilliance[i + k]);
    // Light from behind stays none.
    all[k] = x > 0 && lit > c.grain[i + k] ? static_cast<float>(lit - c.grain[i + k]) : 0;
  }
  return F::load(all);
}

/// Weight * max(0, n . h)^blinn (Blinn 1977) of hits i ... in `lanes`, h being halfway between light and
/// viewer.
template <class F>
OKTETT_NOINLINE F blinn_highlights(const PhongCosines<F>& at, const ShadingColumns& c, std::size_t i,
                                   unsigned lanes) {
  float cosine[F::kWidth], highlight[F::kWidth], value[F::kWidth];
  at.cosine.store(cosine), at.highlight.store(highlight);
  for (int k = 0; k < F::kWidth; ++k) {
    value[k] = 0;
    if ((lanes >> k & 1) == 0) continue;
    double arriving = 0;  // cosine between the ray and the normal, negative
    for (int axis = 0; axis < 3; ++axis)
      arriving += double{c.direction[axis][i + k]} * double{c.ns[axis][i + k]};
    const double with_light = highlight[k] + 2.0 * cosine[k] * arriving;  // l . direction
    const double square = 2 - 2 * with_light, sum = cosine[k] - arriving;
    if (!(square > 1e-12) || !(sum > 0)) continue;
    const double middle = sum / std::sqrt(square);
    value[k] =
        static_cast<float>(c.specular_blinn[i + k] * phong_power(middle < 1 ? middle : 1, c.blinn[i + k]));
  }
  return F::load(value);
}

/// `color` in `lanes` as it has turned white for these cosines, see metal_fade().
template <class F>
OKTETT_NOINLINE Vec3<F> faded_lanes(const Vec3<F>& color, const F& cosine, unsigned lanes) {
  float x[F::kWidth], part[F::kWidth];
  cosine.store(x);
  for (int k = 0; k < F::kWidth; ++k)
    part[k] = (lanes >> k & 1) != 0 ? static_cast<float>(metal_fade(x[k])) : 0;
  const F fade = F::load(part), one(1.0f);
  return {color.x + (one - color.x) * fade, color.y + (one - color.y) * fade,
          color.z + (one - color.z) * fade};
}

/// `light` at hits i ... in `lanes` as a film colours it, see film_color(). `cosines`: between the normal and
/// the light, plus that between the normal and the viewer.
template <class F>
OKTETT_NOINLINE Vec3<F> filmed_lanes(const Vec3<F>& light, const F& cosines, const ShadingColumns& c,
                                     std::size_t i, unsigned lanes) {
  float sum[F::kWidth], factor[3][F::kWidth];
  cosines.store(sum);
  for (int k = 0; k < F::kWidth; ++k) {
    const bool has_film = (lanes >> k & 1) != 0;
    const Color color =
        has_film ? film_color(c.film[i + k], c.film_thickness[i + k], sum[k]) : Color{1, 1, 1};
    for (int axis = 0; axis < 3; ++axis) factor[axis][k] = color[axis];
  }
  return {light.x * F::load(factor[0]), light.y * F::load(factor[1]), light.z * F::load(factor[2])};
}

/// Colour * diffuse * cos(n, l) + specular colour * specular * max(0, r . v)^phong (Phong 1975) for hits
/// i ... of the columns, where the light is in front of the surface; both sides of a surface are lit alike.
/// Where the light is `behind`, colour * diffuse_back * cosine.
template <class F>
OKTETT_INLINE Vec3<F> phong_sums(const PhongCosines<F>& at, const typename F::M& behind,
                                 const ShadingColumns& c, std::size_t i) {
  const F zero(0.0f), specular = F::load(c.specular + i);
  const unsigned real = real_lanes<F>(c, i), front = ~bits(behind) & real;
  F diffuse = F::load(c.diffuse + i);
  if (front != real) diffuse = select(behind, F::load(c.diffuse_back + i), diffuse);
  F lit = diffuse * at.cosine;
  if (const unsigned uneven = static_cast<unsigned>(c.uneven >> i) & real; uneven != 0)
    lit = uneven_diffuse(at.cosine, diffuse, c, i, uneven);
  Vec3<F> sum = scale_lanes(load_lanes<F>(c.color, i), lit);
  const unsigned blinned = static_cast<unsigned>(c.blinned >> i) & front;
  // The comparisons keep NaN in the sum.
  const auto shines = ~(specular == zero) & ~(at.highlight <= zero) & ~behind;
  if (blinned != 0 || any(shines)) {
    Vec3<F> color = load_lanes<F>(c.specular_color, i);
    if (const unsigned fading = static_cast<unsigned>(c.fading >> i) & front; fading != 0)
      color = faded_lanes(color, at.cosine, fading);
    if (blinned != 0) sum = add_lanes(sum, scale_lanes(color, blinn_highlights(at, c, i, blinned)));
    if (any(shines)) {
      const F shine = specular * highlight_powers(at.highlight, c, i);
      sum = select_lanes(shines, add_lanes(sum, scale_lanes(color, shine)), sum);
    }
  }
  if (const unsigned filmed = static_cast<unsigned>(c.filmed >> i) & real; filmed != 0)
    sum = filmed_lanes(sum, at.cosine - arriving_cosines<F>(c, i), c, i, filmed);
  return sum;
}

/// What the profile of a light gives in the directions away from it, -l.
template <class F>
OKTETT_INLINE F profile_values(const AimedProfile& profile, const Vec3<F>& l) {
  float x[F::kWidth], y[F::kWidth], z[F::kWidth], value[F::kWidth];
  l.x.store(x);
  l.y.store(y);
  l.z.store(z);
  for (int k = 0; k < F::kWidth; ++k) value[k] = profile(-Vec3d(Vec3f{x[k], y[k], z[k]}));
  return F::load(value);
}

/// The light of a source at points that see it.
template <class F>
struct SourceLight {
  Vec3<F> l;       ///< unit vector towards it
  Vec3<F> target;  ///< where shadow rays end; towards a directional light, their direction
  Vec3<F> color;
};

template <class F>
OKTETT_INLINE SourceLight<F> source_light(const LightSource& light, const Vec3<F>& position) {
  const Vec3<F> place = broadcast<F>(light.place);
  SourceLight<F> s{place, place, broadcast<F>(light.color)};
  if (light.directional) return s;
  const auto square = turn_to_light(light.place, position, s.l);
  if (light.falloff) s.color = scale_lanes(s.color, falloff(square));
  if (light.spot) {
    const F cosine = -dot_lanes(s.l, broadcast<F>(light.axis));
    s.color = scale_lanes(s.color, spot_share(cosine, light.cos_inner, light.cos_outer));
  }
  if (light.profile.profile != nullptr) s.color = scale_lanes(s.color, profile_values(light.profile, s.l));
  if (light.glows) s.color = scale_lanes(s.color, glow(s.l, light, s.target));
  return s;
}

/// Replaces `position` by the raised points of hits i, i + 1, ... in `lanes`. Returns the lanes that have
/// one.
template <class F>
OKTETT_NOINLINE unsigned raise_positions(const ShadingColumns& c, std::size_t i, unsigned lanes,
                                         Vec3<F>& position) {
  float x[F::kWidth], y[F::kWidth], z[F::kWidth];
  position.x.store(x), position.y.store(y), position.z.store(z);
  unsigned raised = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int k = __builtin_ctz(lanes);
    const Vec3f* const point = c.raised->point(i + static_cast<unsigned>(k));
    if (point == nullptr) continue;
    x[k] = point->x, y[k] = point->y, z[k] = point->z;
    raised |= 1u << k;
  }
  position = {F::load(x), F::load(y), F::load(z)};
  return raised;
}

/// Those of `lanes`, of hits i, i + 1, ... that have raised points, in which `l` leads above the curved
/// surface.
template <class F>
OKTETT_NOINLINE unsigned lanes_above(const ShadingColumns& c, std::size_t i, unsigned lanes,
                                     const Vec3<F>& l) {
  float x[F::kWidth], y[F::kWidth], z[F::kWidth];
  l.x.store(x), l.y.store(y), l.z.store(z);
  unsigned above = 0;
  for (unsigned left = lanes; left != 0; left &= left - 1) {
    const int k = __builtin_ctz(left);
    if (c.raised->leads_above(i + static_cast<unsigned>(k), {x[k], y[k], z[k]})) above |= 1u << k;
  }
  return above;
}

/// Where the light of a source arrives at hits.
template <class F>
struct LitHits {
  SourceLight<F> light;
  PhongCosines<F> at;
  typename F::M behind;  ///< the hits that are lit on the other side
  typename F::M moved;   ///< the hits that are moved to their raised points
  Vec3<F> raised;        ///< these points
};

/// Moves hits i, i + 1, ... that the light meets from above the shading normal's horizon, but from behind the
/// plane of the triangle, to their raised points.
template <class F>
OKTETT_INLINE void raise_hits(const LightSource& light, const ShadingColumns& c, std::size_t i,
                              const Vec3<F>& position, LitHits<F>& hits) {
  const F zero(0.0f);
  const Vec3<F> ns = load_lanes<F>(c.ns, i), direction = load_lanes<F>(c.direction, i);
  const auto behind = ~(zero < dot_lanes(load_lanes<F>(c.ng, i), hits.light.l)) &
                      (zero < dot_lanes(ns, hits.light.l)) & (F::load(c.transparency + i) == zero);
  unsigned lanes = bits(behind) & real_lanes<F>(c, i);
  if (OKTETT_LIKELY(lanes == 0)) return;
  Vec3<F> raised = position;
  lanes = raise_positions(c, i, lanes, raised);
  if (lanes == 0) return;
  const SourceLight<F> seen = source_light(light, raised);
  const auto moved = F::M::from_bits(lanes_above(c, i, lanes, seen.l));
  const PhongCosines<F> at = smooth_cosines(direction, ns, seen.l);
  hits.light = {select_lanes(moved, seen.l, hits.light.l),
                select_lanes(moved, seen.target, hits.light.target),
                select_lanes(moved, seen.color, hits.light.color)};
  hits.at = {select(moved, at.cosine, hits.at.cosine), select(moved, at.highlight, hits.at.highlight)};
  hits.moved = moved, hits.raised = raised;
}

/// Lights hits i, i + 1, ... in `lanes` from behind.
template <class F>
OKTETT_NOINLINE void light_behind(const ShadingColumns& c, std::size_t i, unsigned lanes, LitHits<F>& hits) {
  const F zero(0.0f), cosine = dot_lanes(load_lanes<F>(c.ns, i), hits.light.l);
  hits.behind =
      F::M::from_bits(lanes) & (cosine < zero) & (dot_lanes(load_lanes<F>(c.ng, i), hits.light.l) < zero);
  hits.at.cosine = select(hits.behind, -cosine, hits.at.cosine);
}

/// The light of a source at hits i, i + 1, ... of the columns.
template <class F>
OKTETT_INLINE LitHits<F> lit_hits(const InteractionBlock& s, const LightSource& light,
                                  const ShadingColumns& c, std::size_t i) {
  const Vec3<F> position = load_lanes<F>(s.position, i);
  LitHits<F> hits;
  hits.light = source_light(light, position);
  hits.at = phong_cosines(load_lanes<F>(c.direction, i), load_lanes<F>(c.ng, i), load_lanes<F>(c.ns, i),
                          hits.light.l);
  hits.behind = hits.moved = F::M::from_bits(0);
  raise_hits(light, c, i, position, hits);
  if (const unsigned lanes = static_cast<unsigned>(c.lit_behind >> i) & real_lanes<F>(c, i); lanes != 0)
    light_behind(c, i, lanes, hits);
  return hits;
}

template <class A>
void shadow_rays_code(const InteractionBlock& s, const LightSource& light, const ShadingColumns& c,
                      ShadowColumns& out) {
  using F = ShadingLanes<A>;
  const F zero(0.0f);
  std::size_t end = out.size;
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    if (none(~(F::load(c.diffuse + i) == zero) | ~(F::load(c.specular + i) == zero)) &&
        (static_cast<unsigned>((c.blinned | c.lit_behind) >> i) & real_lanes<F>(c, i)) == 0)
      continue;
    const LitHits<F> hits = lit_hits<F>(s, light, c, i);
    unsigned lit = bits(~(hits.at.cosine <= zero)) & real_lanes<F>(c, i);
    if (lit == 0) continue;
    const Vec3<F> shine = phong_sums(hits.at, hits.behind, c, i), throughput = load_lanes<F>(c.throughput, i);
    const Vec3<F>& color = hits.light.color;
    const Vec3<F> arriving{throughput.x * shine.x * color.x, throughput.y * shine.y * color.y,
                           throughput.z * shine.z * color.z};
    lit &= ~bits((arriving.x == zero) & (arriving.y == zero) & (arriving.z == zero));
    Vec3<F> origin = offset_lanes(load_lanes<F>(s.position, i), load_lanes<F>(s.position_error, i),
                                  load_lanes<F>(s.geometric_normal, i), hits.light.l);
    if (any(hits.moved)) origin = select_lanes(hits.moved, hits.raised, origin);
    const Vec3<F> direction = light.directional ? hits.light.target : sub_lanes(hits.light.target, origin);
    store_compact(lit, origin, out.origin, end), store_compact(lit, direction, out.direction, end);
    store_compact(lit, arriving, out.light, end);
    std::uint32_t* owner = out.owner + end;
    for (int k = 0; k < F::kWidth; k += 8) owner += store_compact<A>(lit >> k & 0xff, c.ray + i + k, owner);
    end += static_cast<std::size_t>(__builtin_popcount(lit));
  }
  out.size = end;
}

// ---- Rays that mirrors and glass send out.

/// Writes rays that leave hits i, i + 1, ... in `lanes` with these directions and weights, except those that
/// are not worth tracing.
template <class F>
OKTETT_INLINE void put_bounces(const InteractionBlock& s, const ShadingColumns& c, std::size_t i,
                               unsigned lanes, const Vec3<F>& direction, const Vec3<F>& weight,
                               BounceColumns& out) {
  const F zero(0.0f), least(c.cutoff);
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
    Vec3<F> mirror_color = load_lanes<F>(c.specular_color, i);
    const auto varying = static_cast<unsigned>(c.varying >> i) & real;
    if (varying != 0)
      mirror_color = select_lanes(F::M::from_bits(varying), load_lanes<F>(c.mirror_color, i), mirror_color);
    Vec3<F> mirror = scale_lanes(mirror_color, reflection);
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
      F more = transparency * reflectance, passes = transparency * (one - reflectance);
      if (const auto unsplit = static_cast<unsigned>(c.unsplit >> i) & clear; unsplit != 0) {
        const auto whole = F::M::from_bits(unsplit);
        const auto total = whole & ~exists;
        more = select(whole & exists, zero, more), passes = select(whole & exists, transparency, passes);
        mirror = select_lanes(total, Vec3<F>{zero, zero, zero}, mirror), more = select(total, one, more);
      }
      mirror = {mirror.x + more, mirror.y + more, mirror.z + more};
      Vec3<F> filter = load_lanes<F>(c.color, i);
      if (varying != 0) filter = select_lanes(F::M::from_bits(varying), load_lanes<F>(c.filter, i), filter);
      put_bounces(s, c, i, clear & bits(exists), direction, scale_lanes(filter, passes), refracted);
    }
    put_bounces(s, c, i, real, reflect_above_lanes(d, ns, ng), mirror, mirrored);
  }
}

template <class A>
void queue_rays_code(const BounceColumns& leaving, const std::uint32_t* rays, const ArrivingRays& from,
                     OnwardColumns& to) {
  using F = ShadingLanes<A>;
  constexpr std::size_t W = F::kWidth;
  std::size_t end = to.size;
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
  to.size = end;
}

// ---- The start of shading by path tracing: what it knows of the hits of a block, and random numbers.

/// sobol_point for all hits, as whole numbers. Plain loops, which compilers turn into vector code.
template <class A>
void sobol_words(const PathBlock& c, std::uint32_t dimension, std::uint32_t* x, std::uint32_t* y) {
  std::uint64_t key[PathBlock::kMost];
  std::uint32_t number[PathBlock::kMost];
  const std::uint64_t step = (std::uint64_t{dimension} + 1) * kGoldenBits;
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) key[i] = mix_bits(c.key[i] + step);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) number[i] = shuffled_sample(c.number[i], key[i]);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i)
    x[i] = reversed_bits(scrambled_upwards(number[i], static_cast<std::uint32_t>(key[i])));
  if (y == nullptr) return;
  for (std::size_t i = 0; i < PathBlock::kMost; ++i)
    y[i] =
        reversed_bits(scrambled_upwards(pascal_product(number[i]), static_cast<std::uint32_t>(key[i] >> 32)));
}

template <class A>
void sobol_points_of(const PathBlock& c, std::uint32_t dimension, double* x, double* y) {
  std::uint32_t words[2][PathBlock::kMost];
  sobol_words<A>(c, dimension, words[0], y != nullptr ? words[1] : nullptr);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) x[i] = words[0][i] * 0x1p-32;
  if (y == nullptr) return;
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) y[i] = words[1][i] * 0x1p-32;
}

template <class A>
void sobol_numbers_of(const PathBlock& c, std::uint32_t dimension, float* x) {
  std::uint32_t words[PathBlock::kMost];
  sobol_words<A>(c, dimension, words, nullptr);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i)
    x[i] = static_cast<float>(static_cast<std::int32_t>(words[i] >> 8)) * 0x1p-24f;
}

template <class A>
void begin_path_code(const InteractionBlock& s, const ArrivingRays& rays, unsigned level, PathBlock& c) {
  using F = Simd<float, kDoubleLanes<A>, A>;
  c.behind = 0;
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    const PickedLanes<F> ray(c.ray + i);
    const auto load = [&](const float* const(&column)[3]) {
      return Vec3<F>{ray.load(column[0]), ray.load(column[1]), ray.load(column[2])};
    };
    const auto row = [&](const float(&column)[3][PathBlock::kMost]) {
      return Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
    };
    const auto put = [&](const Vec3<F>& v, float(&column)[3][PathBlock::kMost]) {
      v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
    };
    const Vec3<F> direction = load(rays.direction);
    Vec3<F> ng, ns;
    const auto behind = face_ray(direction, row(s.geometric_normal), row(s.shading_normal), ng, ns);
    c.behind |= std::uint64_t{bits(behind)} << i;
    put(direction, c.direction), put(load(rays.throughput), c.throughput), put(ng, c.ng), put(ns, c.ns);
  }
  const auto of = [&](Decision decision) { return dimension(decision, level); };
  sobol_numbers_of<A>(c, of(Decision::lobe), c.lobe);
  sobol_points_of<A>(c, of(Decision::direction), c.direction_x, c.direction_y);
  if (c.asks_lights) {
    sobol_points_of<A>(c, of(Decision::light), c.light, nullptr);
    sobol_points_of<A>(c, of(Decision::light_place), c.light_x, c.light_y);
  }
  // A path has no more bounces than its wavefront.
  if (level + 1 > kSureBounces) sobol_numbers_of<A>(c, of(Decision::roulette), c.roulette);
}

}  // namespace oktett
