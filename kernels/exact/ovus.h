#pragma once
/// \file Ovi: eggs of two balls and a part of a spindle torus that touches both.
///
/// In the own space the z axis is the egg's, the centre of the torus is the origin, and the radius of its
/// tube is 1: seen in a half-plane through the axis, the arc has the radius 1 about (-m, 0). Where it touches
/// a ball, its own normal is the ball's, so the planes in which the pieces meet are z = n_z of that normal.
/// Between these planes the egg is where |p|^2 + m^2 - 1 + 2 m rho < 0 with rho the distance from the axis,
/// below and above them it is the balls.

#include "kernels/exact/exact.h"
#include "kernels/exact/ovus_data.h"
#include "kernels/exact/quadratic.h"
#include "kernels/exact/round_profile.h"

namespace oktett {

struct OvusElement {
  /// A ball about (0, 0, center), which is the surface beyond the plane z = end.
  struct Cap {
    double center, radius, end;
    double rim2;  ///< the square of the egg's radius in that plane
  };
  Cap bottom, top;
  double m;
};

struct Ovus {
  using Data = OvusShape;
  using Pool = ExactPool<OvusElement>;
  static constexpr int kMaxCrossings = 2;
  static constexpr bool kOneCell = true;
  static constexpr bool kWholeLines = true;

  static void add(Pool& pool, const OvusShape& shape, const ExactPlace& place);
  static Box world_bounds(const Pool& pool, std::size_t i);

  /// A line meets a convex solid in one interval. Whether it is inside where it passes the two planes is
  /// decided once, and tells in which pieces the interval begins and ends; if it is outside at both, the
  /// interval is in one piece or there is none. The pieces are tangent to each other, so which of two is
  /// taken near a plane does not matter.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const OvusElement& e = pool.elements[cell.element];
    CrossingList<K, D> list(out);
    const CenteredLine<D> l(line);
    const D pp = dot_lanes(l.p, l.p);
    const auto near = active & (pp <= D(1 + 0x1p-40));
    if (none(near)) return list.finish(D(roots::kNoRoot));
    const auto up = l.u.z > D(0.0);
    const Ball<D> first(l, e.bottom, e.top, up), last(l, e.top, e.bottom, up);
    // The interval is in the piece before the first plane, in the torus, or behind the last plane.
    const auto outside = near & ~first.inside & ~last.inside;
    const auto before = outside & (first.square > D(0.0)) & (first.middle < first.plane);
    const auto behind = outside & ~before & (last.square > D(0.0)) & (last.middle > last.plane);
    const auto between = outside & ~before & ~behind;
    const D k = pp + D(e.m * e.m - 1.0), reach = sqrt(max(D(1 + 0x1p-40) - pp, D(0.0)));
    const D low = max(first.plane, -reach), high = min(last.plane, reach);
    typename D::M meets;
    const auto begins_between = near & ~first.inside & ~before & ~behind;
    D enter = enter_torus(e, l.p, l.u, k, low, high, begins_between, meets);
    meets = (near & ~between) | (between & meets);
    enter = select(first.inside | before, first.middle - first.half, enter);
    enter = select(behind, last.middle - last.half, enter);
    const D t0 = l.to_t(enter);
    if constexpr (K == 1) {
      if (none(meets & ~(t0 >= range.a)))
        return list.push(meets, t0, D(-1.0), D(0.0)), list.finish(D(roots::kNoRoot));
    }
    const auto ends_between = meets & ~last.inside & ~before & ~behind;
    const Vec3<D> back{-l.u.x, -l.u.y, -l.u.z};
    typename D::M found;
    D exit = -enter_torus(e, l.p, back, k, -high, -low, ends_between, found);
    exit = select(last.inside | behind, last.middle + last.half, exit);
    exit = select(before, first.middle + first.half, exit);
    list_interval(meets, t0, D(0.0), l.to_t(max(enter, exit)), D(0.0), range, list);
  }

  /// As the distance from the axis is at least x cos a + y sin a for all a, the torus lies in balls of radius
  /// 1 about (-m cos a, -m sin a, 0). A line that misses the one on the other side of the axis misses it.
  template <class F>
  OKTETT_INLINE static SegmentVerdict<F> classify(const Pool& pool, const ExactCell& cell,
                                                  const Segment<F>& s, F& at) {
    const OvusElement& e = pool.elements[cell.element];
    const F m(static_cast<float>(e.m)), k(static_cast<float>(e.m * e.m - 1)), margin(8 * s.error + 0x1p-17f);
    const F dx = s.b.x - s.a.x, dy = s.b.y - s.a.y;
    const F nearest = -fast_fma(s.a.x, dx, s.a.y * dy) / max(fast_fma(dx, dx, dy * dy), F(0x1p-60f));
    const F x = fast_fma(nearest, dx, s.a.x), y = fast_fma(nearest, dy, s.a.y);
    const F scale = m * F(1 - 0x1p-18f) / max(sqrt(fast_fma(x, x, y * y)), F(0x1p-60f));
    const F mx = scale * x, my = scale * y;
    const auto form = [&](const Vec3<F>& p, const Vec3<F>& q) {
      return fast_fma(mx, p.x + q.x, fast_fma(my, p.y + q.y, fast_dot(p, q) + k));
    };
    SegmentVerdict<F> verdict =
        classify_quadratic(form(s.a, s.a), form(s.a, s.b), form(s.b, s.b), margin, at);
    const F rest = F(1.0f) - at;
    const Vec3<F> p{fast_fma(at, s.b.x, rest * s.a.x), fast_fma(at, s.b.y, rest * s.a.y),
                    fast_fma(at, s.b.z, rest * s.a.z)};
    const F rr = fast_fma(p.x, p.x, p.y * p.y), out = -margin;
    const auto in_ball = [&](const OvusElement::Cap& c) {
      const F z = p.z - F(static_cast<float>(c.center));
      return fast_fma(z, z, rr) - F(static_cast<float>(c.radius * c.radius)) < out;
    };
    const F bottom(static_cast<float>(e.bottom.end)), top(static_cast<float>(e.top.end));
    const auto in_torus = (bottom + margin < p.z) & (p.z < top - margin) &
                          (fast_fma(p.z, p.z, rr) + k + (m + m) * sqrt(rr) < out);
    verdict.inside = in_ball(e.bottom) | in_ball(e.top) | in_torus;
    verdict.falls = verdict.falls & ~verdict.falls;
    return verdict;
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D&, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const OvusElement& e = pool.elements[i];
    const auto low = p.z<D(e.bottom.end), high = p.z> D(e.top.end), cap = low | high;
    const D z = p.z - select(low, D(e.bottom.center), select(high, D(e.top.center), D(0.0)));
    const D rr = p.x * p.x + p.y * p.y, rho = sqrt(rr), m = select(cap, D(0.0), D(e.m));
    const D radius = select(low, D(e.bottom.radius), select(high, D(e.top.radius), D(1.0)));
    value = (rr + z * z) + ((m * m - radius * radius) + D(2.0) * m * rho);
    const D k = D(1.0) + select(rho > D(0.0), m / rho, D(0.0));
    gradient = {D(2.0) * k * p.x, D(2.0) * k * p.y, D(2.0) * z};
  }
  /// u around the axis, v along the profile from the bottom, both in [0, 1].
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);

 private:
  /// A line and the ball of one end of the egg: `cap` if the line goes up, else `other`.
  template <class D>
  struct Ball {
    D middle, square, half;  ///< of the chord; half is 0 where square, its square, is not above 0
    D plane;                 ///< where the line passes the plane of the ball's end
    typename D::M inside;    ///< whether it is inside of the egg there

    OKTETT_INLINE Ball(const CenteredLine<D>& l, const OvusElement::Cap& cap, const OvusElement::Cap& other,
                       const typename D::M& up) {
      const auto of = [&](double a, double b) { return select(up, D(a), D(b)); };
      const D radius = of(cap.radius, other.radius), end = of(cap.end, other.end),
              z = l.p.z - of(cap.center, other.center);
      middle = -((l.p.x * l.u.x + l.p.y * l.u.y) + z * l.u.z);
      const Vec3<D> miss{l.p.x + middle * l.u.x, l.p.y + middle * l.u.y, z + middle * l.u.z};
      square = radius * radius - dot_lanes(miss, miss);
      half = sqrt(max(square, D(0.0)));
      // A line along the planes counts as one that goes down without end.
      const D inf(roots::kNoRoot), rise = end - l.p.z;
      const auto along = l.u.z == D(0.0);
      plane = select(along, select(rise < D(0.0), inf, -inf), rise / l.u.z);
      const D x = l.p.x + plane * l.u.x, y = l.p.y + plane * l.u.y;
      inside = ~along & (x * x + y * y < of(cap.rim2, other.rim2));
    }
  };

  /// Where the line p + s u first enters the torus between `low`, where it is outside, and `high`; at most
  /// `high`. `found` are the lanes of `wanted` in which it does.
  ///
  /// f = s^2 + k + 2 m rho is convex, and so is rho: with its tangent in place of rho, f becomes a quadratic
  /// that is nowhere greater. The first zero of that is not behind the first zero of f, and where it has none
  /// ahead, f has none. So steps from one to the next pass no zero, and where they end proves what is said.
  template <class D>
  OKTETT_INLINE static D enter_torus(const OvusElement& e, const Vec3<D>& p, const Vec3<D>& u, const D& k,
                                     const D& low, const D& high, const typename D::M& wanted,
                                     typename D::M& found) {
    // Steps become shorter by half, at least.
    constexpr int kMostSteps = 64;
    const D m(e.m), zero(0.0), steepest = -sqrt(u.x * u.x + u.y * u.y);
    D s = low;
    found = wanted & (low <= high);
    auto active = found;
    for (int i = 0; i < kMostSteps && any(active); ++i) {
      const D x = p.x + s * u.x, y = p.y + s * u.y, rho = sqrt(x * x + y * y);
      const D f = (s * s + k) + D(2.0) * m * rho;
      const D slope = s + m * select(rho > zero, (x * u.x + y * u.y) / rho, steepest);
      const D square = slope * slope - f;
      active = active & (f > zero);
      const auto ahead = (slope < zero) & (square >= zero);
      found = found & (~active | ahead);
      const D next = s + f / (sqrt(max(square, zero)) - slope);
      active = active & ahead & (next > s) & (s <= high);
      s = select(active, next, s);
    }
    found = found & (s <= high);
    return min(s, high);
  }
};

}  // namespace oktett
