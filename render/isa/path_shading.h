#pragma once
/// \file Path tracing at hits of one surface, in lanes: the light of light samples, and the rays of the next
/// bounce. shade_path of render/transport/path.cpp says the same for single hits.

#include <limits>

#include "accel/surface/offset_origin.h"
#include "core/double_lanes.h"
#include "core/picked_lanes.h"
#include "core/simd_order.h"
#include "render/transport/direct_light.h"
#include "render/transport/path_block.h"
#include "render/transport/path_numbers.h"

namespace oktett {

/// Hits of one surface, W at a time.
template <class A, class Lobes>
class PathShading {
 public:
  using D = Simd<double, kDoubleLanes<A>, A>;
  using F = FloatsOf<D>;
  using M = typename F::M;
  static constexpr int W = D::kWidth;

  PathShading(const InteractionBlock& found, const PathRays& rays, const PathBlock& block, bool transmits,
              PathQueues& out)
      : found_(found), rays_(rays), c_(block), transmits_(transmits), out_(out) {}

  OKTETT_INLINE void shade(const typename Lobes::Surface& surface, const std::uint32_t* entry,
                           unsigned real) {
    entry_ = entry;
    const PickedLanes<F> at(entry);
    position_ = load(at, found_.position), error_ = load(at, found_.position_error);
    n_ = load(at, found_.geometric_normal);
    ng_ = load(at, c_.ng), z_ = load(at, c_.ns), throughput_ = load(at, c_.throughput);
    basis_lanes(z_, x_, y_);
    const Lobes lobes(surface, to_local(-load(at, c_.direction)));
    send_shadow_rays(lobes, at, real);
    send_onward(lobes, at, real);
  }

 private:
  using Column3 = float[3][PathBlock::kMost];

  static OKTETT_INLINE Vec3<F> load(const PickedLanes<F>& at, const Column3& column) {
    return {at.load(column[0]), at.load(column[1]), at.load(column[2])};
  }
  OKTETT_INLINE D load(const double* column) const {
    double lanes[W];
    for (int k = 0; k < W; ++k) lanes[k] = column[entry_[k]];
    return D::load(lanes);
  }
  OKTETT_INLINE Vec3<F> to_local(const Vec3<F>& v) const {
    return {dot_lanes(v, x_), dot_lanes(v, y_), dot_lanes(v, z_)};
  }
  OKTETT_INLINE Vec3<F> to_world(const Vec3<F>& v) const {
    return unit_lanes(x_ * v.x + y_ * v.y + z_ * v.z);
  }

  OKTETT_INLINE void send_shadow_rays(const Lobes& lobes, const PickedLanes<F>& at, unsigned real) {
    unsigned deltas = 0, areas = 0;
    for (int k = 0; k < W; ++k) {
      deltas |= (c_.light_kind[entry_[k]] == LightKind::delta ? 1u : 0u) << k;
      areas |= (c_.light_kind[entry_[k]] == LightKind::area ? 1u : 0u) << k;
    }
    if (((deltas | areas) & real) == 0) return;
    const F zero(0.0f), one(1.0f);
    const Vec3<F> l = load(at, c_.light_direction), local = to_local(l);
    const F side = dot_lanes(ng_, l), density = at.load(c_.light_pdf);
    // Both normals must agree on which side the light is.
    unsigned lit = bits(side * local.z > zero) & real;
    if (!transmits_) lit &= ~bits(side < zero);
    if ((lit & (deltas | areas)) == 0) return;
    const BsdfValues<D> value = lobes.evaluate(local);
    // Veach's power heuristic. Divided first: squares of densities may be too large for a float.
    const M delta = M::from_bits(deltas);
    const F ratio = value.pdf / density, weight = select(delta, one, one / (one + ratio * ratio));
    const Vec3<F> arriving = throughput_ * value.value * load(at, c_.light_color) * (weight / density);
    lit &= ~bits((arriving.x == zero) & (arriving.y == zero) & (arriving.z == zero));
    if ((lit & (deltas | areas)) == 0) return;
    const Vec3<F> origin = offset_lanes(position_, error_, n_, l);
    const F distance = at.load(c_.light_distance);
    const M near = distance < F(std::numeric_limits<float>::infinity());
    const Vec3<F> place = position_ + l * distance;
    const Vec3<F> direction = select_lanes(near, place - origin, l);
    const F farthest = max(max(abs(place.x), abs(place.y)), abs(place.z));
    const F blur = F(kPlaceError) * farthest / distance;
    const F before = one - max(min(blur, F(0.5f)), F(kLeastGap));
    const F tmax =
        select(near, select(delta, F(kBeforeLight), before), F(std::numeric_limits<float>::infinity()));
    for (const bool points : {true, false}) {
      const unsigned which = lit & (points ? deltas : areas);
      if (which == 0) continue;
      PathShadows& to = points ? out_.delta : out_.area;
      store_compact(which, origin, to.origin, to.size),
          store_compact(which, direction, to.direction, to.size);
      store_compact(which, arriving, to.light, to.size), store_compact(which, tmax, to.tmax + to.size);
      std::uint32_t owner[W];
      for (int k = 0; k < W; ++k) owner[k] = c_.ray[entry_[k]];
      store_compact<A>(which, owner, to.owner + to.size);
      to.size += static_cast<std::size_t>(__builtin_popcount(which));
    }
  }

  OKTETT_INLINE void send_onward(const Lobes& lobes, const PickedLanes<F>& at, unsigned real) {
    const F zero(0.0f), one(1.0f);
    BsdfSamples<D> s = lobes.sample(to_double(at.load(c_.lobe)), load(c_.direction_x), load(c_.direction_y));
    Vec3<F> direction = to_world(s.direction);
    const F side = dot_lanes(ng_, direction);
    const M agrees = (s.transmitted & (side < zero)) | (~s.transmitted & (side > zero));
    const M delta = s.pdf == zero;
    // Ideal mirrors and glass keep their light: the direction is folded back to its side of the true surface.
    const M folded = s.found & delta & ~agrees;
    if (any(folded))
      direction = select_lanes(folded, unit_lanes(direction - ng_ * (F(2.0f) * side)), direction);
    unsigned sent = bits(s.found & (agrees | delta)) & real;
    Vec3<F> onward = throughput_ * s.weight;
    unsigned may_end = 0;
    for (int k = 0; k < W; ++k) may_end |= (c_.bounces[entry_[k]] + 1u > kSureBounces ? 1u : 0u) << k;
    if (may_end != 0) {
      const auto greatest = [](const Vec3<F>& v) { return max(max(v.x, v.y), v.z); };
      const F chance = min(sqrt(select(delta, greatest(s.weight), greatest(onward))), one);
      sent &= ~(may_end & bits(at.load(c_.roulette) >= chance));
      onward = onward * select(M::from_bits(may_end), one / chance, one);
    }
    if (sent == 0) return;
    PathOnward& to = out_.next;
    store_compact(sent, offset_lanes(position_, error_, n_, direction), to.origin, to.size);
    store_compact(sent, direction, to.direction, to.size),
        store_compact(sent, onward, to.throughput, to.size);
    store_compact(sent, s.pdf, to.pdf + to.size);
    for (unsigned left = sent; left != 0; left &= left - 1, ++to.size) {
      const std::uint32_t k = entry_[__builtin_ctz(left)], ray = c_.ray[k];
      to.sample[to.size] = rays_.sample[ray];
      to.distance[to.size] = rays_.distance[ray] + rays_.t[ray];
      to.bounces[to.size] = static_cast<std::uint8_t>(c_.bounces[k] + 1);
      to.from[to.size] = c_.from[k];
    }
    to.transmitted += static_cast<std::uint64_t>(__builtin_popcount(bits(s.transmitted) & sent));
  }

  const InteractionBlock& found_;
  const PathRays& rays_;
  const PathBlock& c_;
  bool transmits_;
  PathQueues& out_;

  const std::uint32_t* entry_ = nullptr;
  Vec3<F> position_, error_, n_, ng_, throughput_;
  Vec3<F> x_, y_, z_;  ///< frame about the shading normal
};

template <class A, class Lobes>
void shade_path_run(const InteractionBlock& found, const PathRays& rays, const PathBlock& block,
                    const typename Lobes::Surface& surface, bool transmits, const PathRun& run,
                    PathQueues& out) {
  PathShading<A, Lobes> shading(found, rays, block, transmits, out);
  constexpr std::size_t kWidth = PathShading<A, Lobes>::W;
  for (std::size_t i = 0; i < run.count; i += kWidth) {
    const std::size_t left = run.count - i;
    shading.shade(surface, run.entry + i, (left < kWidth ? 1u << left : 1u << kWidth) - 1u);
  }
}

template <class A>
void shade_phong_code(const InteractionBlock& found, const PathRays& rays, const PathBlock& block,
                      const PhongSurface& surface, bool transmits, const PathRun& run, PathQueues& out);
template <class A>
void shade_principled_code(const InteractionBlock& found, const PathRays& rays, const PathBlock& block,
                           const PrincipledSurface& surface, bool transmits, const PathRun& run,
                           PathQueues& out);

}  // namespace oktett
