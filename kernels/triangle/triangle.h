#pragma once
/// \file The triangles of meshes in leaves of the tree: blocks of eight with their corners.

#include <cstdint>

#include "core/lanes.h"
#include "core/simd_memory.h"
#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

// ---- The textbook ray-triangle tests, in float: Möller-Trumbore, Badouel, Segura-Feito. They are fast and
// simple, but neighbours may disagree about a shared edge. Each has a fixed order of operations, so its hits
// have the same bits in every width and instruction set.

/// Möller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection" (1997), both sides.
template <class F>
OKTETT_INLINE typename F::M moller_trumbore(const RayLanes<F>& ray, const TriangleLanes<F>& tri,
                                            HitLanes<F>& hit) {
  const F zero(0.0f), one(1.0f);
  const Vec3<F> e1 = sub_lanes(tri.b, tri.a), e2 = sub_lanes(tri.c, tri.a);
  const Vec3<F> p = cross_lanes(ray.d, e2);
  const F det = dot_lanes(e1, p);
  const F inv = one / det;
  const Vec3<F> s = sub_lanes(ray.o, tri.a);
  hit.u = dot_lanes(s, p) * inv;
  const Vec3<F> q = cross_lanes(s, e1);
  hit.v = dot_lanes(ray.d, q) * inv;
  hit.t = dot_lanes(e2, q) * inv;
  return ~(det == zero) & (hit.u >= zero) & (hit.v >= zero) & (hit.u + hit.v <= one) & (ray.tmin < hit.t) &
         (hit.t <= ray.tmax);
}

/// Badouel, "An Efficient Ray-Polygon Intersection" (Graphics Gems, 1990): the hit point on the plane, then
/// barycentric coordinates of its projection along the normal's dominant axis. Projection keeps the ratios of
/// areas.
template <class F>
OKTETT_INLINE typename F::M badouel(const RayLanes<F>& ray, const TriangleLanes<F>& tri, HitLanes<F>& hit) {
  const F zero(0.0f), one(1.0f);
  const Vec3<F> e1 = sub_lanes(tri.b, tri.a), e2 = sub_lanes(tri.c, tri.a);
  const Vec3<F> n = cross_lanes(e1, e2);
  const F det = dot_lanes(n, ray.d);
  const Vec3<F> s = sub_lanes(tri.a, ray.o);
  hit.t = dot_lanes(n, s) / det;
  const Vec3<F> p{hit.t * ray.d.x - s.x, hit.t * ray.d.y - s.y, hit.t * ray.d.z - s.z};
  const F nx = abs(n.x), ny = abs(n.y), nz = abs(n.z);
  const auto use_x = (nx >= ny) & (nx >= nz);
  const auto use_y = ~use_x & (ny >= nz);
  // The two axes that remain, in cyclic order so that the area keeps the sign of the normal's component.
  const auto pick = [&](const F& if_x, const F& if_y, const F& if_z) {
    return select(use_x, if_x, select(use_y, if_y, if_z));
  };
  const F p1 = pick(p.y, p.z, p.x), p2 = pick(p.z, p.x, p.y);
  const F a1 = pick(e1.y, e1.z, e1.x), a2 = pick(e1.z, e1.x, e1.y);
  const F b1 = pick(e2.y, e2.z, e2.x), b2 = pick(e2.z, e2.x, e2.y);
  const F area = one / pick(n.x, n.y, n.z);
  hit.u = (p1 * b2 - p2 * b1) * area;
  hit.v = (a1 * p2 - a2 * p1) * area;
  return ~(det == zero) & (hit.u >= zero) & (hit.v >= zero) & (hit.u + hit.v <= one) & (ray.tmin < hit.t) &
         (hit.t <= ray.tmax);
}

/// Segura and Feito, "Algorithms to Test Ray-Triangle Intersection" (2001): the ray's line passes the
/// triangle if the signed volumes of the tetrahedra over its edges agree. Made for rays that need no hit
/// point: u, v and t come from the same volumes and are computed here so that all tests share one contract.
template <class F>
OKTETT_INLINE typename F::M segura_feito(const RayLanes<F>& ray, const TriangleLanes<F>& tri,
                                         HitLanes<F>& hit) {
  const F zero(0.0f);
  const Vec3<F> a = sub_lanes(tri.a, ray.o), b = sub_lanes(tri.b, ray.o), c = sub_lanes(tri.c, ray.o);
  const F wa = dot_lanes(ray.d, cross_lanes(c, b));
  const F wb = dot_lanes(ray.d, cross_lanes(a, c));
  const F wc = dot_lanes(ray.d, cross_lanes(b, a));
  const auto inside =
      ((wa >= zero) & (wb >= zero) & (wc >= zero)) | ((wa <= zero) & (wb <= zero) & (wc <= zero));
  const F sum = (wa + wb) + wc;
  const F volume = -dot_lanes(a, cross_lanes(b, c));
  hit.t = volume / sum;
  hit.u = wb / sum;
  hit.v = wc / sum;
  return inside & ~(sum == zero) & (ray.tmin < hit.t) & (hit.t <= ray.tmax);
}

// ---- The triangles of meshes in leaves of the tree.

/// Up to eight triangles and the up to sixteen corners that they share: 256 bytes. Unused lanes have the same
/// corner three times, so no ray hits them, and the item kNoId.
struct alignas(64) TriangleBlock {
  static constexpr int kSize = 8, kCorners = 16;
  float point[3][kCorners];      ///< the corners, [axis][number]; unused ones repeat number 0
  std::uint16_t corners[kSize];  ///< of each triangle: the number of corner k in the bits from 4 k on
  std::uint32_t item[kSize];
  std::uint32_t padding[4];

  /// The number of corner `k` of triangle `lane`.
  int corner(int k, int lane) const { return corners[lane] >> 4 * k & 15; }
  Vec3f vertex(int k, int lane) const {
    const int n = corner(k, lane);
    return {point[0][n], point[1][n], point[2][n]};
  }
};
static_assert(sizeof(TriangleBlock) == 256);

/// Triangle `lane` in all lanes of F, its axes permuted so that `z_axis` comes last (2 = as they are).
template <class F>
OKTETT_INLINE TriangleLanes<F> broadcast_triangle(const TriangleBlock& b, int lane, int z_axis = 2) {
  const auto corner = [&](int k) {
    const int n = b.corner(k, lane);
    return Vec3<F>{F(b.point[(z_axis + 1) % 3][n]), F(b.point[(z_axis + 2) % 3][n]), F(b.point[z_axis][n])};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Triangles `first`, `first` + 1, ... in the lanes of F.
template <class F>
OKTETT_INLINE TriangleLanes<F> load_triangles(const TriangleBlock& b, int first = 0, int z_axis = 2) {
  const PackedIndices<F::kWidth, typename F::Isa> corners(b.corners + first);
  const auto corner = [&](int k) {
    const auto axis = [&](int a) { return corners.look_up(k, b.point[a]); };
    return Vec3<F>{axis((z_axis + 1) % 3), axis((z_axis + 2) % 3), axis(z_axis)};
  };
  return {corner(0), corner(1), corner(2)};
}

/// (b - a) x (c - a).
OKTETT_INLINE Vec3f triangle_normal(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return cross(b - a, c - a);
}

}  // namespace oktett
