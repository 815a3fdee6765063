#include "kernels/exact/polyhedron.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/exact/exact_pool.h"

namespace oktett {

void Polyhedron::add(Pool& pool, const PolyhedronShape& s, const ExactPlace& place) {
  for (const HalfSpace& h : s.planes)
    if (!(length(h.normal) > 0 && std::isfinite(length(h.normal)) && std::isfinite(h.offset))) return;
  if (s.planes.size() > kMaxHalfSpaces) return;
  const ConvexSolid solid = intersect(s.planes);
  if (solid.kind != ConvexSolid::Kind::solid) return;
  Vec3d lo = solid.vertices.front(), hi = lo;
  for (const Vec3d& p : solid.vertices) lo = min(lo, p), hi = max(hi, p);
  // The corners are rounded; what they suggest to be 1 must not become 2.
  const double size = unit_for(0.5 * (1 - 0x1p-20) * max_component(hi - lo));
  Vec3d center;
  for (int k = 0; k < 3; ++k) center[k] = origin_for((lo[k] + hi[k]) / 2, size);
  PolyhedronElement e{static_cast<std::uint32_t>(pool.slabs.size()), 0, {}};
  std::vector<bool> done(s.planes.size());
  for (const std::uint32_t i : solid.faces) {
    if (done[i]) continue;
    const auto own = [&](const HalfSpace& h) {
      return (h.offset - dot(h.normal, center)) / (length(h.normal) * size);
    };
    PolyhedronSlab slab{normalize(s.planes[i].normal), -roots::kNoRoot, own(s.planes[i])};
    for (const std::uint32_t j : solid.faces) {
      if (j <= i || done[j]) continue;
      const Vec3d n = normalize(s.planes[j].normal);
      if (n == slab.n) slab.hi = std::min(slab.hi, own(s.planes[j])), done[j] = true;
      if (n == -slab.n) slab.lo = std::max(slab.lo, -own(s.planes[j])), done[j] = true;
    }
    pool.slabs.push_back(slab), ++e.count;
  }
  const Affine own_to_world =
      place.to_world * Affine::translation(center) * Affine::scaling({size, size, size});
  // Corners are known to 2^-40 of the size; taking a ray into the own space costs a few roundings more.
  const double span = 0x1p-38 * stretch(own_to_world);
  for (const Vec3d& p : solid.vertices) {
    const Vec3d q = place.to_world.point(p);
    const double pad = span + 0x1p-45 * length(q);
    e.bounds.grow(Box{round_down(q - Vec3d{pad, pad, pad}), round_up(q + Vec3d{pad, pad, pad})});
  }
  add_element(pool, e, own_to_world, place);
  add_cell(pool, {-1, -1, -1}, {1, 1, 1});
}

bool Polyhedron::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const PolyhedronElement& e = pool.elements[i];
  for (std::uint32_t k = e.begin; k < e.begin + e.count; ++k) {
    const double at = dot(pool.slabs[k].n, p);
    if (!(pool.slabs[k].lo < at && at < pool.slabs[k].hi)) return false;
  }
  return true;
}

SurfaceUv Polyhedron::uv(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  Vec3d u, v;
  make_basis(slope_at<Polyhedron>(pool, i, part, p).gradient, u, v);
  return {{0.5 + 0.5 * dot(u, p), u * 0.5}, {0.5 + 0.5 * dot(v, p), v * 0.5}};
}

// ---- What half-spaces have in common.

namespace {

using Corners = std::vector<Vec3d>;

/// What of a convex polygon is in n.p <= offset (Sutherland and Hodgman 1974).
void clip(Corners& polygon, const Vec3d& n, double offset, Corners& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double f = dot(n, p) - offset, g = dot(n, q) - offset;
    if (f <= 0) scratch.push_back(p);
    if ((f < 0 && g > 0) || (f > 0 && g < 0)) scratch.push_back(p + (q - p) * (f / (f - g)));
  }
  std::swap(polygon, scratch);
}

/// Whether there is a direction in which no half-space ends: one that meets a face of the unit cube.
bool has_free_direction(std::span<const HalfSpace> planes) {
  Corners polygon, scratch;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    polygon.assign(4, {});
    for (int i = 0; i < 4; ++i) {
      polygon[i][axis] = face % 2 == 0 ? -1 : 1;
      polygon[i][u] = i == 1 || i == 2 ? 1 : -1;
      polygon[i][v] = i >= 2 ? 1 : -1;
    }
    for (const HalfSpace& h : planes) {
      clip(polygon, h.normal, 1e-9, scratch);
      if (polygon.empty()) break;
    }
    if (!polygon.empty()) return true;
  }
  return false;
}

/// Corners and faces, looked for within about `reach` of `center`; planes have unit normals.
void enumerate(std::span<const HalfSpace> planes, const Vec3d& center, double reach, ConvexSolid& solid) {
  solid.vertices.clear(), solid.faces.clear();
  Corners polygon, scratch;
  const double tolerance = 1e-13 * reach;
  for (std::uint32_t i = 0; i < planes.size(); ++i) {
    const Vec3d n = planes[i].normal;
    const Vec3d foot = n * (planes[i].offset - dot(n, center));
    Vec3d u, v;
    make_basis(n, u, v);
    u *= reach, v *= reach;
    polygon = {foot - u - v, foot + u - v, foot + u + v, foot - u + v};
    for (std::uint32_t j = 0; j < planes.size() && !polygon.empty(); ++j)
      if (j != i)
        clip(polygon, planes[j].normal, planes[j].offset - dot(planes[j].normal, center) + tolerance,
             scratch);
    if (polygon.empty()) continue;
    solid.faces.push_back(i);
    for (const Vec3d& p : polygon) solid.vertices.push_back(center + p);
  }
}

}  // namespace

ConvexSolid intersect(std::span<const HalfSpace> half_spaces) {
  std::vector<HalfSpace> planes(half_spaces.begin(), half_spaces.end());
  double farthest = 0;
  for (HalfSpace& h : planes) {
    const double l = length(h.normal);
    h.normal = h.normal / l, h.offset = h.offset / l;
    farthest = std::max(farthest, std::abs(h.offset));
  }
  ConvexSolid solid;
  solid.kind = ConvexSolid::Kind::unbounded;
  if (has_free_direction(planes)) return solid;
  solid.kind = ConvexSolid::Kind::empty;
  // Each pass finds where to look more closely.
  Vec3d center{0, 0, 0};
  double reach = 1e10 * farthest;
  for (int pass = 0; pass < 4 && reach > 0; ++pass) {
    enumerate(planes, center, reach, solid);
    if (solid.vertices.empty()) return solid;
    Vec3d lo = solid.vertices.front(), hi = lo;
    for (const Vec3d& p : solid.vertices) lo = min(lo, p), hi = max(hi, p);
    center = (lo + hi) * 0.5, reach = length(hi - lo);
  }
  Vec3d middle{0, 0, 0};
  for (const Vec3d& p : solid.vertices) middle += p / static_cast<double>(solid.vertices.size());
  for (const HalfSpace& h : planes)
    if (!(dot(h.normal, middle) < h.offset - 1e-12 * reach)) return solid;
  solid.kind = ConvexSolid::Kind::solid;
  return solid;
}

}  // namespace oktett
