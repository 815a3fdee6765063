#pragma once
/// \file The first crossing of a ray with a function by long steps, where a grid of bounds on its derivatives
/// proves that it is the one that march.h finds (after D. Kalra, A. H. Barr: Guaranteed ray intersections
/// with implicit surfaces, 1989). What it cannot prove is left to march.h; docs/interval.md has the proof.

#include "core/simd_memory.h"
#include "kernels/exact/exact.h"
#include "kernels/exact/implicit_grid.h"
#include "kernels/interval/interval.h"
#include "kernels/interval/lane_math.h"

namespace oktett {

/// Steps after which the rest of the rays is left to intervals.
inline constexpr int kMaxStrides = 96;

/// What is known of a function where a ray is.
template <class D>
struct GridPlace {
  D end;      ///< as far as it holds
  D bend[2];  ///< ImplicitGridCell's bounds, for a step of the ray's parameter
  D slope, error;
};

/// A ray's way through a grid.
template <class D>
struct GridWay {
  using M = typename D::M;
  const VariationGrid& grid;
  Vec3<D> from, by, per;  ///< position in cells at s = 0, cells per s and the inverse of that
  D nudge;                ///< so little beyond the border of a cell still belongs to it
  D length, size;         ///< of the way, and of the direction

  OKTETT_INLINE GridWay(const VariationGrid& g, const Vec3<D>& o, const Vec3<D>& d, const D& s)
      : grid(g), length(s), size(length_lanes(d)) {
    const Vec3<D> scale = broadcast<D>(g.per_unit), lo = broadcast<D>(g.lo);
    from = {(o.x - lo.x) * scale.x, (o.y - lo.y) * scale.y, (o.z - lo.z) * scale.z};
    by = {d.x * scale.x, d.y * scale.y, d.z * scale.z};
    const D one(1.0);
    per = {one / by.x, one / by.y, one / by.z};
    nudge = D(kGridMargin / 8) * min(min(abs(per.x), abs(per.y)), abs(per.z));
  }
  /// Whether the way from 0 to `length` is in the grid, but for less than the margin of a cell.
  OKTETT_INLINE M is_inside() const {
    const D low(-kGridMargin / 8), high(grid.side + kGridMargin / 8);
    const auto within = [&](const D& a, const D& d) {
      const D b = a + length * d;
      return (low <= a) & (a <= high) & (low <= b) & (b <= high);
    };
    return within(from.x, by.x) & within(from.y, by.y) & within(from.z, by.z);
  }
  /// Moves the lanes of `movable` forward over cells in which the function has one sign. Returns what is
  /// known at s then.
  OKTETT_INLINE GridPlace<D> at(const M& movable, D& s) const {
    const D zero(0.0), square = size * size;
    if (grid.side == 1) {
      const ImplicitGridCell& c = grid.cells[0];
      return {length, {D(c.bend[0]) * square, D(c.bend[1]) * square}, D(c.slope) * size, D(c.error)};
    }
    D end, index = cell(s, end);
    const float* const cells = grid.cells[0].bend;
    D slope = gather(cells + 2, index);
    for (int k = 0; k < 3 * grid.side; ++k) {
      const auto quiet = movable & (slope == zero) & (s < length);
      if (none(quiet)) break;
      s = select(quiet, end, s);
      index = cell(s, end), slope = gather(cells + 2, index);
    }
    return {end,
            {gather(cells, index) * square, gather(cells + 1, index) * square},
            slope * size,
            gather(cells + 3, index)};
  }

 private:
  /// Where the cell at s begins in the table, and where the way leaves it.
  OKTETT_INLINE D cell(const D& s, D& end) const {
    end = D(std::numeric_limits<double>::infinity());
    const D zero(0.0), last(grid.side - 1), side(grid.side);
    const auto place = [&](const D& a, const D& d, const D& inverse) {
      // On a border it does not matter which cell is taken.
      const D k = min(max(lane::round_even(a + s * d - D(0.5)), zero), last);
      end = min((k + select(d < zero, zero, D(1.0)) - a) * inverse, end);
      return k;
    };
    const D x = place(from.x, by.x, per.x), y = place(from.y, by.y, per.y), z = place(from.z, by.z, per.z);
    end = max(end, s) + nudge;
    return ((z * side + y) * side + x) * D(4.0);
  }
};

/// The first crossings on 0 <= s <= length in the lanes of `active`, where they are proved. `begin` + s is
/// the ray's t, and those t that round to the same float are the same. `stop_inside`: rays that begin inside
/// are not followed. `out` gets the crossings, `sign` the sign of the function at s = 0. Returns the lanes in
/// which nothing is proved.
template <class Field, class D>
OKTETT_NOINLINE typename D::M first_by_strides(const VariationGrid& grid, const Field& field, const D& begin,
                                               const D& length, const typename D::M& stop_inside,
                                               const typename D::M& active, Crossings<1, D>& out, D& sign) {
  using M = typename D::M;
  const D zero(0.0), one(1.0);
  const GridWay<D> way(grid, field.o, field.d, length);
  out.clear(), sign = zero;
  M live = active & way.is_inside() & (zero < length);
  M unsure = active & ~live, trying = live & ~live, negative = trying;
  D s(0.0), proved(0.0);
  const D least = length * D(0x1p-40), width = length * D(0x1p-41);
  for (int i = 0; i < kMaxStrides && any(live); ++i) {
    const GridPlace<D> here = way.at(i == 0 ? trying : live & ~trying, s);
    live = live & (s < length);
    if (none(live)) break;
    const auto at = field.rate(s);
    if (i == 0) {
      negative = at.v < zero, sign = select(negative, -one, one);
      const M unknown = live & ~(here.slope < Interval<D>::infinity());
      unsure = unsure | unknown, live = live & ~unknown;
    }
    const D f = at.v * sign, rate = at.d * sign;
    // What has been tried is a place behind the crossing.
    if (any(trying)) {
      const D t0 = begin + (proved - width), t1 = begin + (s + width);
      const M hit = trying & (f < -(here.error * D(128.0) + here.slope * least)) &
                    (to_double(to_float(t0)) == to_double(to_float(t1))) &
                    (to_double(to_float(begin)) < to_double(to_float(t0)));
      out.t[0] = select(hit, begin + s, out.t[0]);
      out.turn[0] = select(hit, -sign, out.turn[0]);
      unsure = unsure | (trying & ~hit), live = live & ~trying;
    }
    const D above = f - here.error * D(16.0), slope = rate - here.slope * D(kSlopeError);
    unsure = unsure | (live & ~(zero < above)), live = live & (zero < above);
    if (i == 0) {
      live = live & ~(stop_inside & negative);
      if (none(live)) break;
    }
    // f(s + x) is at least above + slope x - bend x^2 / 2, and at least above - here.slope x.
    const D bend = select(negative, here.bend[1], here.bend[0]),
            root = sqrt(slope * slope + D(2.0) * bend * above);
    const M leaving = zero < slope;
    D step = select(leaving, slope + root, D(2.0) * above) / select(leaving, bend, root - slope);
    const M kinked = live & ~(bend < Interval<D>::infinity());
    if (any(kinked)) {
      step = select(kinked, above / here.slope, step);
      const M lost = kinked & ~(zero < step);
      if (any(lost)) {
        // Nothing is known of the derivatives; perhaps values are enough.
        const Interval<D> over = field.over(Interval<D>(s, min(here.end, length))).v;
        const M same = select(negative, -over.hi, over.lo) > zero;
        step = select(lost & same, here.end - s, step);
        unsure = unsure | (lost & ~same), live = live & ~(lost & ~same);
      }
    }
    step = step * D(1 - 0x1p-30);
    const D next = s + step, near = (begin + next) * D(0x1p-36), fall = -rate;
    // Where the next step of Newton's method would be exact, its end is tried.
    const D per_fall = one / fall, newton = f * per_fall, gap = newton - step, noise = here.error * per_fall;
    const D beyond = s + (newton + (gap + (noise * D(256.0) + here.slope * (per_fall * (least * D(2.0))))));
    trying = live & (zero < fall) & (gap < near + noise * D(64.0)) & (s < beyond) & (beyond <= here.end) &
             (beyond <= length);
    proved = select(trying, next, proved);
    s = select(trying, beyond, select(live, min(next, here.end), s));
    live = live & (s < length);
  }
  return unsure | live;
}

}  // namespace oktett
