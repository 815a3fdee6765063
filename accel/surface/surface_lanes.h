#pragma once
/// \file The surface at hits of meshes and closed forms, in lanes. Single hits use the same functions with
/// one lane, so a hit gets the same bits alone and in a group.

#include "accel/accel_data.h"
#include "accel/code.h"
#include "core/lanes.h"
#include "core/simd_native.h"
#include "kernels/closed/surface_points.h"

namespace oktett {

// ---- The surface at hits of a mesh, in lanes.

inline MeshFrame mesh_frame(const Geometry& geometry, const GeometryFrame& frame) {
  const auto& shape = std::get<MeshGeometry>(geometry.shape);
  const bool smooth = shape.smooth && !shape.mesh->normal_indices.empty();
  if (frame.identity) return {nullptr, nullptr, frame.mirrored, smooth};
  return {&geometry.transform, &frame.inverse, frame.mirrored, smooth};
}

/// Corner `k` of a triangle, in the mesh's own space.
inline const Vec3f& corner_position(const TriangleMesh& mesh, std::uint32_t triangle, int k) {
  return mesh.positions[mesh.indices[3 * std::size_t{triangle} + k]];
}

/// The normals at the corners of a triangle of a mesh that has normals; zero if any of them is missing.
inline void corner_normals(const TriangleMesh& mesh, std::uint32_t triangle, Vec3f (&normals)[3]) {
  const std::uint32_t* index = &mesh.normal_indices[3 * std::size_t{triangle}];
  const bool known = index[0] != kNoId && index[1] != kNoId && index[2] != kNoId;
  for (int k = 0; k < 3; ++k) normals[k] = known ? mesh.normals[index[k]] : Vec3f{};
}

/// Texture coordinates where a triangle is hit at (u, v), from those of its corners.
inline Vec2f weighted_uv(const std::array<Vec2f, 3>& uv, float u, float v) {
  const float w = 1 - u - v;
  return {uv[0].x * w + uv[1].x * u + uv[2].x * v, uv[0].y * w + uv[1].y * u + uv[2].y * v};
}

/// Surfaces of mesh hits in lanes; the members are those of SurfaceInteraction.
template <class F>
struct MeshSurface {
  Vec3<F> position, position_error, geometric_normal, shading_normal;
};

/// A corner where the frame puts it.
template <int W, class A>
OKTETT_INLINE Vec3<Simd<float, W, A>> place_corner(const MeshFrame& frame, const Vec3<Simd<float, W, A>>& p) {
  return frame.to_world == nullptr ? p : to_float(map_point(*frame.to_world, to_double(p)));
}

/// a wa + b wb + c wc in each component.
template <class F>
OKTETT_INLINE Vec3<F> weigh(const Vec3<F> (&p)[3], const F& wa, const F& wb, const F& wc) {
  return {p[0].x * wa + p[1].x * wb + p[2].x * wc, p[0].y * wa + p[1].y * wb + p[2].y * wc,
          p[0].z * wa + p[1].z * wb + p[2].z * wc};
}

/// The size of a triangle in one coordinate of its corners, up to twice its extent.
template <class F>
OKTETT_INLINE F spread(const F& a, const F& b, const F& c) {
  return abs(b - a) + abs(c - a);
}

/// Bound on the error of the interpolated coordinate a wa + b wb + c wc: gamma(7) bounds the rounding of the
/// interpolation (Pharr, Jakob, Humphreys 2016, section 3.9.4); the weights, which are rounded to float, add
/// two more units. `least` is what the intersection test may be off by: the other two errors are zero where a
/// triangle lies in a coordinate plane.
template <class F>
OKTETT_INLINE F weighted_error(const F& a, const F& b, const F& c, const F& wa, const F& wb, const F& wc,
                               const F& least) {
  const F magnitude = abs(a * wa) + abs(b * wb) + abs(c * wc);
  const F error = F(0x1p-21f) * magnitude + F(0x1p-22f) * spread(a, b, c) + F(1e-37f);
  return select(error < least, least, error);
}

/// The surface of triangles with corners `p`, in their place, at barycentric coordinates u, v. `normals` are
/// those of the corners in the mesh's own space, zero where unknown; they count only if frame.smooth.
template <int W, class A>
OKTETT_INLINE MeshSurface<Simd<float, W, A>> mesh_surface(const MeshFrame& frame,
                                                          const Vec3<Simd<float, W, A>> (&p)[3],
                                                          const Vec3<Simd<float, W, A>> (&normals)[3],
                                                          const Simd<float, W, A>& u,
                                                          const Simd<float, W, A>& v) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  const F w = F(1.0f) - u - v;
  MeshSurface<F> s;
  s.position = weigh(p, w, u, v);
  const F size =
      spread(p[0].x, p[1].x, p[2].x) + spread(p[0].y, p[1].y, p[2].y) + spread(p[0].z, p[1].z, p[2].z);
  // The test shifts a triangle by up to 2^-50 of its size and its distance, which is small for rays that
  // leave it.
  const F least = F(0x1p-46f) * size;
  s.position_error = {weighted_error(p[0].x, p[1].x, p[2].x, w, u, v, least),
                      weighted_error(p[0].y, p[1].y, p[2].y, w, u, v, least),
                      weighted_error(p[0].z, p[1].z, p[2].z, w, u, v, least)};
  const Vec3<D> a = to_double(p[0]);
  const Vec3<D> n = cross_lanes(sub_lanes(to_double(p[1]), a), sub_lanes(to_double(p[2]), a));
  // A mirror reverses the winding of the corners, but what was outside stays outside.
  s.geometric_normal = scale_lanes(float_quotients(n, length_lanes(n)), F(frame.mirrored ? -1.0f : 1.0f));
  s.shading_normal = s.geometric_normal;
  if (!frame.smooth) return s;
  Vec3<D> m = to_double(weigh(normals, w, u, v));
  if (frame.inverse != nullptr) m = map_normal(*frame.inverse, m);
  const D m_length = length_lanes(m);
  const auto known =
      mask_cast<float>((D(0.0) < m_length) & (m_length <= D(std::numeric_limits<double>::max())));
  s.shading_normal = select_lanes(known, float_quotients(m, m_length), s.geometric_normal);
  return s;
}

// ---- The surface at hits of closed-form shapes, in lanes.

/// Lanes for surfaces; one hit at a time without vector registers.
template <class A>
using SurfaceLanes = Simd<double, kDoubleLanes<A>, A>;

/// Stores the points on the surface of hits i, i + 1, ...
template <class D>
OKTETT_INLINE void store_points(const Vec3<D>& points, std::size_t i, ShapeHits& hits) {
  points.x.store(hits.point[0] + i), points.y.store(hits.point[1] + i), points.z.store(hits.point[2] + i);
}

template <class S, class D>
OKTETT_INLINE void closed_surfaces(const typename S::Pool& pool, ShapeHits& hits) {
  using F = Simd<float, D::kWidth, typename D::Isa>;
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, PickedLanes<F>(hits.ray + i));
    const std::uint32_t* element = hits.element + i;
    bool same = true;
    for (int k = 1; k < D::kWidth; ++k) same &= element[k] == element[0];
    const auto fetch = [&](const Column<double>& column) {
      if (same) return D(column[element[0]]);
      double lanes[D::kWidth];
      for (int k = 0; k < D::kWidth; ++k) lanes[k] = column[element[k]];
      return D::load(lanes);
    };
    const PickedLanes<F> entry(hits.entry + i);
    const SurfacePoints<D> at = S::surface(pool, fetch, hit);
    store_surface(hit, at, entry, *hits.out);
    if (!hits.with_uv) continue;
    if constexpr (kHasUvLanes<S>) {
      D u, v;
      S::uv_lanes(at.normal, u, v);
      entry.store(to_float(u), hits.out->uv[0]), entry.store(to_float(v), hits.out->uv[1]);
    } else {
      store_points(at.point, i, hits);
    }
  }
}

/// Hits of one closed-form kind.
template <class A>
void closed_surfaces_code(const Accel& accel, Kind kind, ShapeHits& hits) {
  visit_pool(kind, accel.pools, [&](auto shape, const auto& pool) {
    closed_surfaces<decltype(shape), SurfaceLanes<A>>(pool, hits);
  });
}

}  // namespace oktett
