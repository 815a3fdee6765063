#pragma once
/// \file Convex polyhedra by the slab method over any number of half-spaces (after T. L. Kay, J. T. Kajiya:
/// Ray Tracing Complex Scenes, SIGGRAPH 1986).

#include <cstdint>
#include <span>
#include <vector>

#include "core/box.h"
#include "kernels/exact/polyhedron_data.h"
#include "kernels/exact/quadratic.h"

namespace oktett {

/// lo <= n.p <= hi; lo is -infinity unless two planes are parallel.
struct PolyhedronSlab {
  Vec3d n;
  double lo, hi;
};

struct PolyhedronElement {
  std::uint32_t begin, count;  ///< of the pool's slabs
  Box bounds;                  ///< of the vertices in the world
};

struct PolyhedronPool : ExactPool<PolyhedronElement> {
  std::vector<PolyhedronSlab> slabs;
  std::size_t bytes() const { return ExactPool::bytes() + slabs.size() * sizeof(PolyhedronSlab); }
};

/// Part 2 k + 1 is the side n.p = hi of the element's slab k, part 2 k the other one.
struct Polyhedron {
  using Data = PolyhedronShape;
  using Pool = PolyhedronPool;
  static constexpr int kMaxCrossings = 2;
  static constexpr bool kOneCell = true;
  static constexpr bool kWholeLines = true;

  static void add(Pool& pool, const PolyhedronShape& shape, const ExactPlace& place);
  static Box world_bounds(const Pool& pool, std::size_t i) { return pool.elements[i].bounds; }

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const PolyhedronElement& e = pool.elements[cell.element];
    const PolyhedronSlab* const slab = pool.slabs.data() + e.begin;
    const D inf(roots::kNoRoot);
    CrossingList<K, D> list(out);
    D near = -inf, far = inf, near_part(0.0), far_part(0.0);
    auto meets = active;
    for (std::uint32_t k = 0; k < e.count; ++k) {
      const Vec3<D> n = broadcast<D>(slab[k].n);
      const D lo(slab[k].lo), hi(slab[k].hi), at = dot_lanes(n, line.o), speed = dot_lanes(n, line.d);
      const D inverse = D(1.0) / speed, low = (lo - at) * inverse, high = (hi - at) * inverse;
      // A line along the slab is in it or not: no threshold. One with NaN is in none.
      const auto along = speed == D(0.0), back = speed < D(0.0);
      const D in = select(along, -inf, select(back, high, low));
      const D exit = select(along, inf, select(back, low, high));
      meets = meets & (in < exit) & (~along | ((lo < at) & (at < hi)));
      const D low_part(2.0 * k), high_part(2.0 * k + 1.0);
      near_part = select(in > near, select(back, high_part, low_part), near_part);
      far_part = select(exit < far, select(back, low_part, high_part), far_part);
      near = max(in, near), far = min(exit, far);
      meets = meets & (near < far);
      if (none(meets)) break;
    }
    list_interval(meets, near, near_part, far, far_part, range, list);
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    constexpr int W = D::kWidth;
    double parts[W], nx[W], ny[W], nz[W], offset[W];
    part.store(parts);
    for (int k = 0; k < W; ++k) {
      const auto number = static_cast<std::uint32_t>(parts[k]);
      const PolyhedronSlab& slab = pool.slabs[pool.elements[i].begin + number / 2];
      const double side = number % 2 == 1 ? 1 : -1;
      nx[k] = side * slab.n.x, ny[k] = side * slab.n.y, nz[k] = side * slab.n.z;
      offset[k] = side * (number % 2 == 1 ? slab.hi : slab.lo);
    }
    gradient = {D::load(nx), D::load(ny), D::load(nz)};
    value = dot_lanes(gradient, p) - D::load(offset);
  }
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// Position in the plane of the face, in [0, 1] over the size of the solid.
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
};

// ---- What half-spaces have in common.

struct ConvexSolid {
  enum class Kind {
    solid,
    empty,      ///< nothing inside, or less than 1e-11 of its length thick
    unbounded,  ///< or a billion times longer than wide; also where what is unbounded may be empty
  };
  Kind kind = Kind::empty;
  /// Corners, each at least once, off by no more than 2^-40 of the size.
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> faces;  ///< the half-spaces that bound it, ascending
};

/// Clips a large square in each plane by all others. Normals must not be zero.
ConvexSolid intersect(std::span<const HalfSpace> half_spaces);

}  // namespace oktett
