#pragma once
/// \file ExactSurfaceCode of one surface for one instruction set. Included by the units that the build makes
/// of accel/isa/exact_surface.cpp.in.

#include "accel/exact_table.h"
#include "accel/isa/beam_cell.h"
#include "accel/surface/surface_lanes.h"
#include "kernels/exact/exact_interaction.h"

namespace oktett {

/// The rays in the own space of the cell's element.
template <class D, class F>
OKTETT_INLINE Line<D> own_line(const Affine& to_own, const RayLanes<F>& rays) {
  return {map_point(to_own, to_double(rays.o)), map_vector(to_own, to_double(rays.d))};
}

/// What a ray may hit begins here: a little beyond tmin, so that it does not round to tmin. Not before 0,
/// where the factor would lead back.
template <class D>
OKTETT_INLINE D range_begin(const D& tmin) {
  return max(tmin, D(0.0)) * D(1 + 0x1p-24) + D(0x1p-151);
}

template <class D>
OKTETT_INLINE void cut_range(LineRange<D>& range, const D& from) {
  range.enter_face = select(from > range.a, D(0.0), range.enter_face);
  range.a = max(from, range.a);
}

template <class D>
OKTETT_INLINE void cut_end(LineRange<D>& range, const D& to) {
  range.exit_face = select(to < range.b, D(0.0), range.exit_face);
  range.b = min(to, range.b);
}

/// Where to look for crossings with the cell before the ray's own range counts.
template <class S, class D>
OKTETT_INLINE typename D::M cell_range(const Line<D>& line, const ExactCell& cell, LineRange<D>& range) {
  if constexpr (requires { S::kWholeLines; }) {
    const D inf(std::numeric_limits<double>::infinity());
    range = {-inf, inf, D(0.0), D(0.0)};
    return D::M::all_true();
  } else {
    return clip_line(line, cell.lo, cell.hi, range);
  }
}

/// First crossings with cell `index`, of the rays in `lanes`; the lanes that have one.
template <class S, class F>
OKTETT_INLINE unsigned first_crossings(const typename S::Pool& pool, std::uint32_t index,
                                       const RayLanes<F>& rays, unsigned lanes, HitLanes<F>& hits) {
  using D = Simd<double, F::kWidth, typename F::Isa>;
  const ExactCell& cell = pool.cells[index];
  const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
  LineRange<D> range;
  auto active = D::M::from_bits(lanes) & cell_range<S>(line, cell, range);
  cut_range(range, range_begin(to_double(rays.tmin)));
  // Nothing farther than tmax is of use, yet it must not shorten the range: that would change the roots.
  active = active & (range.a <= range.b) & (range.a * D(1 - 0x1p-22) <= to_double(rays.tmax));
  if constexpr (requires { S::kStopsAtLimit; }) cut_end(range, to_double(rays.tmax) * D(1 + 0x1p-22));
  hits.t = hits.u = hits.v = F(0.0f);
  const F far_limit = min(rays.tmax, F(std::numeric_limits<float>::max()));
  unsigned met = 0;
  while (any(active)) {
    Crossings<1, D> c;
    S::template crossings<1>(pool, cell, line, range, active, c);
    active = active & (c.t[0] < D(roots::kNoRoot));
    const F t = to_float(c.t[0]);
    const auto found = mask_cast<float>(active);
    const auto valid = found & (rays.tmin < t) & (t <= far_limit);
    hits.t = select(valid, t, hits.t);
    hits.u = select(valid, to_float(c.part[0]), hits.u);
    hits.v = select(valid, to_float(c.turn[0]), hits.v);
    met |= bits(valid);
    // A root so near to the beginning that it rounds to tmin is not the first that counts. One that was found
    // before the beginning is as uncertain as it is far from there: the next begins as far behind.
    active = mask_cast<double>(found & (t <= rays.tmin)) & (range.a < range.b);
    const D before = max(range.a - c.t[0], D(0.0));
    cut_range(range, max(range.a, c.t[0]) * D(1 + 0x1p-24) + D(0x1p-151) + before);
    active = active & (range.a <= range.b);
  }
  return met;
}

template <class S, class A>
unsigned ExactSurfaceCode<S, A>::first(const ExactPoolBase& base, std::uint32_t index,
                                       const RayLanes<F>& rays, unsigned lanes, HitLanes<F>& hits) {
  const auto& pool = static_cast<const typename S::Pool&>(base);
  if constexpr (requires { S::kLoneLanes; } && F::kWidth > 1) {
    if ((lanes & (lanes - 1)) == 0) {
      using One = Simd<float, 1, A>;
      const int k = __builtin_ctz(lanes);
      const auto lone = [&](const F& x) {
        float column[F::kWidth];
        x.store(column);
        return One(column[k]);
      };
      const RayLanes<One> ray{{lone(rays.o.x), lone(rays.o.y), lone(rays.o.z)},
                              {lone(rays.d.x), lone(rays.d.y), lone(rays.d.z)},
                              lone(rays.tmin),
                              lone(rays.tmax)};
      HitLanes<One> hit;
      const unsigned met = first_crossings<S>(pool, index, ray, 1, hit);
      hits.t = F(only_lane(hit.t)), hits.u = F(only_lane(hit.u)), hits.v = F(only_lane(hit.v));
      return met << k;
    }
  }
  return first_crossings<S>(pool, index, rays, lanes, hits);
}

template <class S, class A>
void ExactSurfaceCode<S, A>::all(const ExactPoolBase& base, std::uint32_t index, const Ray& ray,
                                 HitList& hits) requires std::is_same_v<A, ScalarIsa> {
  const auto& pool = static_cast<const typename S::Pool&>(base);
  using One = Simd<float, 1, A>;
  using D = Simd<double, 1, A>;
  constexpr int K = S::kMaxCrossings;
  const ExactCell& cell = pool.cells[index];
  const RayLanes<One> rays{broadcast<One>(ray.origin), broadcast<One>(ray.direction), One(ray.tmin),
                           One(ray.tmax)};
  const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
  LineRange<D> range;
  auto active = cell_range<S>(line, cell, range);
  cut_range(range, range_begin(to_double(rays.tmin)));
  const std::uint32_t item = pool.frames[cell.element].item;
  for (active = active & (range.a <= range.b); any(active);) {
    Crossings<K, D> c;
    S::template crossings<K>(pool, cell, line, range, active, c);
    for (int k = 0; k < K; ++k) {
      const float t = static_cast<float>(c.t[k].part[0].v);
      if (ray.tmin < t && t <= ray.tmax && t <= std::numeric_limits<float>::max())
        hits.push({t, static_cast<float>(c.part[k].part[0].v), static_cast<float>(c.turn[k].part[0].v), item,
                   kNoId},
                  static_cast<float>(c.turn[k].part[0].v));
    }
    if (!(c.up_to.part[0].v < range.b.part[0].v)) return;
    cut_range(range, c.up_to);
  }
}

template <class S, class A>
void ExactSurfaceCode<S, A>::lists(const ExactPoolBase& base, std::uint32_t index, const RayLanes<F>& rays,
                                   unsigned lanes, const RayLists<kLanes>& out) {
  const auto& pool = static_cast<const typename S::Pool&>(base);
  using D = Simd<double, F::kWidth, A>;
  constexpr int K = S::kMaxCrossings, W = F::kWidth;
  const ExactCell& cell = pool.cells[index];
  const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
  LineRange<D> range;
  auto active = D::M::from_bits(lanes) & cell_range<S>(line, cell, range);
  cut_range(range, range_begin(to_double(rays.tmin)));
  const std::uint32_t item = pool.frames[cell.element].item;
  const F last(std::numeric_limits<float>::max());
  for (active = active & (range.a <= range.b); any(active);) {
    Crossings<K, D> c;
    S::template crossings<K>(pool, cell, line, range, active, c);
    for (int k = 0; k < K; ++k) {
      if (none(active & (c.t[k] < D(roots::kNoRoot)))) break;
      const F t = to_float(c.t[k]);
      const unsigned valid = bits(mask_cast<float>(active) & (rays.tmin < t) & (t <= last));
      if (valid == 0) continue;
      float places[W], turns[W], parts[W];
      t.store(places), to_float(c.turn[k]).store(turns), to_float(c.part[k]).store(parts);
      for (unsigned rest = valid; rest != 0; rest &= rest - 1) {
        const int i = __builtin_ctz(rest);
        out.list[i]->push({places[i], parts[i], turns[i], item, kNoId}, turns[i]);
      }
    }
    active = active & (c.up_to < range.b);
    cut_range(range, c.up_to);
  }
}

template <class S, class A>
void ExactSurfaceCode<S, A>::rows(const ExactPoolBase& base, std::uint32_t index, const RayLanes<F>& rays,
                                  unsigned lanes, CrossingLanes<kLanes>& out) {
  constexpr int K = S::kMaxCrossings;
  if constexpr (K <= CrossingLanes<kLanes>::kMostPerSolid) {
    const auto& pool = static_cast<const typename S::Pool&>(base);
    using D = Simd<double, F::kWidth, A>;
    const ExactCell& cell = pool.cells[index];
    const Line<D> line = own_line<D>(pool.frames[cell.element].to_own, rays);
    LineRange<D> range;
    auto active = D::M::from_bits(lanes) & cell_range<S>(line, cell, range);
    cut_range(range, range_begin(to_double(rays.tmin)));
    active = active & (range.a <= range.b);
    if (none(active)) return;
    Crossings<K, D> c;
    S::template crossings<K>(pool, cell, line, range, active, c);
    const auto asked = mask_cast<float>(active);
    for (int k = 0; k < K; ++k) {
      const F t = to_float(c.t[k]);
      const auto valid = asked & (rays.tmin < t) & (t <= F(std::numeric_limits<float>::max()));
      push_row(out, valid, t, to_float(c.turn[k]), to_float(c.part[k]), pool.frames[cell.element].item, true);
    }
  }
}

/// Whether S has a filter in lanes of F (kernels/exact/segment.h).
template <class S, class F>
concept Classifies = requires(const typename S::Pool& pool, const ExactCell& cell, const Segment<F>& segment,
                              F& at) {
  S::classify(pool, cell, segment, at);
};

template <class S, class D>
concept HasValue = requires(const typename S::Pool& pool, const ExactCell& cell, const Vec3<D>& p) {
  S::value(pool, cell, p);
};

template <class S, class A>
void ExactSurfaceCode<S, A>::filter(const ExactPoolBase& base, std::uint32_t index, const BeamView& beam,
                                    unsigned groups, BeamLanes& lanes) {
  using G = Simd<float, kBeamGroup, A>;
  if constexpr (!std::is_same_v<A, ScalarIsa> && Classifies<S, G>) {
    const auto& pool = static_cast<const typename S::Pool&>(base);
    const ExactCell& cell = pool.cells[index];
    BeamCell seen;
    if (!seen.set(pool, cell, beam)) return;
    for (; groups != 0; groups &= groups - 1) {
      const int g = __builtin_ctz(groups);
      const BeamCellRays<G> rays(seen, beam, g * kBeamGroup);
      G at;
      const SegmentVerdict<G> verdict = S::classify(pool, cell, rays.segment, at);
      const unsigned maybe = lanes.maybe[g] & ~bits(rays.empty | verdict.misses);
      lanes.maybe[g] = static_cast<std::uint16_t>(maybe);
      if (!beam.any || maybe == 0) continue;
      if constexpr (HasValue<S, Simd<double, 1, A>>)
        lanes.leave[g] = static_cast<std::uint16_t>(maybe & bits(verdict.falls & rays.ends));
      if (!seen.may_be_sure) continue;
      const auto sure = verdict.inside & rays.whole & surely_in_cell(seen, rays.segment, at);
      lanes.sure[g] = static_cast<std::uint16_t>(maybe & bits(sure));
    }
  }
}

template <class S, class A>
unsigned ExactSurfaceCode<S, A>::outside(const ExactPoolBase& base, std::uint32_t index,
                                         const RayLanes<F>& rays, unsigned lanes) {
  using D = Simd<double, F::kWidth, A>;
  if constexpr (!std::is_same_v<A, ScalarIsa> && HasValue<S, D>) {
    const auto& pool = static_cast<const typename S::Pool&>(base);
    const ExactCell& cell = pool.cells[index];
    const Affine& to_own = pool.frames[cell.element].to_own;
    const Vec3<D> o = to_double(rays.o);
    const D value = S::value(pool, cell, map_point(to_own, o));
    // What the map into the own space rounds is less than 2^-50 of the terms that it adds up.
    double most = 0, shift = 1;
    for (const auto& row : to_own.m) {
      most = std::max(most, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
      shift = std::max(shift, std::fabs(row[3]));
    }
    return lanes & bits(D(0x1p-32) * (D(shift) + D(most) * norm1(o)) < value);
  }
  return 0;
}

template <class S, class A>
bool ExactSurfaceCode<S, A>::interactions(const ExactPoolBase& base, ShapeHits& hits) {
  using D = SurfaceLanes<A>;
  if constexpr (HasSlope<S, D>) {
    using Floats = Simd<float, D::kWidth, A>;
    const auto& pool = static_cast<const typename S::Pool&>(base);
    const std::size_t element = hits.element[0];
    if (pool.frames[element].normals != NormalMethod::gradient) return false;
    if constexpr (requires { S::is_smooth(pool, element); })
      if (S::is_smooth(pool, element)) return false;
    for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
      const PickedLanes<Floats> ray(hits.ray + i);
      const HitPoints<D> hit(hits, ray);
      Vec3<D> own;
      const SurfacePoints<D> at =
          exact_surface_points<S>(pool, element, to_double(ray.load(hits.part)), hit, own);
      store_surface(hit, at, PickedLanes<Floats>(hits.entry + i), *hits.out);
      if (hits.with_uv) store_points(own, i, hits);
    }
    return true;
  }
  return false;
}

}  // namespace oktett
