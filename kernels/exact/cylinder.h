#pragma once
/// \file Cylinders with ends. In the own space x^2 + y^2 = 1, -1 <= z <= 1 (Zachmann 2010: x^2 + y^2 = 1).

#include "kernels/exact/cylinder_data.h"
#include "kernels/exact/quadratic.h"
#include "kernels/exact/round_profile.h"

namespace oktett {

struct CylinderElement {
  bool open;
};

/// Parts: 0 the side, 1 the end at `from`, 2 the end at `to`.
struct Cylinder {
  using Data = CylinderShape;
  using Pool = ExactPool<CylinderElement>;
  static constexpr int kMaxCrossings = 2;
  static constexpr bool kOneCell = true;
  static constexpr bool kWholeLines = true;

  static void add(Pool& pool, const CylinderShape& shape, const ExactPlace& place);
  static Box world_bounds(const Pool& pool, std::size_t i);

  /// In the plane z = 0, with d of the ray and c = o x d, the ray passes the axis at the distance |c| / |d|
  /// and is inside for sqrt(d.d - c^2) / d.d to both sides of -o.d / d.d.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const D &ox = line.o.x, &oy = line.o.y, &dx = line.d.x, &dy = line.d.y;
    CrossingList<K, D> list(out);
    const D dd = dx * dx + dy * dy, c = product_difference(ox, dy, oy, dx);
    D discriminant[1] = {dd - c * c};
    const auto along = dd == D(0.0);
    const auto doubtful = active & ~along & (abs(discriminant[0]) <= D(kDoubtfulDiscriminant) * dd);
    if (OKTETT_UNLIKELY(any(doubtful))) {
      const D in[4] = {ox, oy, dx, dy};
      lane_by_lane(doubtful, in, discriminant,
                   [](const double(&x)[4], double(&y)[1]) { circle_discriminant(x, y); });
    }
    // A line along the axis stays inside or outside.
    auto meets = active & ((~along & (discriminant[0] > D(0.0))) | (along & (ox * ox + oy * oy < D(1.0))));
    if (none(meets)) return list.finish(D(roots::kNoRoot));
    const D inf(roots::kNoRoot), inverse = D(1.0) / dd;
    const D middle = -(ox * dx + oy * dy) * inverse, half = sqrt(max(discriminant[0], D(0.0))) * inverse;
    const D t0 = select(along, -inf, middle - half), t1 = select(along, inf, middle + half);
    const UnitSlab<D> slab(line.o.z, line.d.z);
    meets = meets & slab.meets;
    if (pool.elements[cell.element].open) {
      const auto first = meets & (slab.in < t0) & (t0 < slab.out) & (t0 >= range.a);
      const auto second = meets & (slab.in < t1) & (t1 < slab.out) & (t1 >= range.a);
      list.push(first, t0, D(-1.0), D(0.0));
      list.push(second, t1, D(1.0), D(0.0));
      return list.finish(D(roots::kNoRoot));
    }
    const D in = max(t0, slab.in), part_in = select(t0 > slab.in, D(0.0), slab.in_part);
    const D exit = min(t1, slab.out), part_out = select(t1 < slab.out, D(0.0), slab.out_part);
    list_interval(meets & (in < exit), in, part_in, exit, part_out, range, list);
  }

  template <class F>
  OKTETT_INLINE static SegmentVerdict<F> classify(const Pool& pool, const ExactCell& cell,
                                                  const Segment<F>& s, F& at) {
    const F one(1.0f), margin(5 * s.error + 0x1p-18f);
    const auto form = [&](const Vec3<F>& p, const Vec3<F>& q) { return fast_fma(p.x, q.x, p.y * q.y) - one; };
    SegmentVerdict<F> verdict =
        classify_quadratic(form(s.a, s.a), form(s.a, s.b), form(s.b, s.b), margin, at);
    if (pool.elements[cell.element].open) verdict.inside = verdict.inside & ~verdict.inside;
    return verdict;
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool&, std::size_t, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const auto side = part == D(0.0), low = part == D(1.0);
    value = select(side, (p.x * p.x + p.y * p.y) - D(1.0), select(low, D(-1.0) - p.z, p.z - D(1.0)));
    gradient = {select(side, D(2.0) * p.x, D(0.0)), select(side, D(2.0) * p.y, D(0.0)),
                select(side, D(0.0), select(low, D(-1.0), D(1.0)))};
  }
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u around the axis; v on the side from `from` to `to`, on an end the distance from its centre. All in
  /// [0, 1].
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);
};

/// A map from z in [-1, 1] to the axis from `from` to `to`, with `radius` the unit of x and y; exact for axes
/// along those of the world, so that rays along the axis stay so.
Affine along_axis(const Vec3d& from, const Vec3d& to, double radius);
/// Bounds in the world of a frustum in `frame` with radii r0 at z = -1 and r1 at z = 1, rounded outwards.
Box frustum_bounds(const ExactFrame& frame, double r0, double r1);
/// uv of an end of a frustum, `radius` wide, or of its side.
SurfaceUv frustum_uv(int part, double radius, const Vec3d& p);

}  // namespace oktett
