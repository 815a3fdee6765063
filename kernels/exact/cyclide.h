#pragma once
/// \file Dupin cyclides.
///
/// With a = major, c = taper, d = minor and b^2 = a^2 - c^2 the equation has a second form, which a line
/// turns into a quartic that cancels less: (x^2 + y^2 + z^2 - b^2 - d^2)^2 = 4 (c x - a d)^2 - 4 b^2 z^2.

#include "kernels/exact/centered_quartic.h"
#include "kernels/exact/cyclide_data.h"

namespace oktett {

struct CyclideElement {
  double a, b, c, d;
};

struct Cyclide {
  using Data = CyclideShape;
  using Pool = ExactPool<CyclideElement>;
  static constexpr int kMaxCrossings = 4;
  static constexpr bool kOneCell = true;

  static void add(Pool& pool, const CyclideShape& shape, const ExactPlace& place);

  /// With p the point of the line nearest to the centre, p.u = 0 and the quartic has no cubic term. With
  /// k = p.p - b^2 - d^2, e = c p_x - a d, g = c u_x, h = b p_z and m = b u_z it is
  /// s^4 + 2 (k - 2 g^2 + 2 m^2) s^2 + 8 (h m - e g) s + k^2 - 4 e^2 + 4 h^2.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const CyclideElement& cyclide = pool.elements[cell.element];
    const CenteredLine<D> l(line);
    const D pp = dot_lanes(l.p, l.p), k = pp - D(cyclide.b * cyclide.b + cyclide.d * cyclide.d);
    const D e = D(cyclide.c) * l.p.x - D(cyclide.a * cyclide.d), g = D(cyclide.c) * l.u.x;
    const D h = D(cyclide.b) * l.p.z, m = D(cyclide.b) * l.u.z;
    const D c2 = D(2.0) * (k + D(2.0) * (m * m - g * g)), c1 = D(8.0) * (h * m - e * g);
    const D c0 = k * k + D(4.0) * (h - e) * (h + e);
    const D c[5] = {c0, c1, c2, D(0.0), D(1.0)};
    // Everything lies in the unit sphere.
    const BallRange<D> ball(l, D(1 + 0x1p-40), range, active);
    out.clear();
    if (none(ball.there)) return;
    list_quartic_roots(roots::certified_roots<4, K, roots::Touching::drop>(c, ball.a, ball.b, ball.there), l,
                       c, ball.there, out);
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D&, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const CyclideElement& cyclide = pool.elements[i];
    const D bb(cyclide.b * cyclide.b), c(cyclide.c);
    const D r = dot_lanes(p, p) - (bb + D(cyclide.d * cyclide.d));
    const D e = c * p.x - D(cyclide.a * cyclide.d);
    value = r * r - D(4.0) * (e * e - bb * (p.z * p.z));
    gradient = {D(4.0) * (r * p.x) - D(8.0) * (c * e), D(4.0) * (r * p.y),
                D(4.0) * (r * p.z) + D(8.0) * (bb * p.z)};
  }
  /// Along the lines of curvature, which are circles: u around the axis from +x towards +y, v around the tube
  /// from the outside upwards, both in [0, 1].
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
};

}  // namespace oktett
