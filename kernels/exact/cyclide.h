#pragma once
/// \file Dupin cyclides.
///
/// With a = major, c = taper, d = minor and b^2 = a^2 - c^2 the equation has a second form, which a line
/// turns into a quartic that cancels less: (x^2 + y^2 + z^2 - b^2 - d^2)^2 = 4 (c x - a d)^2 - 4 b^2 z^2.

#include "kernels/exact/cyclide_data.h"
#include "kernels/exact/exact.h"
#include "kernels/roots/bernstein_lanes.h"

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
    const D reach2 = D(1 + 0x1p-40) - pp;
    const D reach = sqrt(max(reach2, D(0.0)));
    const D from = max(l.to_s(range.a), -reach), to = min(l.to_s(range.b), reach);
    const auto there = active & (reach2 >= D(0.0)) & (from <= to);
    out.clear();
    if (none(there)) return;
    const auto roots = roots::certified_roots<4, K, roots::Touching::drop>(c, from, to, there);
    CrossingList<K, D> list(out);
    for (int i = 0; i < K; ++i) {
      const D s = roots.x[i], slope = (D(4.0) * s * s + D(2.0) * c2) * s + c1;
      list.push(there & (s < D(roots::kNoRoot)), l.to_t(s), select(slope < D(0.0), D(-1.0), D(1.0)), D(0.0));
    }
    list.finish(K < 4 ? out.t[K - 1] : D(roots::kNoRoot));
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
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// Along the lines of curvature, which are circles: u around the axis from +x towards +y, v around the tube
  /// from the outside upwards, both in [0, 1].
  static void uv(const Pool& pool, std::size_t i, int part, const Vec3d& p, SurfaceInteraction& s);
};

}  // namespace oktett
