#pragma once
/// \file Path tracing where light is scattered, in lanes: the light of light samples, and the rays of the
/// next bounce. A hit that is shaded alone, and a place in a medium, are single lanes.

#include <cmath>
#include <limits>

#include "accel/surface/offset_origin.h"
#include "core/simd_memory.h"
#include "core/simd_native.h"
#include "core/simd_order.h"
#include "render/bsdf/lobe_lanes.h"
#include "render/shading_lanes.h"
#include "render/transport/path_block.h"

namespace oktett {

/// How surfaces of these lobes scatter light, in world space.
template <template <class> class Lobes, class Doubles>
class SurfaceScattering {
 public:
  using D = Doubles;
  using F = FloatsOf<D>;
  using M = typename F::M;
  using Surface = typename Lobes<D>::Surface;
  static constexpr bool kAtSurface = true;

  /// Of rays along `direction`, with the normals of ShadingPoint.
  OKTETT_INLINE SurfaceScattering(const Surface& surface, bool transmits, const Vec3<F>& direction,
                                  const Vec3<F>& ng, const Vec3<F>& ns)
      : frame_(frame_of(surface, ns, ng)),
        transmits_(transmits),
        lobes_(surface, frame_.to_local(-direction)) {}

  OKTETT_INLINE Vec3<F> to_local(const Vec3<F>& l) const { return frame_.to_local(l); }
  /// The lanes in which light from the unit vectors `l` may be scattered; those that are `raised` may be lit
  /// from behind the plane of the triangle.
  OKTETT_INLINE M may_scatter(const Vec3<F>& l, const Vec3<F>& local, const M& raised) const {
    return frame_.agrees(l, local, transmits_) | (raised & (local.z > F(0.0f)));
  }
  OKTETT_INLINE BsdfValues<D> evaluate(const Vec3<F>& local) const { return lobes_.evaluate(local); }
  /// Directions are in world space.
  OKTETT_INLINE BsdfSamples<D> sample(const D& lobe, const D& x, const D& y) const {
    BsdfSamples<D> s = lobes_.sample(lobe, x, y);
    frame_.to_world(s);
    return s;
  }

 private:
  static OKTETT_INLINE ShadingFrame<D> frame_of(const Surface& surface, const Vec3<F>& ns,
                                                const Vec3<F>& ng) {
    ShadingFrame<D> frame(ns, ng);
    if constexpr (requires { surface.stretch; })
      if (surface.stretch.y != 0 || surface.stretch.x != 1) frame.turn(surface.stretch);
    return frame;
  }

  ShadingFrame<D> frame_;
  bool transmits_;
  Lobes<D> lobes_;
};

/// Places of one kind of scattering, W at a time.
template <class Scattering>
class PathShading {
 public:
  using D = typename Scattering::D;
  using F = FloatsOf<D>;
  using A = typename D::Isa;
  using M = typename F::M;
  static constexpr int W = D::kWidth;

  PathShading(const InteractionBlock& found, const ArrivingRays& rays, const PathBlock& block, bool transmits,
              PathQueues& out)
      : found_(found), rays_(rays), c_(block), transmits_(transmits), out_(out) {}

  OKTETT_INLINE void shade(const typename Scattering::Surface& surface, const std::uint32_t* entry,
                           unsigned real) {
    entry_ = entry;
    const PickedLanes<F> at(entry);
    position_ = load(at, found_.position), error_ = load(at, found_.position_error);
    n_ = load(at, found_.geometric_normal), throughput_ = load(at, c_.throughput);
    const Scattering scattering(surface, transmits_, load(at, c_.direction), load(at, c_.ng),
                                load(at, c_.ns));
    send_shadow_rays(scattering, at, real);
    send_onward(scattering, at, real);
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
  /// Where rays start that leave in these directions.
  OKTETT_INLINE Vec3<F> origin(const Vec3<F>& direction) const {
    if constexpr (Scattering::kAtSurface) return offset_lanes(position_, error_, n_, direction);
    return position_;
  }
  /// Calls `what(lane, entry)` for some lanes.
  template <class What>
  void for_lanes(unsigned lanes, const What& what) const {
    for (; lanes != 0; lanes &= lanes - 1) what(__builtin_ctz(lanes), entry_[__builtin_ctz(lanes)]);
  }
  /// `points` with the raised points in some lanes, of hits that have one.
  Vec3<F> raised(unsigned lanes, const Vec3<F>& points) const {
    if (lanes == 0) return points;
    float x[W], y[W], z[W];
    points.x.store(x), points.y.store(y), points.z.store(z);
    for_lanes(lanes, [&](int lane, std::uint32_t k) {
      const Vec3f& point = *c_.raised->point(k);
      x[lane] = point.x, y[lane] = point.y, z[lane] = point.z;
    });
    return {F::load(x), F::load(y), F::load(z)};
  }

  /// Those of some lanes, whose directions lead behind the plane of the triangle, in which no ray starts.
  unsigned without_raised_origin(unsigned lanes, const Vec3<F>& direction) const {
    if (lanes == 0) return 0;
    float x[W], y[W], z[W];
    direction.x.store(x), direction.y.store(y), direction.z.store(z);
    unsigned lost = 0;
    for_lanes(lanes, [&](int lane, std::uint32_t k) {
      if (c_.raised->origin(k, {x[lane], y[lane], z[lane]}) == nullptr) lost |= 1u << lane;
    });
    return lost;
  }
  /// Corrects what the last ray of `to`, of hit `k`, knows of its start, the raised point. Light samples of
  /// that have no places above the plane of the triangle.
  void start_raised(std::uint32_t k, PathOnward& to) const {
    const Vec3f point = *c_.raised->point(k), ng = InteractionBlock::get(c_.ng, k);
    const Vec3f direction{to.direction[0][to.size], to.direction[1][to.size], to.direction[2][to.size]};
    const float height = dot(point - InteractionBlock::get(found_.position, k), ng);
    to.from[to.size].position = point;
    to.unsampled[to.size] = height / std::abs(dot(direction, ng));
  }

  OKTETT_INLINE void send_shadow_rays(const Scattering& scattering, const PickedLanes<F>& at, unsigned real) {
    unsigned points = 0, deltas = 0, areas = 0, raised_light = 0;
    for (int k = 0; k < W; ++k) {
      const LightKind kind = c_.light_kind[entry_[k]];
      raised_light |= static_cast<unsigned>(c_.raised_light >> entry_[k] & 1) << k;
      points |= (kind == LightKind::delta ? 1u : 0u) << k;
      deltas |= (kind == LightKind::delta || kind == LightKind::left_to_photons ? 1u : 0u) << k;
      areas |= (kind == LightKind::area || kind == LightKind::left_to_photons ? 1u : 0u) << k;
    }
    const unsigned asked = (points | areas) & real;
    if (asked == 0) return;
    const F zero(0.0f), one(1.0f);
    const Vec3<F> l = load(at, c_.light_direction), local = scattering.to_local(l);
    const F density = at.load(c_.light_pdf);
    unsigned lit = bits(scattering.may_scatter(l, local, M::from_bits(raised_light))) & asked;
    if (lit == 0) return;
    const BsdfValues<D> value = scattering.evaluate(local);
    // Veach's power heuristic. Divided first: squares of densities may be too large for a float.
    const M delta = M::from_bits(deltas);
    const F ratio = value.pdf / density, weight = select(delta, one, one / (one + ratio * ratio));
    const Vec3<F> arriving = throughput_ * value.value * load(at, c_.light_color) * (weight / density);
    lit &= ~bits((arriving.x == zero) & (arriving.y == zero) & (arriving.z == zero));
    if (lit == 0) return;
    const Vec3<F> start = raised(raised_light, origin(l)), from = raised(raised_light, position_);
    const F distance = at.load(c_.light_distance);
    const M near = distance < F(std::numeric_limits<float>::infinity());
    const Vec3<F> place = from + l * distance;
    const Vec3<F> direction = select_lanes(near, place - start, l);
    const F farthest = max(max(abs(place.x), abs(place.y)), abs(place.z));
    const F blur = F(kPlaceError) * farthest / distance;
    const F before = one - max(min(blur, F(0.5f)), F(kLeastGap));
    const F tmax =
        select(near, select(delta, F(kBeforeLight), before), F(std::numeric_limits<float>::infinity()));
    for (const bool straight : {true, false}) {
      const unsigned which = lit & (straight ? points : areas);
      if (which == 0) continue;
      ShadowColumns& to = straight ? out_.delta : out_.area;
      store_compact(which, start, to.origin, to.size);
      store_compact(which, direction, to.direction, to.size);
      store_compact(which, arriving, to.light, to.size);
      store_compact(which, tmax, to.tmax + to.size);
      static_assert(W <= 8);
      std::uint32_t owner[8] = {};  // store_compact() reads eight
      for (int k = 0; k < W; ++k) owner[k] = c_.ray[entry_[k]];
      store_compact<A>(which, owner, to.owner + to.size);
      to.size += static_cast<std::size_t>(__builtin_popcount(which));
    }
  }

  OKTETT_INLINE void send_onward(const Scattering& scattering, const PickedLanes<F>& at, unsigned real) {
    const F one(1.0f);
    const BsdfSamples<D> s =
        scattering.sample(to_double(at.load(c_.lobe)), load(c_.direction_x), load(c_.direction_y));
    const M delta = s.pdf == F(0.0f);
    unsigned sent = bits(s.found) & real, behind = 0;
    if constexpr (Scattering::kAtSurface)
      if (!transmits_) behind = bits(s.behind) & real;
    sent |= behind;
    Vec3<F> onward = throughput_ * s.weight;
    unsigned may_end = 0;
    for (int k = 0; k < W; ++k) may_end |= (c_.bounces[entry_[k]] + 1u > kSureBounces ? 1u : 0u) << k;
    if (may_end != 0) {
      const auto greatest = [](const Vec3<F>& v) { return max(max(v.x, v.y), v.z); };
      const F chance = min(sqrt(select(delta, greatest(s.weight), greatest(onward))), one);
      sent &= ~(may_end & bits(at.load(c_.roulette) >= chance));
      onward = onward * select(M::from_bits(may_end), one / chance, one);
    }
    if (const unsigned lost = without_raised_origin(behind & sent, s.direction); lost != 0)
      sent &= ~lost, behind &= ~lost;
    if (sent == 0) return;
    PathOnward& to = out_.next;
    store_compact(sent, raised(behind & sent, origin(s.direction)), to.origin, to.size);
    store_compact(sent, s.direction, to.direction, to.size);
    store_compact(sent, onward, to.throughput, to.size);
    store_compact(sent, s.pdf, to.pdf + to.size);
    for_lanes(sent, [&](int lane, std::uint32_t k) {
      const std::uint32_t ray = c_.ray[k];
      to.sample[to.size] = rays_.sample[ray];
      to.distance[to.size] = rays_.distance[ray] + rays_.t[ray];
      to.bounces[to.size] = static_cast<std::uint8_t>(c_.bounces[k] + 1);
      to.from[to.size] = c_.from[k], to.unsampled[to.size] = 0;
      if ((behind >> lane & 1) != 0) start_raised(k, to);
      ++to.size;
    });
    to.transmitted += static_cast<std::uint64_t>(__builtin_popcount(bits(s.transmitted) & sent));
  }

  const InteractionBlock& found_;
  const ArrivingRays& rays_;
  const PathBlock& c_;
  bool transmits_;
  PathQueues& out_;

  const std::uint32_t* entry_ = nullptr;
  Vec3<F> position_, error_, n_, throughput_;
};

template <class Scattering>
void shade_path_run(const InteractionBlock& found, const ArrivingRays& rays, const PathBlock& block,
                    const typename Scattering::Surface& surface, bool transmits, const PathRun& run,
                    PathQueues& out) {
  PathShading<Scattering> shading(found, rays, block, transmits, out);
  constexpr std::size_t kWidth = PathShading<Scattering>::W;
  for (std::size_t i = 0; i < run.count; i += kWidth) {
    const std::size_t left = run.count - i;
    shading.shade(surface, run.entry + i, (left < kWidth ? 1u << left : 1u << kWidth) - 1u);
  }
}

template <class A>
void shade_phong_code(const InteractionBlock& found, const ArrivingRays& rays, const PathBlock& block,
                      const PhongSurface& surface, bool transmits, const PathRun& run, PathQueues& out);
template <class A>
void shade_principled_code(const InteractionBlock& found, const ArrivingRays& rays, const PathBlock& block,
                           const PrincipledSurface& surface, bool transmits, const PathRun& run,
                           PathQueues& out);

}  // namespace oktett
