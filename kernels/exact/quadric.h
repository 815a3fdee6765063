#pragma once
/// \file Quadrics (Zachmann 2010: x^2 + y^2 = 1, x^2 + y^2 - z = 0, x^2 + y^2 - z^2 = 1), also cut by a box.

#include <algorithm>
#include <cmath>

#include "kernels/exact/quadratic.h"
#include "kernels/exact/quadric_data.h"

namespace oktett {

/// The function is x.Qx + 2 h.x + j; its greatest coefficient is about 1.
struct QuadricElement {
  double q[6];  ///< of Q: xx, yy, zz, xy, xz, yz
  Vec3d h;
  double j;
  double q_size, h_size;  ///< greatest of |q| and |h|
  Vec3d lo, hi;           ///< the box, which may be infinite
  bool closed;            ///< by the faces of the box
  bool clipped;           ///< what is outside of the box is no part of the solid
};

/// Parts: 0 the surface, 1 to 6 the faces of the box.
struct Quadric {
  using Data = QuadricShape;
  using Pool = ExactPool<QuadricElement>;
  static constexpr int kMaxCrossings = 4;
  static constexpr bool kOneCell = true;

  static void add(Pool& pool, const QuadricShape& shape, const ExactPlace& place);

  /// a s^2 + 2 b s + c = 0 where s = 0 is the point nearest to the own origin.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const QuadricElement& e = pool.elements[cell.element];
    const Vec3<D>& d = line.d;
    const D shift = -(dot_lanes(line.o, d) / dot_lanes(d, d));
    const Vec3<D> p{line.o.x + shift * d.x, line.o.y + shift * d.y, line.o.z + shift * d.z};
    const Vec3<D> h = broadcast<D>(e.h), qd = times(e, d), qp = times(e, p);
    const Vec3<D> qph{qp.x + D(2.0) * h.x, qp.y + D(2.0) * h.y, qp.z + D(2.0) * h.z};
    const D b = dot_lanes(qd, p) + dot_lanes(h, d), a = dot_lanes(qd, d), c = dot_lanes(qph, p) + D(e.j);
    // {a, b, c, b^2 - a c}
    D f[4] = {a, b, c, product_difference(b, b, a, c)};
    // What the terms add up to that a, b and c are sums of; each is off by less than 2^-49 of that.
    const D u = norm1(d), r = norm1(p), q_size(e.q_size), h_size(e.h_size);
    const D a_size = q_size * u * u, b_size = (q_size * r + h_size) * u;
    const D c_size = (q_size * r + D(2.0) * h_size) * r + D(e.j < 0 ? -e.j : e.j);
    const D size = D(2.0) * abs(b) * b_size + abs(a) * c_size + abs(c) * a_size;
    const auto doubtful = active & (size > D(0.0)) & (abs(f[3]) <= D(kDoubtfulDiscriminant) * size);
    if (OKTETT_UNLIKELY(any(doubtful))) {
      const D in[6] = {p.x, p.y, p.z, d.x, d.y, d.z};
      lane_by_lane(doubtful, in, f, [&e](const double(&x)[6], double(&y)[4]) { equation(e, x, y); });
    }
    // See Cone::crossings. Solutions that are infinite do not count.
    const auto real = active & (f[3] > D(0.0));
    const D inf(roots::kNoRoot), root = sqrt(max(f[3], D(0.0)));
    const auto falling = f[1] < D(0.0);
    const D q = select(falling, root, -root) - f[1], far = shift + q / f[0], near = shift + f[2] / q;
    const D enter = select(falling, near, far), exit = select(falling, far, near);
    const auto enters = real & (enter >= range.a) & (enter <= range.b) & (abs(enter) < inf);
    const auto exits = real & (exit >= range.a) & (exit <= range.b) & (abs(exit) < inf);
    const auto enter_first = (enter < exit) | ((enter == exit) & (f[0] > D(0.0)));
    const D t0 = select(enter_first, enter, exit), t1 = select(enter_first, exit, enter);
    const D turn = select(enter_first, D(-1.0), D(1.0));
    const auto at0 = (enter_first & enters) | (~enter_first & exits);
    const auto at1 = (enter_first & exits) | (~enter_first & enters);
    const auto list_both = [&](auto& crossings) {
      CrossingList list(crossings);
      list.push(at0, t0, turn, D(0.0));
      list.push(at1, t1, -turn, D(0.0));
      list.finish(inf);
    };
    if (!e.closed) return list_both(out);
    Crossings<2, D> open;
    list_both(open);
    const D s = D(0.5) * (range.a + range.b) - shift;
    const auto inside = (f[0] * s + D(2.0) * f[1]) * s + f[2] < D(0.0);
    close_by_cell(open, inside, range, active, out);
  }

  template <class F>
  OKTETT_INLINE static SegmentVerdict<F> classify(const Pool& pool, const ExactCell& cell,
                                                  const Segment<F>& s, F& at) {
    const QuadricElement& e = pool.elements[cell.element];
    double sum = 0;
    for (int k = 0; k < 6; ++k) sum += (k < 3 ? 1 : 2) * std::fabs(e.q[k]);
    const double linear = std::fabs(e.h.x) + std::fabs(e.h.y) + std::fabs(e.h.z);
    double reach = 0;
    for (int k = 0; k < 3; ++k) reach = std::max({reach, std::fabs(e.lo[k]), std::fabs(e.hi[k])});
    const double most = reach + 0x1p-3;
    const F margin(static_cast<float>(2.25 * (sum * most + linear) * s.error +
                                      0x1p-19 * ((sum * most + 2 * linear) * most + std::fabs(e.j))));
    const auto number = [](double x) { return F(static_cast<float>(x)); };
    const F hx = number(e.h.x), hy = number(e.h.y), hz = number(e.h.z), xy = number(e.q[3]),
            xz = number(e.q[4]), yz = number(e.q[5]);
    const auto times = [&](const Vec3<F>& p) {
      return Vec3<F>{fast_fma(number(e.q[0]), p.x, fast_fma(xy, p.y, fast_fma(xz, p.z, hx))),
                     fast_fma(number(e.q[1]), p.y, fast_fma(xy, p.x, fast_fma(yz, p.z, hy))),
                     fast_fma(number(e.q[2]), p.z, fast_fma(xz, p.x, fast_fma(yz, p.y, hz)))};
    };
    const Vec3<F> h{hx, hy, hz}, qa = times(s.a), qb = times(s.b);
    const F ha = fast_dot(h, s.a) + number(e.j), hb = fast_dot(h, s.b);
    SegmentVerdict<F> verdict = classify_quadratic(fast_dot(qa, s.a) + ha, fast_dot(qa, s.b) + ha,
                                                   fast_dot(qb, s.b) + (hb + number(e.j)), margin, at);
    if (!e.closed) verdict.inside = verdict.inside & ~verdict.inside;
    return verdict;
  }

  template <class D>
  OKTETT_INLINE static D value(const Pool& pool, const ExactCell& cell, const Vec3<D>& p) {
    D value;
    Vec3<D> gradient;
    slope(pool, cell.element, D(0.0), p, value, gradient);
    return value;
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const QuadricElement& e = pool.elements[i];
    const Vec3<D> g = times(e, p), h = broadcast<D>(e.h);
    value = dot_lanes(Vec3<D>{g.x + h.x * D(2.0), g.y + h.y * D(2.0), g.z + h.z * D(2.0)}, p) + D(e.j);
    gradient = {(g.x + h.x) * D(2.0), (g.y + h.y) * D(2.0), (g.z + h.z) * D(2.0)};
    select_faces(e.lo, e.hi, part, p, value, gradient);
  }
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// On the surface, u around z and v the height in the box, both in [0, 1]; v = z where the box is infinite.
  /// On a face of the box, the position on it.
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);

 private:
  template <class D>
  OKTETT_INLINE static Vec3<D> times(const QuadricElement& e, const Vec3<D>& v) {
    const D xy(e.q[3]), xz(e.q[4]), yz(e.q[5]);
    return {(D(e.q[0]) * v.x + xy * v.y) + xz * v.z, (xy * v.x + D(e.q[1]) * v.y) + yz * v.z,
            (xz * v.x + yz * v.y) + D(e.q[2]) * v.z};
  }
  /// a, b, c and b^2 - a c of the point and the direction in `in`, in double-double.
  static void equation(const QuadricElement& e, const double (&in)[6], double (&out)[4]);
};

}  // namespace oktett
