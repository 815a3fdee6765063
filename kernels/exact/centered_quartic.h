#pragma once
/// \file Surfaces that a centred line meets where a quartic without cubic term is zero: tori and cyclides.

#include "kernels/exact/exact.h"
#include "kernels/roots/bernstein_lanes.h"

namespace oktett {

/// The part a <= s <= b of a centred line that lies in a ball about the origin and in the line's range.
template <class D>
struct BallRange {
  D a, b;
  typename D::M there;  ///< lanes that are asked for and in which this part is not empty

  /// `square` is the square of the ball's radius.
  OKTETT_INLINE BallRange(const CenteredLine<D>& l, const D& square, const LineRange<D>& range,
                          const typename D::M& active) {
    const D reach2 = square - dot_lanes(l.p, l.p);
    const D reach = sqrt(max(reach2, D(0.0)));
    a = max(l.to_s(range.a), -reach), b = min(l.to_s(range.b), reach);
    there = active & (reach2 >= D(0.0)) & (a <= b);
  }
};

/// Lists the first K of the roots of s^4 + c[2] s^2 + c[1] s + c[0] in the lanes of `there`. `roots` holds
/// the first N roots in ascending order, all of them if N is 4; some may have been replaced by kNoRoot.
template <int K, int N, class D>
OKTETT_INLINE void list_quartic_roots(const roots::LaneRoots<D, N>& roots, const CenteredLine<D>& l,
                                      const D (&c)[5], const typename D::M& there, Crossings<K, D>& out) {
  CrossingList<K, D> list(out);
  for (int i = 0; i < N; ++i) {
    const D s = roots.x[i];
    const D slope = (D(4.0) * s * s + D(2.0) * c[2]) * s + c[1];
    list.push(there & (s < D(roots::kNoRoot)), l.to_t(s), select(slope < D(0.0), D(-1.0), D(1.0)), D(0.0));
  }
  list.finish(K < N || N == 4 ? D(roots::kNoRoot) : out.t[K - 1]);
}

}  // namespace oktett
