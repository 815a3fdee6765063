#pragma once
/// \file Tori (Zachmann 2010: (c - sqrt(x^2 + y^2))^2 + z^2 = a^2).

#include "kernels/exact/centered_quartic.h"
#include "kernels/exact/round_profile.h"
#include "kernels/exact/segment.h"
#include "kernels/exact/torus_data.h"

namespace oktett {

struct TorusElement {
  double major, minor;
};

struct Torus {
  using Data = TorusShape;
  using Pool = ExactPool<TorusElement>;
  static constexpr int kMaxCrossings = 4;
  static constexpr bool kOneCell = true;

  static void add(Pool& pool, const TorusShape& shape, const ExactPlace& place);

  /// With p the point of the line nearest to the centre, p.u = 0 and the quartic has no cubic term:
  /// s^4 + 2 (k + 2 R^2 u_z^2) s^2 + 8 R^2 p_z u_z s + k^2 + 4 R^2 (p_z^2 - r^2), k = p.p - R^2 - r^2.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const TorusElement& e = pool.elements[cell.element];
    const CenteredLine<D> l(line);
    const D rr(e.major * e.major), outer(e.major + e.minor);
    const D pp = dot_lanes(l.p, l.p), k = pp - D(e.major * e.major + e.minor * e.minor);
    const D c2 = D(2.0) * (k + D(2.0) * rr * l.u.z * l.u.z), c1 = D(8.0) * rr * l.p.z * l.u.z;
    const D c0 = k * k + D(4.0) * rr * (l.p.z * l.p.z - D(e.minor * e.minor));
    const D c[5] = {c0, c1, c2, D(0.0), D(1.0)};
    // Everything lies in the sphere around the torus.
    const BallRange<D> ball(l, outer * outer * D(1 + 0x1p-40), range, active);
    const auto there = ball.there;
    out.clear();
    if (none(there)) return;
    if (e.minor <= e.major)
      return list_quartic_roots(roots::certified_roots<4, K, roots::Touching::drop>(c, ball.a, ball.b, there),
                                l, c, there, out);
    // The quartic is zero, too, on the lemon inside that the square root of the equation leaves out.
    auto all = roots::certified_roots<4, 4, roots::Touching::drop>(c, ball.a, ball.b, there);
    for (int i = 0; i < 4; ++i) {
      const D s = select(all.x[i] < D(roots::kNoRoot), all.x[i], D(0.0));
      const auto lemon = (pp + s * s) + rr < D(e.minor * e.minor);
      all.x[i] = select(lemon, D(roots::kNoRoot), all.x[i]);
    }
    list_quartic_roots(all, l, c, there, out);
  }

  /// (p.p + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2), which has the sign of the equation where r <= R. Both squares
  /// are quadratic along a segment, with the dot products of its ends as Bernstein coefficients.
  template <class F>
  OKTETT_INLINE static SegmentVerdict<F> classify(const Pool& pool, const ExactCell& cell,
                                                  const Segment<F>& s, F& at) {
    const TorusElement& e = pool.elements[cell.element];
    const F shift(static_cast<float>(e.major * e.major - e.minor * e.minor));
    const F rr(static_cast<float>(4 * e.major * e.major));
    const auto flat = [](const Vec3<F>& p, const Vec3<F>& q) { return fast_fma(p.x, q.x, p.y * q.y); };
    const F r0 = flat(s.a, s.a), r1 = flat(s.a, s.b), r2 = flat(s.b, s.b);
    const F n0 = fast_fma(s.a.z, s.a.z, r0) + shift, n1 = fast_fma(s.a.z, s.b.z, r1) + shift,
            n2 = fast_fma(s.b.z, s.b.z, r2) + shift;
    const F half(0.5f), third(1 / 3.0f), sixth(1 / 6.0f);
    const F c[5] = {fast_fms(n0, n0, rr * r0), fast_fms(n0, n1, rr * (r0 + r1) * half),
                    fast_fma(n1, n1 + n1, n0 * n2) * third - rr * (fast_fma(r1, F(4.0f), r0) + r2) * sixth,
                    fast_fms(n1, n2, rr * (r1 + r2) * half), fast_fms(n2, n2, rr * r2)};
    const F margin(66 * s.error + 0x1p-15f);
    SegmentVerdict<F> verdict = classify_polynomial(c, margin, at);
    if (!(e.minor <= e.major)) verdict.inside = verdict.inside & ~verdict.inside;
    return verdict;
  }

  template <class D>
  OKTETT_INLINE static D value(const Pool& pool, const ExactCell& cell, const Vec3<D>& p) {
    const TorusElement& e = pool.elements[cell.element];
    const D r = p.x * p.x + p.y * p.y, n = (r + p.z * p.z) + D(e.major * e.major - e.minor * e.minor);
    return n * n - D(4 * e.major * e.major) * r;
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D&, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const TorusElement& e = pool.elements[i];
    const D rho = sqrt(p.x * p.x + p.y * p.y), d = rho - D(e.major);
    value = (d * d + p.z * p.z) - D(e.minor * e.minor);
    const D k = select(rho > D(0.0), D(e.major) / rho, D(0.0));
    gradient = {(p.x - k * p.x) * D(2.0), (p.y - k * p.y) * D(2.0), p.z * D(2.0)};
  }
  /// u around the axis from +x towards +y, v around the tube from the outside upwards, both in [0, 1].
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);
};

}  // namespace oktett
