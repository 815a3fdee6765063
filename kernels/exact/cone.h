#pragma once
/// \file Cones and frusta. In the own space x^2 + y^2 = w^2, -1 <= z <= 1, where w = middle + slope z is the
/// radius at z.

#include "kernels/exact/cone_data.h"
#include "kernels/exact/quadratic.h"
#include "kernels/exact/round_profile.h"

namespace oktett {

/// The greater radius is 1.
struct ConeElement {
  double middle, slope;
  bool open;
};

/// Parts: 0 the side, 1 the end at `from`, 2 the end at `to`.
struct Cone {
  using Data = ConeShape;
  using Pool = ExactPool<ConeElement>;
  static constexpr int kMaxCrossings = 2;
  static constexpr bool kOneCell = true;
  static constexpr bool kWholeLines = true;

  static void add(Pool& pool, const ConeShape& shape, const ExactPlace& place);
  static Box world_bounds(const Pool& pool, std::size_t i);

  /// Along the ray x, y and w are linear, so the equation is a s^2 + 2 b s + c = 0. Its discriminant b^2 - a
  /// c is a sum of squares of cross products (Lagrange's identity for the form x^2 + y^2 - w^2), each of
  /// which is computed without cancellation. s is 0 at the point nearest to the own origin.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const ConeElement& e = pool.elements[cell.element];
    CrossingList<K, D> list(out);
    const Vec3<D>& d = line.d;
    const D shift = -(dot_lanes(line.o, d) / dot_lanes(d, d));
    const Vec3<D> p{line.o.x + shift * d.x, line.o.y + shift * d.y, line.o.z + shift * d.z};
    const D pw = D(e.middle) + D(e.slope) * p.z, dw = D(e.slope) * d.z;
    const D xw = product_difference(p.x, dw, pw, d.x), yw = product_difference(p.y, dw, pw, d.y);
    const D xy = product_difference(p.x, d.y, p.y, d.x);
    const D gain = xw * xw + yw * yw, loss = xy * xy;
    D discriminant[1] = {gain - loss};
    const auto doubtful =
        active & (gain > D(0.0)) & (abs(discriminant[0]) <= D(kDoubtfulDiscriminant) * gain);
    if (OKTETT_UNLIKELY(any(doubtful))) {
      const D in[6] = {p.x, p.y, pw, d.x, d.y, dw};
      lane_by_lane(doubtful, in, discriminant,
                   [](const double(&x)[6], double(&y)[1]) { cone_discriminant(x, y); });
    }
    // Without a root in the slab the ray is inside all the way or not at all: at z = 0 it can be told.
    const UnitSlab<D> slab(p.z, d.z);
    const D s = select(d.z == D(0.0), D(0.0), -(p.z / d.z));
    const D x = p.x + s * d.x, y = p.y + s * d.y;
    const auto within = (x * x + y * y < D(e.middle * e.middle)) & ~(d.z == D(0.0));
    const auto real = discriminant[0] > D(0.0);
    const auto candidates = active & slab.meets & (real | within);
    if (none(candidates)) return list.finish(D(roots::kNoRoot));
    const D a = (d.x * d.x + d.y * d.y) - dw * dw, b = (p.x * d.x + p.y * d.y) - pw * dw;
    const D c = (p.x * p.x + p.y * p.y) - pw * pw;
    const D root = sqrt(max(discriminant[0], D(0.0)));
    // The slope is -root at one solution, where the ray enters, and root at the other, whatever the signs of
    // a and b; a solution that is infinite is not in the slab.
    const auto falling = b < D(0.0);
    const D q = select(falling, root, -root) - b, far = q / a, near = c / q;
    const D enter = select(falling, near, far), exit = select(falling, far, near);
    auto enters = real & (slab.in < enter) & (enter < slab.out);
    auto exits = real & (slab.in < exit) & (exit < slab.out);
    // Both in the wrong order are those of the cone and its mirror image in a tip that has a rounding error.
    const auto wrong = enters & exits & ~(enter < exit);
    enters = enters & ~wrong, exits = exits & ~wrong;
    if (e.open) {
      const D t0 = shift + enter, t1 = shift + exit;
      list.push(candidates & enters & (t0 >= range.a), t0, D(-1.0), D(0.0));
      list.push(candidates & exits & (t1 >= range.a), t1, D(1.0), D(0.0));
      return list.finish(D(roots::kNoRoot));
    }
    const D t0 = shift + select(enters, enter, slab.in), t1 = shift + select(exits, exit, slab.out);
    list_interval(candidates & (enters | exits | within), t0, select(enters, D(0.0), slab.in_part), t1,
                  select(exits, D(0.0), slab.out_part), range, list);
  }

  template <class F>
  OKTETT_INLINE static SegmentVerdict<F> classify(const Pool& pool, const ExactCell& cell,
                                                  const Segment<F>& s, F& at) {
    const ConeElement& e = pool.elements[cell.element];
    const F middle(static_cast<float>(e.middle)), slope(static_cast<float>(e.slope));
    const F wa = fast_fma(slope, s.a.z, middle), wb = fast_fma(slope, s.b.z, middle);
    const auto form = [&](const Vec3<F>& p, const Vec3<F>& q, const F& w, const F& v) {
      return fast_fma(p.x, q.x, fast_fms(p.y, q.y, w * v));
    };
    const F margin(6 * s.error + 0x1p-17f);
    SegmentVerdict<F> verdict = classify_quadratic(form(s.a, s.a, wa, wa), form(s.a, s.b, wa, wb),
                                                   form(s.b, s.b, wb, wb), margin, at);
    if (e.open) verdict.inside = verdict.inside & ~verdict.inside;
    return verdict;
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const ConeElement& e = pool.elements[i];
    const auto side = part == D(0.0), low = part == D(1.0);
    const D w = D(e.middle) + D(e.slope) * p.z;
    value = select(side, (p.x * p.x + p.y * p.y) - w * w, select(low, D(-1.0) - p.z, p.z - D(1.0)));
    gradient = {select(side, p.x * D(2.0), D(0.0)), select(side, p.y * D(2.0), D(0.0)),
                select(side, D(-e.slope) * w * D(2.0), select(low, D(-1.0), D(1.0)))};
  }
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// As for a cylinder.
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);
};

}  // namespace oktett
