#pragma once
/// \file Polynomials along a ray, whose degree is known only at run time: how they are put together in lanes,
/// and their roots as crossings.
///
/// The part of the ray to look at is taken to -1 <= s <= 1. A coordinate that is m in the middle and m + h at
/// the end is m + h s, and |m| + |h| is the greatest magnitude that it takes. So the sum of the magnitudes of
/// all coefficients, and with it every rounding error, stays below what the same polynomial with positive
/// signs has at the far corner of the box that the ray is in. docs/numerics.md draws the bound from this.

#include <algorithm>
#include <utility>

#include "kernels/exact/exact.h"
#include "kernels/roots/bernstein_lanes.h"

namespace oktett {

inline constexpr int kMaxRayDegree = roots::kMaxDegree;

/// The part of a line that is looked at, in terms of s: t = middle + s half.
template <class D>
struct RaySegment {
  D middle, half;
  Vec3<D> m, h;  ///< the point in the middle, and from there to the end

  OKTETT_INLINE RaySegment(const Line<D>& line, const LineRange<D>& range) {
    half = D(0.5) * (range.b - range.a);
    middle = range.a + half;
    m = {line.o.x + middle * line.d.x, line.o.y + middle * line.d.y, line.o.z + middle * line.d.z};
    h = {half * line.d.x, half * line.d.y, half * line.d.z};
  }
  OKTETT_INLINE D to_t(const D& s) const { return middle + s * half; }
};

/// a := a (m + h s), where a has `degree` before.
template <class D>
OKTETT_INLINE void times_linear(D* a, int degree, const D& m, const D& h) {
  a[degree + 1] = a[degree] * h;
  for (int i = degree; i > 0; --i) a[i] = a[i] * m + a[i - 1] * h;
  a[0] = a[0] * m;
}

/// a := a (q0 + q1 s + q2 s^2), where a has `degree` before.
template <class D>
OKTETT_INLINE void times_quadratic(D* a, int degree, const D (&q)[3]) {
  a[degree + 2] = a[degree] * q[2];
  a[degree + 1] = degree > 0 ? a[degree] * q[1] + a[degree - 1] * q[2] : a[0] * q[1];
  for (int i = degree; i > 1; --i) a[i] = (a[i] * q[0] + a[i - 1] * q[1]) + a[i - 2] * q[2];
  if (degree > 0) a[1] = a[1] * q[0] + a[0] * q[1];
  a[0] = a[0] * q[0];
}

/// The roots of a polynomial in -1 <= s <= 1 at which its sign changes, in ascending order.
struct SignChanges {
  int count = 0;
  double s[kMaxRayDegree];
  double turn[kMaxRayDegree];  ///< -1 where it falls, else 1; in turn
};

/// By roots::solve; at most `wanted`. Methods that prove nothing may leave out or invent some.
void find_sign_changes(const double* c, int degree, roots::Method method, int wanted, SignChanges& out);

/// The changes of sign along a ray that is looked at in parts. Where the sign at the beginning of a part is
/// not that at the end of the last one, a root at the end of one of them was found in both or in none.
struct PartwiseChanges {
  int count = 0;
  double s[kMaxRayDegree + 2], turn[kMaxRayDegree + 2];
  double first_sign = 0;  ///< -1 or 1

  /// Adds those in the part middle +- half, up to `most` in all. `c` is null if there are none, and `sign` is
  /// the function's then.
  void add(const double* c, int degree, roots::Method method, double sign, double middle, double half,
           int most);

 private:
  void push(double place, double way);
  double sign_ = 0;
};

/// -1 or 1, the sign that a polynomial without changes of sign has in -1 <= s <= 1; if it has any, some sign.
template <class D>
OKTETT_INLINE D common_sign(const D* c, int degree) {
  // Where the value is least certain it counts least.
  D middle = c[0], ends(0.0);
  for (int i = degree & ~1; i >= 0; i -= 2) ends = ends + c[i];
  return select(middle + ends < D(0.0), D(-1.0), D(1.0));
}

/// The first K changes of sign, where the degree is N, in lanes of `active`.
template <int N, int K, class D>
OKTETT_NOINLINE void changes_of_degree(const D* c, const typename D::M& active, D (&s)[K], D (&turn)[K]) {
  constexpr int M = std::min(N, K);
  const auto found = roots::certified_roots<N, M, roots::Touching::drop>(c, D(-1.0), D(1.0), active);
  for (int k = 0; k < M; ++k) s[k] = select(active, found.x[k], D(roots::kNoRoot));
  // The turns follow from the sign before the first, or where that is uncertain from the steepest one.
  D value, error, steepest;
  roots::lanes::evaluate<N>(c, D(-1.0), value, error, steepest);
  steepest = D(0.0);
  for (int k = 0; k < M; ++k) {
    const auto there = s[k] < D(roots::kNoRoot);
    if (k > 0 && none(there & ~(abs(value) > error))) break;
    D at, error_at, slope;
    roots::lanes::evaluate<N>(c, select(there, s[k], D(0.0)), at, error_at, slope);
    steepest = select(there & (abs(steepest) < abs(slope)), k % 2 == 0 ? slope : -slope, steepest);
  }
  const auto falls = select(abs(value) > error, value, -steepest) > D(0.0);
  const D first = select(falls, D(-1.0), D(1.0));
  for (int k = 0; k < M; ++k) turn[k] = k % 2 == 0 ? first : -first;
}

/// The same where the degree is known when the program runs: at most 8.
template <int K, class D>
OKTETT_INLINE void changes_in_lanes(const D* c, int degree, const typename D::M& active, D (&s)[K],
                                    D (&turn)[K]) {
  const auto solve = [&]<int... N>(std::integer_sequence<int, N...>) {
    ((degree == N + 1 ? changes_of_degree<N + 1>(c, active, s, turn) : void()), ...);
  };
  solve(std::make_integer_sequence<int, 8>());
}

/// Lanes in which a polynomial of any degree surely has no root in -1 <= s <= 1: on each half, all of its
/// Bernstein coefficients have one sign. They are sums of parts of coefficients, each part rounded no more
/// than 2 n + 4 times, and all parts together no more than the coefficients themselves.
template <class D>
OKTETT_NOINLINE typename D::M no_sign_change(const D* c, int degree) {
  D sum = abs(c[0]);
  for (int i = 1; i <= degree; ++i) sum = sum + abs(c[i]);
  const D error = D((4 * degree + 12) * 0x1p-53) * sum + D(roots::lanes::kLaneUnderflow);
  auto above = c[0] > error, below = c[0] < -error;
  for (int side = -1; side <= 1; side += 2) {
    D b[kMaxRayDegree + 1];
    b[0] = c[0];
    double binomial = 1;
    for (int i = 1; i <= degree; ++i) {
      binomial = binomial * (degree + 1 - i) / i;
      b[i] = c[i] * D((side < 0 && i % 2 == 1 ? -1 : 1) / binomial);
    }
    for (int k = 1; k <= degree; ++k)
      for (int i = degree; i >= k; --i) b[i] = b[i] + b[i - 1];
    for (int i = 1; i <= degree; ++i) above = above & (b[i] > error), below = below & (b[i] < -error);
  }
  return above | below;
}

/// Changes of sign in lanes: the first one of each if K = 1, else all that there is room for.
template <int K, class D>
OKTETT_NOINLINE void sign_changes(const D* c, int degree, roots::Method method, const typename D::M& active,
                                  D (&s)[K], D (&turn)[K]) {
  for (int k = 0; k < K; ++k) s[k] = D(roots::kNoRoot), turn[k] = D(0.0);
  if (none(active) || degree < 1) return;
  constexpr int W = D::kWidth;
  if (method == roots::Method::automatic && degree <= 8) {
    const auto wanted = K == 1 ? active : active & ~no_sign_change(c, degree);
    if (any(wanted)) changes_in_lanes(c, degree, wanted, s, turn);
    return;
  }
  double columns[kMaxRayDegree + 1][W], places[K][W], turns[K][W];
  for (int i = 0; i <= degree; ++i) c[i].store(columns[i]);
  for (int k = 0; k < K; ++k) s[k].store(places[k]), turn[k].store(turns[k]);
  unsigned lanes = bits(active);
  if (method == roots::Method::automatic) lanes &= ~bits(no_sign_change(c, degree));
  for (int lane = 0; lane < W; ++lane) {
    if (!(lanes >> lane & 1)) continue;
    double own[kMaxRayDegree + 1];
    for (int i = 0; i <= degree; ++i) own[i] = columns[i][lane];
    SignChanges found;
    find_sign_changes(own, degree, method, K, found);
    for (int k = 0; k < found.count; ++k) places[k][lane] = found.s[k], turns[k][lane] = found.turn[k];
  }
  for (int k = 0; k < K; ++k) s[k] = D::load(places[k]), turn[k] = D::load(turns[k]);
}

/// The same where one polynomial for all of the ray would lose too many digits: made for each of `parts`
/// shorter segments, by make(segment, coefficients). `sign` is that at the beginning.
template <int K, class D, class Make>
OKTETT_INLINE void sign_changes_in_parts(int parts, const RaySegment<D>& segment, int degree,
                                         roots::Method method, const typename D::M& active, Make&& make,
                                         D (&s)[K], D (&turn)[K], D& sign) {
  constexpr int W = D::kWidth;
  PartwiseChanges lane[W];
  unsigned open = bits(active);
  const double half = 1.0 / parts;
  for (int part = 0; part < parts && open != 0; ++part) {
    const double middle = (2 * part + 1) * half - 1;
    RaySegment<D> here = segment;
    here.m = {segment.m.x + D(middle) * segment.h.x, segment.m.y + D(middle) * segment.h.y,
              segment.m.z + D(middle) * segment.h.z};
    here.h = {D(half) * segment.h.x, D(half) * segment.h.y, D(half) * segment.h.z};
    D c[kMaxRayDegree + 1];
    make(here, c);
    double columns[kMaxRayDegree + 1][W], signs[W];
    for (int i = 0; i <= degree; ++i) c[i].store(columns[i]);
    common_sign(c, degree).store(signs);
    const unsigned settled = method == roots::Method::automatic ? bits(no_sign_change(c, degree)) : 0;
    for (int k = 0; k < W; ++k) {
      if (!(open >> k & 1)) continue;
      double own[kMaxRayDegree + 1];
      for (int i = 0; i <= degree; ++i) own[i] = columns[i][k];
      lane[k].add(settled >> k & 1 ? nullptr : own, degree, method, signs[k], middle, half, K);
      if (lane[k].count >= K) open &= ~(1u << k);
    }
  }
  double places[K][W], turns[K][W], signs[W];
  for (int k = 0; k < W; ++k) {
    signs[k] = lane[k].first_sign;
    for (int i = 0; i < K; ++i) {
      const bool there = i < lane[k].count;
      places[i][k] = there ? lane[k].s[i] : roots::kNoRoot, turns[i][k] = there ? lane[k].turn[i] : 0;
    }
  }
  for (int i = 0; i < K; ++i) s[i] = D::load(places[i]), turn[i] = D::load(turns[i]);
  sign = D::load(signs);
}

/// Changes of sign as crossings. `closed`: what is inside of the surface is cut by the cell, and closed by
/// its faces; `sign` is then that of the function where it has no changes.
template <int K, class D>
OKTETT_INLINE void list_sign_changes(const D (&s)[K], const D (&turn)[K], const D& sign, bool closed,
                                     const RaySegment<D>& segment, const LineRange<D>& range,
                                     const typename D::M& active, Crossings<K, D>& out) {
  Crossings<K, D> open;
  for (int k = 0; k < K; ++k) {
    open.t[k] = select(s[k] < D(roots::kNoRoot), segment.to_t(s[k]), s[k]);
    open.turn[k] = turn[k];
    open.part[k] = D(0.0);
  }
  open.up_to = D(roots::kNoRoot);
  if (closed)
    close_by_cell(open, sign < D(0.0), range, active, out);
  else
    out = open;
}

}  // namespace oktett
