#pragma once
/// \file The state of a beam on its way through the tree, and the exact decisions of its candidates.

#include <limits>

#include "accel/traverse/beam/beam_rays.h"
#include "accel/traverse/inflight/decide_pairs.h"

namespace oktett {

// ---- A block of triangles against a beam: filter functions that are linear in the plane of the beam.
//
// With c the first corner seen from the apex, e1, e2 the edges and n = e1 x e2, a ray (x, y) has the scaled
// weights u = (e2 x c) . (x, y, 1), v = (c x e1) . (x, y, 1) and w = det - u - v with det = n . (x, y, 1)
// (Möller and Trumbore 1997, with the products regrouped for a common origin). All are divided by t = n . c,
// which is the same for all rays: then a hit has all three weights positive, and det becomes the inverse
// depth of the hit. The bounds are derived in docs/numerics.md.

/// Rounding error of the linear functions, in units of their products' magnitudes.
inline constexpr float kBeamError = 20 * 0x1p-24f;
/// The same for t.
inline constexpr float kBeamDepthError = 10 * 0x1p-24f;
/// Relative error of an inverse depth on top of that of t, and of comparing it with a decided t.
inline constexpr float kBeamInverseError = 4 * 0x1p-24f;
/// How far the exact decision may displace a vertex, in units of its distance and relative to kBeamError.
inline constexpr float kBeamShear = 0x1p-28f;
inline constexpr float kBeamUnderflow = 1e-36f;

/// Eight triangles. Function f, of (u, v, w, s), is c[3 f] + c[3 f + 1] x + c[3 f + 2] y, raised by its error
/// bound.
template <class A>
struct alignas(64) ProjectedTriangles {
  static constexpr int kSize = TriangleBlock::kSize;
  float c[12][kSize];
  float group[4][kSize];     ///< c[3 f] + the most that function f grows from the middle of a regular group
  float sure[kSize];         ///< a ray surely hits if u, v and w are all above this
  float lower_scale[kSize];  ///< then its inverse depth is at least s * lower_scale - lower_gap
  float lower_gap[kSize];
};

/// The triangles of a block that a beam may hit, a bit each.
struct BlockCandidates {
  unsigned projected;  ///< those that may be hit by a ray of the window
  unsigned edge_on;    ///< those whose plane passes so close to the apex that they cannot be projected
};

/// Upper bound of the linear function (a, b, c) in the rectangle around (mx, my) with half sides (hx, hy).
template <class F>
OKTETT_INLINE F greatest(const F& a, const F& b, const F& c, const F& mx, const F& my, const F& hx,
                         const F& hy) {
  return fast_fma(abs(b), hx, fast_fma(abs(c), hy, fast_fma(b, mx, fast_fma(c, my, a))));
}

/// Projects the triangles of a block, and rejects those that no ray in `w` hits.
template <class A>
OKTETT_INLINE BlockCandidates project_block(const TriangleLeaf& leaf, int count, const BeamRays<A>& beam,
                                            const BeamWindow& w, ProjectedTriangles<A>& out) {
  using B = Simd<float, TriangleBlock::kSize, A>;
  const TriangleLanes<B> tri = load_triangles<B>(leaf, 0, beam.axis[2]);
  const auto from = [&](const Vec3<B>& p, const Vec3<B>& q) {
    return Vec3<B>{q.x - p.x, q.y - p.y, beam.mirrored ? p.z - q.z : q.z - p.z};
  };
  const Vec3<B> apex{B(beam.apex[0]), B(beam.apex[1]), B(beam.apex[2])};
  const Vec3<B> c = from(apex, tri.a), e1 = from(tri.a, tri.b), e2 = from(tri.a, tri.c);
  const Vec3<B> u = fast_cross(e2, c), v = fast_cross(c, e1), n = fast_cross(e1, e2);
  const B t = fast_dot(n, c);

  const B n1 = norm1(e1), n2 = norm1(e2), size = n1 + n2, reach = norm1(c) + size, area = n1 * n2;
  const B spread(beam.spread), tiny(kBeamUnderflow);
  const B farthest = max(abs(c.x), max(abs(c.y), abs(c.z)));
  const B t_error =
      fast_fma(area, fast_fma(farthest, B(kBeamDepthError), B(beam.slip + 2 * beam.behind) * spread), tiny);
  const auto projectable = abs(t) > t_error + t_error;
  const B inverse = B(1.0f) / t, scale = abs(inverse);
  const B shear = fast_fma(reach, B(kBeamShear), size);
  const B error =
      scale * fast_fma(spread, fast_fma(shear * reach, B(kBeamError), size * B(2 * beam.slip)), tiny);
  const B s_error = scale * fast_fma(area * spread, B(kBeamError), tiny);
  const B depth_error = fast_fma(t_error * scale, B(2.0f), B(kBeamInverseError));

  const Vec3<B> ui{u.x * inverse, u.y * inverse, u.z * inverse},
      vi{v.x * inverse, v.y * inverse, v.z * inverse}, si{n.x * inverse, n.y * inverse, n.z * inverse};
  const Vec3<B> wi{si.x - (ui.x + vi.x), si.y - (ui.y + vi.y), si.z - (ui.z + vi.z)};
  const B raise = B(1.0f) + depth_error;
  const Vec3<B> f[4] = {{ui.z + error, ui.x, ui.y},
                        {vi.z + error, vi.x, vi.y},
                        {wi.z + error, wi.x, wi.y},
                        {fast_fma(si.z, raise, s_error), si.x * raise, si.y * raise}};
  // The greatest value of a function in a patch, rounding of the patch itself included.
  const B pad(beam.spread * 0x1p-21f);
  const auto within = [&](const Vec3<B>& g, const BeamPatch& p) {
    return fast_fma(abs(g.y) + abs(g.z), pad,
                    abs(fast_fma(g.y, B(p.x1), g.z * B(p.y1))) + abs(fast_fma(g.y, B(p.x2), g.z * B(p.y2))));
  };
  const auto top = [&](const Vec3<B>& g) {
    return within(g, w.patch) + fast_fma(g.y, B(w.patch.x), fast_fma(g.z, B(w.patch.y), g.x));
  };
  const B s_top = top(f[3]);
  const B zero(0.0f);
  // A lane is rejected only by a comparison that is true, so NaN keeps it.
  const auto reject = (top(f[0]) < zero) | (top(f[1]) < zero) | (top(f[2]) < zero) | (s_top <= B(w.least));
  const unsigned all = (1u << count) - 1, flat = all & ~bits(projectable);
  const unsigned keep = all & ~flat & ~bits(reject);
  if (keep != 0) {
    for (int k = 0; k < 4; ++k) {
      f[k].x.store(out.c[3 * k]), f[k].y.store(out.c[3 * k + 1]), f[k].z.store(out.c[3 * k + 2]);
      if (beam.regular) (f[k].x + within(f[k], beam.shape)).store(out.group[k]);
    }
    // No hit is sure where it may lie before the beginning of a ray, or where a product may overflow.
    const auto plain = (s_top < B(beam.near_s)) & (scale * size * reach < B(1e30f));
    select(plain, error * B(2.25f), B(std::numeric_limits<float>::infinity())).store(out.sure);
    (B(1.0f) - fast_fma(depth_error, B(2.0f), B(kBeamInverseError))).store(out.lower_scale);
    (s_error * B(2.5f)).store(out.lower_gap);
  }
  return {keep, flat};
}

/// Those of `groups` that may hit triangle `k`.
template <class A>
OKTETT_INLINE unsigned groups_meeting(const ProjectedTriangles<A>& p, int k, const BeamRays<A>& beam,
                                      unsigned groups) {
  using G = Simd<float, kBeamGroups, A>;
  const G zero(0.0f), mx = G::load(beam.x_mid), my = G::load(beam.y_mid);
  const auto top = [&](int f) {
    const G b(p.c[3 * f + 1][k]), c(p.c[3 * f + 2][k]);
    if (beam.regular) return fast_fma(b, mx, fast_fma(c, my, G(p.group[f][k])));
    return greatest(G(p.c[3 * f][k]), b, c, mx, my, G::load(beam.x_half), G::load(beam.y_half));
  };
  const auto reject = (top(0) < zero) | (top(1) < zero) | (top(2) < zero) | (top(3) <= G::load(beam.least));
  return groups & ~bits(reject);
}

/// What the filter says of a triangle and the rays of a group, a bit each.
struct GroupVerdict {
  unsigned sure;     ///< surely hit, and surely nearer than the nearest hit so far
  unsigned unclear;  ///< may be hit and may be nearer: to be decided
};

/// Triangle `k` against the rays of one group. A sure hit becomes the candidate of its ray; for an any-hit
/// query it ends the ray. Only any-hit queries branch on whether all rays miss: shadow rays mostly do, while
/// for camera rays the branch would often be mispredicted.
template <bool kAny, class A>
OKTETT_INLINE GroupVerdict meet_group(const ProjectedTriangles<A>& p, int k, std::uint32_t id,
                                      BeamRays<A>& beam, int group) {
  using F = Simd<float, kBeamGroup, A>;
  const int base = group * kBeamGroup;
  const F x = F::load(beam.x + base), y = F::load(beam.y + base);
  const auto value = [&](int f) {
    return fast_fma(F(p.c[3 * f + 1][k]), x, fast_fma(F(p.c[3 * f + 2][k]), y, F(p.c[3 * f][k])));
  };
  const F least = min(value(0), min(value(1), value(2))), s = value(3);
  const F hit_lo = F::load(beam.hit_lo + base);
  const auto reject = (least < F(0.0f)) | (s <= hit_lo);
  if (kAny && (~bits(reject) & 0xffff) == 0) return {0, 0};
  const F hit_hi = F::load(beam.hit_hi + base), s_lo = fast_fma(s, F(p.lower_scale[k]), F(-p.lower_gap[k]));
  // Rays with s <= hit_lo are not sure: their s_lo is below hit_hi.
  const auto sure = (F(p.sure[k]) < least) & (hit_hi < s_lo);
  select(sure, kAny ? F(std::numeric_limits<float>::infinity()) : s_lo, hit_lo).store(beam.hit_lo + base);
  if (!kAny) {
    using I = Simd<std::int32_t, kBeamGroup, A>;
    select(sure, s, hit_hi).store(beam.hit_hi + base);
    std::int32_t* ids = reinterpret_cast<std::int32_t*>(beam.candidate + base);
    select(mask_cast<std::int32_t>(sure), I(static_cast<std::int32_t>(id)), I::load(ids)).store(ids);
  }
  return {bits(sure), bits(~(reject | sure)) & 0xffff};
}

// ---- The state of a beam on its way through the tree, and the exact decisions of its candidates.

/// Pairs of a triangle and a ray that the filter could neither reject nor accept.
struct UnclearList {
  static constexpr int kSize = 512;
  std::uint32_t triangle[kSize + kBeamGroup];  ///< 8 * block + lane
  std::uint8_t ray[kSize + kBeamGroup];
  int size = 0;
};

/// Mailboxes (Amanatides and Woo 1987) for triangles that stand in several leaves: which groups have been
/// tested against a triangle. Another triangle may take over an entry; then the first is tested twice, which
/// does no harm.
class MetTriangles {
 public:
  MetTriangles() { clear(); }
  /// Forgets everything, for groups of other rays.
  void clear() { std::fill_n(item_, kSize, kNoId); }
  /// Notes that `groups` are tested against `item`. Returns those of them that were not before.
  OKTETT_INLINE unsigned add(std::uint32_t item, unsigned groups) {
    const std::uint32_t at = item * 0x9e3779b1u >> 26;
    const unsigned met = item_[at] == item ? groups_[at] : 0;
    item_[at] = item, groups_[at] = met | groups;
    return groups & ~met;
  }

 private:
  static constexpr int kSize = 64;
  std::uint32_t item_[kSize], groups_[kSize];
};

/// BeamTask::max_steps of a beam that is never given up.
inline constexpr int kAnySteps = std::numeric_limits<int>::max();

template <Query Q, class A>
class BeamInstances;

/// A beam, what it has found, and where its results go.
template <Query Q, class A>
struct BeamTask {
  const Accel& accel;
  const RaySpan& rays;
  const HitSink<Q>& out;  ///< complete only when the beam is finished
  BeamRays<A> beam;
  UnclearList unclear;
  int max_steps;                   ///< nodes and leaves that it may visit before it is given up
  BeamInstances<Q, A>* instances;  ///< where there are instances
  MetTriangles met = {};           ///< in use if triangles stand in several leaves
  bool decided = false;            ///< some hits have been decided and stand in `out`
};

/// The rays of group `g` that are not finished: an any-hit ray that is known to be blocked is.
template <class A>
OKTETT_INLINE unsigned open_rays(const BeamRays<A>& beam, int g) {
  using F = Simd<float, kBeamGroup, A>;
  return bits(F::load(beam.hit_lo + g * kBeamGroup) < F(std::numeric_limits<float>::infinity()));
}

/// Notes that the any-hit rays [at, at + N) in `lanes` are blocked.
template <int N, class A>
OKTETT_INLINE void block_rays(BeamRays<A>& beam, std::size_t at, unsigned lanes) {
  using F = Simd<float, N, A>;
  const F infinity(std::numeric_limits<float>::infinity());
  select(F::M::from_bits(lanes), infinity, F::load(beam.hit_lo + at)).store(beam.hit_lo + at);
}

/// Stores the decided hit `h` of ray i if it is the nearest so far. `dz`: the |direction| of the ray along z.
template <class A>
OKTETT_INLINE void accept_beam(const HitSpan& hits, BeamRays<A>& beam, float dz, std::size_t i,
                               const Hit& h) {
  if (h.t > hits.t[i]) return;
  if (h.t == hits.t[i] && hits.item[i] != kNoId && !comes_first(h, hits[i])) return;
  hits.set(i, h);
  const float s = 1 / (h.t * dz);
  const float lo = s * (1 - kBeamPointSlack), hi = s * (1 + kBeamPointSlack);
  beam.hit_lo[i] = lo > beam.hit_lo[i] ? lo : beam.hit_lo[i];
  beam.hit_hi[i] = hi > beam.hit_hi[i] ? hi : beam.hit_hi[i];
}

/// Loads the decided hits of a group into `r`, so that hits of other shapes are compared with them.
template <class A>
OKTETT_INLINE void load_hits(const HitSpan& hits, std::size_t base, RayState<kBeamGroup, A>& r) {
  for (std::size_t i = 0; i < kBeamGroup && base + i < hits.size; ++i) {
    if (hits.item[base + i] == kNoId) continue;
    r.tmax[i] = hits.t[base + i], r.u[i] = hits.u[base + i], r.v[i] = hits.v[base + i];
    r.item[i] = hits.item[base + i], r.path[i] = hits.instance[base + i];
  }
}

/// Stores the hits `h` of the rays [at, at + width) in `met`. `dz`: their directions along z.
template <class F, class I, class A>
OKTETT_INLINE void store_hits(const HitSpan& hits, BeamRays<A>& beam, const F& dz, std::size_t at,
                              unsigned met, const HitLanes<F>& h, const I& item, const I& instance) {
  const auto found = F::M::from_bits(met);
  if (at + F::kWidth <= hits.size) {
    const auto put = [&](const F& x, float* to) { select(found, x, F::load(to + at)).store(to + at); };
    const auto put_ids = [&](const I& ids, std::uint32_t* column) {
      auto* to = reinterpret_cast<std::int32_t*>(column + at);
      select(mask_cast<std::int32_t>(found), ids, I::load(to)).store(to);
    };
    put(h.t, hits.t), put(h.u, hits.u), put(h.v, hits.v);
    put_ids(item, hits.item), put_ids(instance, hits.instance);
  } else {
    alignas(64) float t[F::kWidth], u[F::kWidth], v[F::kWidth];
    alignas(64) std::int32_t items[F::kWidth], instances[F::kWidth];
    h.t.store(t), h.u.store(u), h.v.store(v), item.store(items), instance.store(instances);
    for (unsigned rest = met; rest != 0; rest &= rest - 1) {
      const int i = __builtin_ctz(rest);
      hits.set(at + static_cast<std::size_t>(i), {t[i], u[i], v[i], static_cast<std::uint32_t>(items[i]),
                                                  static_cast<std::uint32_t>(instances[i])});
    }
  }
  const F s = F(1.0f) / (h.t * abs(dz));
  const auto raise = [&](float* column, float slack) {
    const F was = F::load(column + at);
    select(found, max(s * F(slack), was), was).store(column + at);
  };
  raise(beam.hit_lo, 1 - kBeamPointSlack), raise(beam.hit_hi, 1 + kBeamPointSlack);
}

/// The same for the hits of `r`.
template <class A>
OKTETT_INLINE void store_hits(const HitSpan& hits, BeamRays<A>& beam, std::size_t base, unsigned met,
                              const RayState<kBeamGroup, A>& r) {
  using F = Simd<float, kBeamGroup, A>;
  const auto ids = [](const std::uint32_t* from) {
    return Simd<std::int32_t, kBeamGroup, A>::load(reinterpret_cast<const std::int32_t*>(from));
  };
  const HitLanes<F> h{F::load(r.tmax), F::load(r.u), F::load(r.v)};
  store_hits(hits, beam, F::load(r.d[beam.axis[2]]), base, met, h, ids(r.item), ids(r.path));
}

/// Sixteen misses from position `base`.
template <class A>
OKTETT_INLINE void store_misses(const HitSpan& hits, std::size_t base) {
  using F = Simd<float, kBeamGroup, A>;
  const F zero(0.0f);
  F(std::numeric_limits<float>::infinity()).store(hits.t + base);
  zero.store(hits.u + base), zero.store(hits.v + base);
  std::memset(hits.item + base, 0xff, kBeamGroup * sizeof(std::uint32_t));
  std::memset(hits.instance + base, 0xff, kBeamGroup * sizeof(std::uint32_t));
}

/// Before the first decision: stores a miss for every ray.
template <Query Q, class A>
OKTETT_INLINE void begin_decisions(BeamTask<Q, A>& task) {
  if constexpr (Q == Query::closest) {
    if (task.decided) return;
    task.decided = true;
    std::size_t i = 0;
    for (; i + kBeamGroup <= task.rays.size; i += kBeamGroup) store_misses<A>(task.out.hits, i);
    for (; i < task.rays.size; ++i) task.out.set(i, Hit{});
  }
}

/// Decides `count` (up to 16) pairs of a ray and a triangle.
template <Query Q, class A>
OKTETT_NOINLINE void decide_listed(BeamTask<Q, A>& task, const std::uint8_t* ray,
                                   const std::uint32_t* triangle, int count) {
  using F = Simd<float, kBeamGroup, A>;
  alignas(64) float column[8][kBeamGroup];
  std::uint32_t ids[kBeamGroup];
  for (int i = 0; i < kBeamGroup; ++i) {
    const int k = i < count ? i : 0;
    const Ray r = task.rays[task.beam.sorted ? task.beam.order[ray[k]] : ray[k]];
    const float values[8] = {r.origin.x,    r.origin.y,    r.origin.z, r.direction.x,
                             r.direction.y, r.direction.z, r.tmin,     r.tmax};
    for (int c = 0; c < 8; ++c) column[c][i] = values[c];
    ids[i] = triangle[k];
  }
  const auto load = [&](int c) { return F::load(column[c]); };
  const RayLanes<F> rays{{load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6), load(7)};
  HitLanes<F> hit;
  const unsigned met = decide_pairs<kBeamGroup, A>(rays, task.accel.blocks.data(), ids, hit);
  each_hit(met & ((1u << count) - 1), hit, [&](int i, float t, float u, float v) {
    if constexpr (Q == Query::any) {
      task.beam.hit_lo[ray[i]] = std::numeric_limits<float>::infinity();
    } else {
      const std::uint32_t item =
          task.accel.triangles(ids[i] / TriangleBlock::kSize).item(ids[i] % TriangleBlock::kSize);
      accept_beam(task.out.hits, task.beam, __builtin_fabsf(column[3 + task.beam.axis[2]][i]), ray[i],
                  {t, u, v, item, kNoId});
    }
  });
}

/// Decides the list of unclear candidates.
template <Query Q, class A>
OKTETT_NOINLINE void decide_unclear(BeamTask<Q, A>& task) {
  begin_decisions(task);
  UnclearList& list = task.unclear;
  for (int i = 0; i < list.size; i += kBeamGroup) {
    if (Q == Query::any) {
      // Rays that are known to be occluded need no decision.
      int kept = 0;
      const int end = std::min(list.size, i + kBeamGroup);
      for (int k = i; k < end; ++k) {
        if (task.beam.hit_lo[list.ray[k]] == std::numeric_limits<float>::infinity()) continue;
        list.ray[i + kept] = list.ray[k], list.triangle[i + kept] = list.triangle[k], ++kept;
      }
      if (kept > 0) decide_listed(task, list.ray + i, list.triangle + i, kept);
    } else {
      decide_listed(task, list.ray + i, list.triangle + i, std::min(list.size - i, kBeamGroup));
    }
  }
  list.size = 0;
}

/// Lists `rays` of a group as unclear against triangle `id`. Decides the list when it is full.
template <Query Q, class A>
OKTETT_INLINE void note_unclear(BeamTask<Q, A>& task, unsigned rays, int group, std::uint32_t id) {
  UnclearList& list = task.unclear;
  for (; rays != 0; rays &= rays - 1) {
    list.ray[list.size] = static_cast<std::uint8_t>(group * kBeamGroup + __builtin_ctz(rays));
    list.triangle[list.size++] = id;
  }
  if (OKTETT_UNLIKELY(list.size >= UnclearList::kSize)) decide_unclear(task);
}

/// Decides the candidates of a group, so that hits of other shapes can be compared with them.
template <Query Q, class A>
OKTETT_NOINLINE void decide_candidates(BeamTask<Q, A>& task, int group) {
  if (task.accel.blocks.data() == nullptr) return;  // without triangles there are no candidates
  std::uint8_t ray[kBeamGroup];
  std::uint32_t ids[kBeamGroup];
  int count = 0;
  for (int i = group * kBeamGroup; i < (group + 1) * kBeamGroup; ++i) {
    if (task.beam.candidate[i] == kNoId) continue;
    ray[count] = static_cast<std::uint8_t>(i), ids[count++] = task.beam.candidate[i];
    task.beam.candidate[i] = kNoId;
  }
  if (count > 0) decide_listed(task, ray, ids, count);
}

/// Decides the candidates of a whole group and stores the hits.
template <class A>
OKTETT_INLINE void finish_group(BeamTask<Query::closest, A>& task, std::size_t base) {
  using F = Simd<float, kBeamGroup, A>;
  using I = Simd<std::int32_t, kBeamGroup, A>;
  constexpr std::uint32_t kSize = TriangleBlock::kSize;
  const HitSpan& hits = task.out.hits;
  const std::uint32_t* candidates = task.beam.candidate + base;
  const TriangleBlock* blocks = task.accel.blocks.data();
  const auto as_int = [](auto* p) { return reinterpret_cast<std::int32_t*>(p); };
  const I notes = I::load(reinterpret_cast<const std::int32_t*>(candidates)), nothing(-1);
  const auto none = notes == nothing;
  const unsigned missing = bits(none);
  if (missing == (1u << kBeamGroup) - 1) return store_misses<A>(hits, base);
  const std::uint32_t some = candidates[__builtin_ctz(~missing)];
  alignas(64) std::uint32_t ids[kBeamGroup];
  select(none, I(static_cast<std::int32_t>(some)), notes).store(as_int(ids));
  HitLanes<F> h;
  decide_pairs<kBeamGroup, A>(load_span<F>(task.rays, base), blocks, ids, h);
  const auto miss = F::M::from_bits(missing);
  const F zero(0.0f);
  select(miss, F(std::numeric_limits<float>::infinity()), h.t).store(hits.t + base);
  select(miss, zero, h.u).store(hits.u + base), select(miss, zero, h.v).store(hits.v + base);
  alignas(64) std::uint32_t items[kBeamGroup];
  for (int i = 0; i < kBeamGroup; ++i) items[i] = TriangleLeaf(blocks, ids[i] / kSize).item(ids[i] % kSize);
  select(none, nothing, I::load(as_int(items))).store(as_int(hits.item + base));
  std::memset(hits.instance + base, 0xff, kBeamGroup * sizeof(std::uint32_t));
}

/// Writes the results of a finished beam.
template <class A>
OKTETT_INLINE void finish_beam(BeamTask<Query::closest, A>& task) {
  const std::size_t whole = task.decided ? 0 : task.rays.size / kBeamGroup * kBeamGroup;
  for (std::size_t base = 0; base < whole; base += kBeamGroup) finish_group(task, base);
  if (!task.decided)
    for (std::size_t i = whole; i < task.rays.size; ++i) task.out.set(i, Hit{});
  task.decided = true;
  for (std::size_t base = whole; base < task.rays.size; base += kBeamGroup)
    decide_candidates(task, static_cast<int>(base / kBeamGroup));
  if (task.unclear.size > 0) decide_unclear(task);
}

template <class A>
OKTETT_INLINE void finish_beam(BeamTask<Query::any, A>& task) {
  if (task.unclear.size > 0) decide_unclear(task);
  const BeamRays<A>& beam = task.beam;
  using F = Simd<float, kBeamGroup, A>;
  const F infinity(std::numeric_limits<float>::infinity());
  std::uint8_t found[kBeamRays];
  for (int base = 0; base < kBeamRays; base += kBeamGroup) {
    // Rays that could not hit anything from the start have no end either.
    const unsigned done =
        bits((F::load(beam.hit_lo + base) == infinity) & (F::load(beam.hit_hi + base) < infinity));
    for (int i = 0; i < kBeamGroup; ++i) found[base + i] = static_cast<std::uint8_t>(done >> i & 1);
  }
  if (beam.sorted) {
    for (int i = 0; i < kBeamRays; ++i) task.out.occluded[beam.order[i]] = found[i];
  } else {
    std::memcpy(task.out.occluded, found, task.rays.size);
  }
}

}  // namespace oktett
