#pragma once
/// \file A block of triangles against a beam: filter functions that are linear in the plane of the beam.
///
/// With c the first corner seen from the apex, e1, e2 the edges and n = e1 x e2, a ray (x, y) has the scaled
/// weights u = (e2 x c) . (x, y, 1), v = (c x e1) . (x, y, 1) and w = det - u - v with det = n . (x, y, 1)
/// (Möller and Trumbore 1997, with the products regrouped for a common origin). All are divided by t = n . c,
/// which is the same for all rays: then a hit has all three weights positive, and det becomes the inverse
/// depth of the hit. The bounds are derived in docs/numerics.md.

#include "accel/traverse/beam/beam_rays.h"

namespace oktett {

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
OKTETT_INLINE BlockCandidates project_block(const TriangleBlock& block, int count, const BeamRays<A>& beam,
                                            const BeamWindow& w, ProjectedTriangles<A>& out) {
  using B = Simd<float, TriangleBlock::kSize, A>;
  const TriangleLanes<B> tri = load_triangles<B>(block, 0, beam.axis[2]);
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

}  // namespace oktett
