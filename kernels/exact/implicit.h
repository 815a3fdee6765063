#pragma once
/// \file Functions of x, y and z inside of a box, solved by intervals along the ray
/// (kernels/exact/march.h; D. P. Mitchell: Robust ray intersection with interval arithmetic, 1990), in cells
/// in which parts of the function do not matter (implicit_grid.h).

#include <memory>

#include "core/simd_memory.h"
#include "kernels/exact/exact.h"
#include "kernels/exact/implicit_data.h"
#include "kernels/exact/implicit_grid.h"
#include "kernels/exact/march.h"
#include "kernels/functions/function_tape.h"
#include "kernels/interval/interval.h"
#include "kernels/interval/lane_math.h"

namespace oktett {

// ---- The first crossing of a ray with a function by long steps, where a grid of bounds on its derivatives
// proves that it is the one that march.h finds (after D. Kalra, A. H. Barr: Guaranteed ray intersections
// with implicit surfaces, 1989). What it cannot prove is left to march.h; docs/interval.md has the proof.

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

// ---- Functions of x, y and z inside of a box.

struct ImplicitElement {
  FunctionTape function;
  double size;  ///< a power of two: so many units of the function's are 1 in the own space
  bool open;
  Vec3d lo, hi;
  /// In the function's own variables. Elements that follow each other share the grid and the cells of the
  /// same function.
  std::shared_ptr<const VariationGrid> grid;
  std::shared_ptr<const FunctionCells> cells;  ///< null: the box is one cell, and the grid is its grid
};

struct ImplicitPool : ExactPool<ImplicitElement> {
  std::size_t bytes() const;
};

/// The function along rays. s is 0 where they begin to matter.
template <class D>
struct FunctionField {
  const FunctionTape& function;
  Vec3<D> o, d;

  OKTETT_INLINE Dual<Interval<D>> over(const Interval<D>& s) const {
    const auto axis = [&](const D& from, const D& by) {
      return Dual<Interval<D>>{s * by + Interval<D>(from), Interval<D>(by)};
    };
    return run_tape(function, axis(o.x, d.x), axis(o.y, d.y), axis(o.z, d.z));
  }
  OKTETT_INLINE Interval<D> at(const D& s) const {
    const auto axis = [&](const D& from, const D& by) { return Interval<D>(s) * by + Interval<D>(from); };
    return run_tape(function, axis(o.x, d.x), axis(o.y, d.y), axis(o.z, d.z));
  }
  /// The value at a point and the derivative by s, computed in plain arithmetic.
  OKTETT_INLINE Gradient<D, Walls::flat, D> rate(const D& s) const {
    const auto axis = [&](const D& from, const D& by) {
      return Gradient<D, Walls::flat, D>{from + s * by, by};
    };
    return run_tape(function, axis(o.x, d.x), axis(o.y, d.y), axis(o.z, d.z));
  }
};

/// Parts: 0 the surface, 1 to 6 the faces of the box, kJumpPart where the function jumps.
struct Implicit {
  using Data = ImplicitShape;
  using Pool = ImplicitPool;
  static constexpr int kMaxCrossings = 18;

  static void add(Pool& pool, const ImplicitShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const ImplicitElement& e = pool.elements[cell.element];
    const bool divided = cell.count > 0;
    const FunctionTape& function = divided ? e.cells->tapes[cell.begin] : e.function;
    const VariationGrid& grid = divided ? e.cells->grids[cell.count - 1] : *e.grid;
    // The box may be entered and left as well.
    constexpr int kOwn = K > 2 ? K - 2 : K;
    const D size(e.size), zero(0.0), length = range.b - range.a;
    const auto place = [&](const D& o, const D& d) { return (o + range.a * d) * size; };
    const FunctionField<D> field{
        function,
        {place(line.o.x, line.d.x), place(line.o.y, line.d.y), place(line.o.z, line.d.z)},
        {line.d.x * size, line.d.y * size, line.d.z * size}};
    Crossings<kOwn, D> own;
    LineRange<D> closed = range;
    D way = length;
    if (divided) {
      if (!e.open) leave_out_inner_faces(e, cell, closed);
      // At least the way through the box, so that a cell does not take smaller steps than the box would.
      const D fastest = max(max(abs(line.d.x), abs(line.d.y)), abs(line.d.z));
      way = max(length, D(max_component(e.hi - e.lo)) / fastest);
    }
    D sign;
    if (K > 1 || grid.cells.empty()) {
      sign = march(field, range.a, length, way, active, own);
    } else if constexpr (K == 1) {
      const auto enters = e.open ? ~active & active : closed.enter_face > zero;
      const auto rest = first_by_strides(grid, field, range.a, length, enters, active, own, sign);
      if (any(rest)) {
        Crossings<1, D> found;
        sign = select(rest, march(field, range.a, length, way, rest, found), sign);
        select_crossings(rest, found, own);
      }
    }
    if (!e.open) return close_by_cell(own, sign < zero, closed, active, out);
    CrossingList<K, D> list(out);
    for (int k = 0; k < kOwn; ++k)
      list.push(own.t[k] < D(roots::kNoRoot), own.t[k], own.turn[k], own.part[k]);
    list.finish(own.up_to);
  }

  /// NaN where the function is not defined.
  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const ImplicitElement& e = pool.elements[i];
    const D size(e.size), zero(0.0);
    set_slope(e, p, value, gradient);
    const auto wall = part == D(interval::kJumpPart);
    if (any(wall)) {
      // No value tells how far away a wall is.
      const Vec3<D> n = wall_normal(e, p);
      value = select(wall, zero, value);
      gradient = select_lanes(wall, n, gradient);
    }
    select_faces(e.lo, e.hi, select(wall, zero, part), p, value, gradient);
  }

 private:
  /// The first K crossings by intervals; returns the sign at the beginning.
  template <int K, class D>
  OKTETT_NOINLINE static D march(const FunctionField<D>& field, const D& begin, const D& length, const D& way,
                                 const typename D::M& active, Crossings<K, D>& out) {
    const D sign =
        interval::march<K>(field, D(0.0), length, length, way, active, interval::Jumps::list_steep, out);
    place_crossings(out, [&](const D& s) { return begin + s; });
    return sign;
  }

  /// Faces of a cell that are not faces of the box do not close the solid.
  template <class D>
  OKTETT_INLINE static void leave_out_inner_faces(const ImplicitElement& e, const ExactCell& cell,
                                                  LineRange<D>& range) {
    const D zero(0.0);
    for (int face = 1; face <= 6; ++face) {
      const int axis = (face - 1) / 2;
      if (face % 2 == 1 ? cell.lo[axis] <= e.lo[axis] : e.hi[axis] <= cell.hi[axis]) continue;
      range.enter_face = select(range.enter_face == D(face), zero, range.enter_face);
      range.exit_face = select(range.exit_face == D(face), zero, range.exit_face);
    }
  }

  /// The value and the gradient of the function, by the tapes of the cells that the points are in.
  template <class D>
  OKTETT_INLINE static void set_slope(const ImplicitElement& e, const Vec3<D>& p, D& value,
                                      Vec3<D>& gradient) {
    if (e.cells == nullptr) {
      const Gradient<D> f = slope_of<Walls::flat>(e.function, e.size, p);
      value = f.v, gradient = f.d;
      return;
    }
    e.cells->tree.each_leaf(e.cells->root, p, [&](const CellNode& node, const typename D::M& lanes) {
      const bool leaf = node.kind == CellNode::Kind::leaf;
      const Gradient<D> f = slope_of<Walls::flat>(leaf ? e.cells->tapes[node.first] : e.function, e.size, p);
      value = select(lanes, f.v, value);
      gradient = select_lanes(lanes, f.d, gradient);
    });
  }

  template <Walls W, class D>
  OKTETT_INLINE static Gradient<D, W> slope_of(const FunctionTape& function, double function_size,
                                               const Vec3<D>& p) {
    const D size(function_size), zero(0.0);
    using T = Gradient<D, W>;
    return run_tape(function, T{p.x * size, {size, zero, zero}}, T{p.y * size, {zero, size, zero}},
                    T{p.z * size, {zero, zero, size}});
  }

  /// The normal of a wall, to the side where the function is not negative; zero where that is not to be told.
  template <class D>
  OKTETT_NOINLINE static Vec3<D> wall_normal(const ImplicitElement& e, const Vec3<D>& p) {
    const Vec3<D> d = slope_of<Walls::steep>(e.function, e.size, p).d;
    const D zero(0.0), greatest = max(max(abs(d.x), abs(d.y)), abs(d.z));
    // What is infinite or NaN tells nothing.
    const auto known = (zero < greatest) & (abs(d.x) + abs(d.y) + abs(d.z) < Interval<D>::infinity());
    const D per = select(known, D(1.0) / greatest, zero);
    const auto unit = [&](const D& x) { return select(known, x * per, zero); };
    const Vec3<D> n{unit(d.x), unit(d.y), unit(d.z)};
    const auto inside_at = [&](double by) {
      const D h(by);
      return slope_of<Walls::flat>(e.function, e.size, Vec3<D>{p.x + n.x * h, p.y + n.y * h, p.z + n.z * h})
                 .v < zero;
    };
    const auto ahead = inside_at(0x1p-22), behind = inside_at(-0x1p-22);
    const D way = select(behind & ~ahead, D(1.0), select(ahead & ~behind, D(-1.0), zero));
    return {n.x * way, n.y * way, n.z * way};
  }
};

}  // namespace oktett
