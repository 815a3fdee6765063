#include "kernels/exact/polyhedron.h"

#include <cmath>

#include "kernels/exact/half_spaces.h"
#include "kernels/exact/stretch.h"

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

}  // namespace oktett
