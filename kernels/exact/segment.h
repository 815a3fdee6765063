#pragma once
/// \file A surface against pieces of lines in float: a filter that rejects lines that surely miss it, before
/// it is solved in double, and accepts lines that surely are inside of its solid somewhere.
///
/// A surface that has such a filter offers two functions.
///
/// `S::classify(pool, cell, segment, at)` returns a SegmentVerdict. Where its `inside` is set, `at` is the
/// place, from 0 to 1, at which the line is inside of the solid, provided that it is inside of the cell
/// there.
///
/// `S::value(pool, cell, p)` is optional: the function that is classified, in double. The components of its
/// gradient add up to less than 64 in a cell where a verdict may say `falls`.
///
/// The bounds are derived in docs/numerics.md.

#include "core/lanes.h"
#include "core/simd.h"

namespace oktett {

/// Pieces of lines between `a` and `b`, in the own space of an element. A piece contains all points of its
/// line that are inside of the cell and within the range of the ray, up to `error` in each coordinate.
template <class F>
struct Segment {
  Vec3<F> a, b;
  float error;
};

template <class F>
struct SegmentVerdict {
  typename F::M misses;  ///< surely no crossing
  typename F::M inside;  ///< surely inside of the solid at some place
  typename F::M falls;   ///< surely no crossing if the function is positive at `b`
};

/// Least of the Bernstein coefficients `c`.
template <int N, class F>
OKTETT_INLINE F least_of(const F (&c)[N]) {
  F least = c[0];
  for (int i = 1; i < N; ++i) least = min(least, c[i]);
  return least;
}

/// Least difference of a Bernstein coefficient to the next.
template <int N, class F>
OKTETT_INLINE F least_fall(const F (&c)[N]) {
  F least = c[0] - c[1];
  for (int i = 1; i + 1 < N; ++i) least = min(least, c[i] - c[i + 1]);
  return least;
}

/// Splits the polynomial with the Bernstein coefficients `right` in the middle (de Casteljau).
template <int N, class F>
OKTETT_INLINE void halve(F (&left)[N], F (&right)[N]) {
  left[0] = right[0];
  for (int k = 1; k < N; ++k) {
    for (int i = 0; i < N - k; ++i) right[i] = (right[i] + right[i + 1]) * F(0.5f);
    left[k] = right[0];
  }
}

/// The polynomial with the N Bernstein coefficients `c` on [0, 1], each off by at most `margin`, of which
/// negative values are inside. Its sign is sure where all coefficients are above `margin`; the halves are
/// looked at separately. Where it falls, it falls in the last quarter, and its sign is sure before.
template <int N, class F>
OKTETT_INLINE SegmentVerdict<F> classify_polynomial(const F (&c)[N], const F& margin, F& at) {
  F left[N], right[N], third[N];
  for (int i = 0; i < N; ++i) right[i] = c[i];
  halve(left, right);
  at = F(0.5f);
  SegmentVerdict<F> verdict;
  verdict.inside = right[0] < -margin;
  const auto starts = margin < least_of(left);
  verdict.misses = (margin < least_of(c)) | (starts & (margin < least_of(right)));
  halve(third, right);
  const F twice = margin + margin;
  verdict.falls = starts & (margin < least_of(third)) & (twice < least_fall(right));
  return verdict;
}

/// The same for a polynomial of degree two, by its discriminant.
template <class F>
OKTETT_INLINE SegmentVerdict<F> classify_quadratic(const F& c0, const F& c1, const F& c2, const F& margin,
                                                   F& at) {
  const F zero(0.0f), one(1.0f);
  const F d0 = c0 - margin, d1 = c1 - margin, d2 = c2 - margin;
  const auto misses = (zero < d0) & (zero < d2) & ((zero < d1) | (d1 * d1 * F(1 + 0x1p-20f) < d0 * d2));
  // The place of the least value.
  const F down = c0 - c1, bend = down + (c2 - c1);
  at = min(max(select(zero < bend, down * fast_reciprocal(bend), F(0.5f)), F(0x1p-4f)), F(1 - 0x1p-4f));
  const F rest = one - at;
  const F value = fast_fma(at, fast_fma(at, c2, rest * (c1 + c1)), rest * rest * c0);
  const F twice = margin + margin, m01 = c0 + c1, m12 = c1 + c2;
  // From the middle on it falls, and before it is positive.
  const auto falls = (zero < d0) & (twice < m01) & (F(4.0f) * margin < m01 + m12) &
                     (twice + twice < m01 - m12) & (twice + twice < m12 - (c2 + c2));
  return {misses, value < -margin, falls};
}

}  // namespace oktett
