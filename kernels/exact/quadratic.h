#pragma once
/// \file What closed forms of degree two share: discriminants that do not cancel, and doubtful lanes that are
/// decided one by one in double-double.

#include "kernels/exact/exact.h"
#include "kernels/exact/segment.h"

namespace oktett {

/// a b - c d to about two units in the last place (Kahan; C.-P. Jeannerod, N. Louvet, J.-M. Muller: Further
/// analysis of Kahan's algorithm, Math. Comp. 82, 2013). Nothing here may overflow or underflow: then the
/// bits do not depend on the instruction set.
template <class D>
OKTETT_INLINE D product_difference(const D& a, const D& b, const D& c, const D& d) {
  const D p = a * b, q = c * d;
  return (p - q) + (product_error(a, b, p) - product_error(c, d, q));
}

/// Calls f(in, out) for each lane of `which`: `in` holds the lane of N columns, what f leaves in the M
/// numbers of `out` replaces that of the others.
template <int N, int M, class D, class F>
OKTETT_NOINLINE void lane_by_lane(const typename D::M& which, const D (&in)[N], D (&out)[M], const F& f) {
  constexpr int W = D::kWidth;
  double from[N][W], to[M][W];
  for (int i = 0; i < N; ++i) in[i].store(from[i]);
  for (int i = 0; i < M; ++i) out[i].store(to[i]);
  const unsigned lanes = bits(which);
  for (int lane = 0; lane < W; ++lane) {
    if (!(lanes >> lane & 1)) continue;
    double x[N], y[M];
    for (int i = 0; i < N; ++i) x[i] = from[i][lane];
    f(x, y);
    for (int i = 0; i < M; ++i) to[i][lane] = y[i];
  }
  for (int i = 0; i < M; ++i) out[i] = D::load(to[i]);
}

/// Discriminants below this times the sizes that they are made of are computed again in double-double. In
/// double they are off by 2^-49 of that, so that half a chord is off by 2^-38 of the element's size.
inline constexpr double kDoubtfulDiscriminant = 0x1p-24;

/// (dx, dy)^2 - (ox dy - oy dx)^2 for in = {ox, oy, dx, dy}. The sign is right, or |out| < 2^-97 (dx, dy)^2.
void circle_discriminant(const double (&in)[4], double (&out)[1]);
/// (px dw - pw dx)^2 + (py dw - pw dy)^2 - (px dy - py dx)^2 for in = {px, py, pw, dx, dy, dw}; as precise.
void cone_discriminant(const double (&in)[6], double (&out)[1]);

/// The least power of two that is not below `half`: a unit that rounds nothing.
double unit_for(double half);
/// `center` rounded to a 256th of `unit`, so that simple numbers stay simple when it is subtracted.
double origin_for(double center, double unit);

/// Where a line is between two planes z = -1 and z = 1.
template <class D>
struct UnitSlab {
  D in, out;            ///< in < out where the line meets it at all; infinite for a line inside
  D in_part, out_part;  ///< 1 the plane z = -1, 2 the plane z = 1
  typename D::M meets;

  /// A line along the slab is in it or not: no threshold.
  OKTETT_INLINE UnitSlab(const D& oz, const D& dz) {
    const D inf(roots::kNoRoot), inverse = D(1.0) / dz;
    const D low = (D(-1.0) - oz) * inverse, high = (D(1.0) - oz) * inverse;
    const auto along = dz == D(0.0), back = dz < D(0.0);
    in = select(along, -inf, select(back, high, low));
    out = select(along, inf, select(back, low, high));
    in_part = select(back, D(2.0), D(1.0));
    out_part = select(back, D(1.0), D(2.0));
    meets = (in < out) & (~along | (abs(oz) < D(1.0)));
  }
};

/// Lists the two ends of the part of a line that is inside of a convex solid, as far as they lie in `range`.
template <int K, class D>
OKTETT_INLINE void list_interval(const typename D::M& meets, const D& t0, const D& part0, const D& t1,
                                 const D& part1, const LineRange<D>& range, CrossingList<K, D>& list) {
  list.push(meets & (t0 >= range.a), t0, D(-1.0), part0);
  list.push(meets & (t1 >= range.a), t1, D(1.0), part1);
  list.finish(D(roots::kNoRoot));
}

}  // namespace oktett
