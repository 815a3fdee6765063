#pragma once
/// \file A line against one cell of a height field: the one decision that all walks share.
///
/// A line passes from cell to cell where it meets lines of the grid. Where that is depends on the line and
/// the grid line alone, and so does the sign of the height above the surface there: on an edge of the grid
/// the surface is straight between two samples (or a wall between two levels). A cell gets the signs where
/// the line enters and leaves it and finds as many crossings between as they ask for, so what two neighbours
/// find fits together whatever rounding does: no ray slips through an edge or a corner.

#include "kernels/exact/exact.h"
#include "kernels/heights/height_grid.h"

namespace oktett {

/// Upright walls of `nearest`; the others are parts of the surface (0) and faces of the box (1 to 6).
enum HeightPart { kWallLowX = 7, kWallHighX = 8, kWallLowZ = 9, kWallHighZ = 10 };

/// How the element's own space lies to the grid: column = x * scale.x + shift.x, sample as stored =
/// y * scale.y + shift.y, row = z * scale.z + shift.z.
struct HeightFrame {
  Vec3d scale, shift;
};

/// Lane `k` alone.
template <int W, class A>
OKTETT_INLINE Simd<double, 1, A> lane_of(const Simd<double, W, A>& x, int k) {
  double lanes[W];
  x.store(lanes);
  return Simd<double, 1, A>(lanes[k]);
}

/// The cell in which each lane's x is, of the field where it is outside.
template <class D>
OKTETT_INLINE D cell_of(const D& x, std::uint32_t samples) {
  // The whole number below, by rounding x - 1/2 to a whole number.
  const D last(static_cast<double>(samples) - 2), shifter(0x1.8p52);
  const D inside = min(max(x, D(0.0)), last + D(1.0));
  const D cell = ((inside - D(0.5)) + shifter) - shifter;
  return min(max(select(cell + D(1.0) <= inside, cell + D(1.0), cell), D(0.0)), last);
}

/// Lines in the space of the grid: x counts columns, z rows, and y is a sample as stored.
template <class D>
struct GridLines {
  using M = typename D::M;
  Vec3<D> o, d;
  /// A line meets column c at t = (c - meet_x) * per_x. Where it runs along the columns that is -infinity for
  /// those on its left and infinity for those on its right.
  D meet_x, per_x, meet_z, per_z;
  D enter, leave;  ///< between these the line is at heights that the surface has
  D noise;         ///< bound on the rounding of the line's height
  M forward_x, forward_z;

  OKTETT_INLINE GridLines(const HeightGrid& grid, const HeightFrame& frame, double margin,
                          const Line<D>& line) {
    const auto place = [&](const D& v, int k) { return v * D(frame.scale[k]) + D(frame.shift[k]); };
    o = {place(line.o.x, 0), place(line.o.y, 1), place(line.o.z, 2)};
    d = {line.d.x * D(frame.scale.x), line.d.y * D(frame.scale.y), line.d.z * D(frame.scale.z)};
    meet(o.x, d.x, grid.columns(), meet_x, per_x, forward_x);
    meet(o.z, d.z, grid.rows(), meet_z, per_z, forward_z);
    const D inf(std::numeric_limits<double>::infinity()), zero(0.0);
    const D bottom(grid.least() - margin), top(grid.greatest() + margin);
    const auto level = abs(d.y) < D(kTiny), rises = zero < d.y;
    enter = select(level, -inf, (select(rises, bottom, top) - o.y) / d.y);
    leave = select(level, inf, (select(rises, top, bottom) - o.y) / d.y);
    noise = (abs(o.y) + D(__builtin_fabs(grid.least()) + __builtin_fabs(grid.greatest()))) * D(0x1p-44);
  }
  /// One lane of others.
  template <class Wide>
  OKTETT_INLINE GridLines(const GridLines<Wide>& all, int k)
      : o{lane_of(all.o.x, k), lane_of(all.o.y, k), lane_of(all.o.z, k)},
        d{lane_of(all.d.x, k), lane_of(all.d.y, k), lane_of(all.d.z, k)},
        meet_x(lane_of(all.meet_x, k)),
        per_x(lane_of(all.per_x, k)),
        meet_z(lane_of(all.meet_z, k)),
        per_z(lane_of(all.per_z, k)),
        enter(lane_of(all.enter, k)),
        leave(lane_of(all.leave, k)),
        noise(lane_of(all.noise, k)),
        forward_x(M::from_bits(bits(all.forward_x) >> k & 1)),
        forward_z(M::from_bits(bits(all.forward_z) >> k & 1)) {}

  OKTETT_INLINE D at_column(const D& column) const { return (column - meet_x) * per_x; }
  OKTETT_INLINE D at_row(const D& row) const { return (row - meet_z) * per_z; }
  OKTETT_INLINE D height(const D& t) const { return o.y + t * d.y; }

 private:
  /// A direction below this is none: its reciprocal must be finite.
  static constexpr double kTiny = 0x1p-900;

  OKTETT_INLINE static void meet(const D& o, const D& d, std::uint32_t samples, D& at, D& per, M& forward) {
    const auto along = abs(d) < D(kTiny);
    // The middle of its cell.
    at = select(along, cell_of(o, samples) + D(0.5), o);
    per = select(along, D(std::numeric_limits<double>::infinity()), D(1.0) / d);
    forward = along | (D(0.0) < d);
  }
};

/// Up to two crossings of a line with the surface in one cell, in order.
template <class D>
struct CellCrossings {
  typename D::M found[2];
  D t[2], turn[2], part[2];
};

/// Where lines enter and leave a cell: by a line of the grid, in a fixed order where two meet (columns come
/// first), or where the line's height begins or ceases to matter.
template <class D>
struct CellPassage {
  typename D::M passes, by_row_in, by_row_out, cut_in, cut_out;
  D in, out;
};

template <class D>
OKTETT_INLINE CellPassage<D> pass_cell(const GridLines<D>& g, const D& x_in, const D& x_out, const D& z_in,
                                       const D& z_out) {
  CellPassage<D> p;
  p.by_row_in = z_in >= x_in, p.by_row_out = z_out < x_out;
  const D in = select(p.by_row_in, z_in, x_in), out = select(p.by_row_out, z_out, x_out);
  p.passes = (in < out) | ((in == out) & ~p.by_row_in & p.by_row_out);
  p.cut_in = in < g.enter, p.cut_out = g.leave < out;
  p.in = select(p.cut_in, g.enter, in), p.out = select(p.cut_out, g.leave, out);
  p.passes = p.passes & (p.in <= p.out);
  return p;
}

/// The samples at the corners of a cell, or of one cell in each lane: T is double or a vector of them.
template <class T>
struct CellCorners {
  T h00, h10, h01, h11;  ///< h10 is that of the next column

  /// `Index` is std::uint32_t, or T of whole numbers.
  template <class Index>
  OKTETT_INLINE CellCorners(const HeightGrid& grid, const Index& i, const Index& j) {
    const auto place = grid.cell_place(i, j);
    grid.load_pair(place, h00, h10), grid.load_pair(grid.place_below(place), h01, h11);
  }
  OKTETT_INLINE T mean() const { return ((h00 + h10) + (h01 + h11)) * T(0.25); }
};

/// A cell as lines of one quadrant see it, or one in each lane.
template <class T>
struct GridCell {
  T i, j;
  CellCorners<T> corners;
  /// Of `nearest`: its level, and those of the cells from which lines come by a column or a row; beyond the
  /// field there is no cell and no wall, as if it had the same level.
  T level, before_column, before_row;
  T least, greatest;  ///< of the surface in the cell

  OKTETT_INLINE GridCell(const HeightGrid& grid, std::uint32_t column, std::uint32_t row, bool forward_x,
                         bool forward_z)
      : i(column), j(row), corners(grid, column, row) {
    if (grid.interpolation() == HeightInterpolation::nearest) {
      level = before_column = before_row = corners.mean();
      // Numbers without sign: one less than 0 is far beyond the field.
      const std::uint32_t x = forward_x ? column - 1 : column + 1, z = forward_z ? row - 1 : row + 1;
      if (x < grid.columns() - 1) before_column = CellCorners<T>(grid, x, row).mean();
      if (z < grid.rows() - 1) before_row = CellCorners<T>(grid, column, z).mean();
    }
    bound(grid.interpolation());
  }
  /// Cells of the field, in lanes.
  template <class M>
  OKTETT_INLINE GridCell(const HeightGrid& grid, const T& column, const T& row, const M& forward_x,
                         const M& forward_z)
      : i(column), j(row), corners(grid, column, row) {
    if (grid.interpolation() == HeightInterpolation::nearest) {
      level = before_column = before_row = corners.mean();
      const T one(1.0), zero(0.0), last_x(grid.columns() - 2.0), last_z(grid.rows() - 2.0);
      const T x = column + select(forward_x, -one, one), z = row + select(forward_z, -one, one);
      const T x_in = min(max(x, zero), last_x), z_in = min(max(z, zero), last_z);
      before_column = select(x == x_in, CellCorners<T>(grid, x_in, row).mean(), level);
      before_row = select(z == z_in, CellCorners<T>(grid, column, z_in).mean(), level);
    }
    bound(grid.interpolation());
  }

 private:
  OKTETT_INLINE void bound(HeightInterpolation interpolation) {
    if (interpolation == HeightInterpolation::nearest) {
      least = lesser(level, lesser(before_column, before_row));
      greatest = greater(level, greater(before_column, before_row));
    } else {
      least = lesser(lesser(corners.h00, corners.h10), lesser(corners.h01, corners.h11));
      greatest = greater(greater(corners.h00, corners.h10), greater(corners.h01, corners.h11));
    }
  }

  static OKTETT_INLINE double lesser(double a, double b) { return a < b ? a : b; }
  static OKTETT_INLINE double greater(double a, double b) { return a > b ? a : b; }
  template <class D>
  static OKTETT_INLINE D lesser(const D& a, const D& b) {
    return min(a, b);
  }
  template <class D>
  static OKTETT_INLINE D greater(const D& a, const D& b) {
    return max(a, b);
  }
};

template <class D>
OKTETT_INLINE D unit_clamp(const D& x) {
  return min(max(x, D(0.0)), D(1.0));
}
template <class D>
OKTETT_INLINE D between(const D& a, const D& b, const D& share) {
  return a + share * (b - a);
}

/// Height of a patch at (u, v) in its cell.
template <class D, class T>
OKTETT_INLINE D patch_height(HeightInterpolation interpolation, const CellCorners<T>& c, const D& u,
                             const D& v) {
  const D h00(c.h00), h10(c.h10), h01(c.h01), h11(c.h11);
  if (interpolation == HeightInterpolation::bilinear)
    return between(between(h00, h10, u), between(h01, h11, u), v);
  const D u1 = D(1.0) - u, v1 = D(1.0) - v;
  return select(u + v <= D(1.0), h00 + (u * (h10 - h00) + v * (h01 - h00)),
                h11 + (u1 * (h01 - h11) + v1 * (h10 - h11)));
}

/// Where a straight line from (t0, f0) to (t1, f1) has its zero, given that f0 and f1 differ in sign.
template <class D>
OKTETT_INLINE D straight_zero(const D& t0, const D& f0, const D& t1, const D& f1) {
  return t0 + (t1 - t0) * unit_clamp(f0 / (f0 - f1));
}

/// -1 where the line enters the inside: it was above.
template <class D>
OKTETT_INLINE D turn_from(const D& before) {
  return select(before < D(0.0), D(1.0), D(-1.0));
}

/// Heights of the surface and their derivatives by column and row, of samples as stored.
template <class D>
struct HeightPatch {
  D height, by_x, by_z;

  OKTETT_INLINE HeightPatch(const HeightGrid& grid, const D& x, const D& z) {
    const D i = cell_of(x, grid.columns()), j = cell_of(z, grid.rows());
    const CellCorners<D> c(grid, i, j);
    const D u = unit_clamp(x - i), v = unit_clamp(z - j);
    if (grid.interpolation() == HeightInterpolation::nearest) {
      height = c.mean(), by_x = by_z = D(0.0);
      return;
    }
    height = patch_height(grid.interpolation(), c, u, v);
    if (grid.interpolation() == HeightInterpolation::triangles) {
      const auto low = u + v <= D(1.0);
      by_x = select(low, c.h10 - c.h00, c.h11 - c.h01), by_z = select(low, c.h01 - c.h00, c.h11 - c.h10);
    } else {
      by_x = between(c.h10 - c.h00, c.h11 - c.h01, v), by_z = between(c.h01 - c.h00, c.h11 - c.h10, u);
    }
  }
};

namespace height {

/// The line's height above the surface at t on the edge at column or row `line` of the cell (i, j).
template <class D, class T>
OKTETT_INLINE D above_column(const GridLines<D>& g, const D& h0, const D& h1, const T& j, const D& t) {
  return g.height(t) - between(h0, h1, unit_clamp((g.o.z + t * g.d.z) - D(j)));
}
template <class D, class T>
OKTETT_INLINE D above_row(const GridLines<D>& g, const D& h0, const D& h1, const T& i, const D& t) {
  return g.height(t) - between(h0, h1, unit_clamp((g.o.x + t * g.d.x) - D(i)));
}

template <class D, class T>
OKTETT_INLINE void triangle_crossings(const GridLines<D>& g, const GridCell<T>& cell, const CellPassage<D>& p,
                                      const D& f0, const D& f1, CellCrossings<D>& out) {
  const CellCorners<T>& c = cell.corners;
  // The common edge has column + row = i + j + 1.
  const D zero(0.0), t = (D(cell.i + cell.j + T(1.0)) - (g.o.x + g.o.z)) / (g.d.x + g.d.z);
  const auto bends = (p.in < t) & (t < p.out);
  const D f = above_column(g, D(c.h10), D(c.h01), cell.j, t);
  const auto low0 = f0 < zero, low = f < zero, low1 = f1 < zero;
  const auto differ = [](const auto& a, const auto& b) { return (a & ~b) | (b & ~a); };
  out.found[0] = differ(low0, low) & bends;
  out.found[1] = (differ(low, low1) & bends) | (differ(low0, low1) & ~bends);
  out.t[0] = straight_zero(p.in, f0, t, f), out.turn[0] = turn_from(f0);
  out.t[1] = straight_zero(select(bends, t, p.in), select(bends, f, f0), p.out, f1);
  out.turn[1] = -turn_from(f1);
}

/// With s = 0 ... 1 from where the line enters to where it leaves, its height above the patch is
/// a s^2 + (f1 - f0 - a) s + f0.
template <class D, class T>
OKTETT_INLINE void bilinear_crossings(const GridLines<D>& g, const CellCorners<T>& c, const CellPassage<D>& p,
                                      const D& f0, const D& f1, CellCrossings<D>& out) {
  const D zero(0.0), length = p.out - p.in;
  const auto below = f0 < zero, low1 = f1 < zero;
  const auto differ = (below & ~low1) | (low1 & ~below);
  // As seen from above: turned over where the line starts below.
  const auto seen = [&](const D& x) { return select(below, -x, x); };
  const D twist((c.h00 + c.h11) - (c.h10 + c.h01));
  const D a = seen(-(twist * ((g.d.x * length) * (g.d.z * length)))), c0 = seen(f0);
  const D b = (seen(f1) - c0) - a, discriminant = b * b - D(4.0) * (a * c0);
  const D root = sqrt(max(discriminant, zero)), half(0.5);
  // b < 0: q > 0 has the greater root in q / a and the lesser one in c0 / q. Otherwise a < 0 and the only
  // positive root is the other one.
  const auto falls = b < zero;
  const D q = select(falls, (root - b) * half, (b + root) * D(-0.5));
  const D lesser = c0 / q, greater = q / a;
  out.found[1] = ~differ & falls & (zero < a) & (-b < a + a) & (zero < discriminant);
  out.found[0] = differ | out.found[1];
  const D first = unit_clamp(select(falls, lesser, greater)), second = max(unit_clamp(greater), first);
  out.t[0] = p.in + length * first, out.t[1] = p.in + length * second;
  out.turn[0] = turn_from(f0), out.turn[1] = -out.turn[0];
}

}  // namespace height

/// Crossings of lines with the surface in a cell, which they pass as `p` says.
template <class D, class T>
OKTETT_INLINE void patch_crossings(HeightInterpolation interpolation, const GridLines<D>& g,
                                   const GridCell<T>& cell, const CellPassage<D>& p, CellCrossings<D>& out) {
  // Where lines go back, they enter by the far edges.
  const CellCorners<T>& c = cell.corners;
  const D h00(c.h00), h10(c.h10), h01(c.h01), h11(c.h11);
  const auto edge = [&](const typename D::M& by_row, const typename D::M& low_x, const typename D::M& low_z,
                        const D& t) {
    const D on_column = height::above_column(g, select(low_x, h00, h10), select(low_x, h01, h11), cell.j, t);
    const D on_row = height::above_row(g, select(low_z, h00, h01), select(low_z, h10, h11), cell.i, t);
    return select(by_row, on_row, on_column);
  };
  const auto inner = [&](const D& t) {
    const D u = unit_clamp((g.o.x + t * g.d.x) - D(cell.i)), v = unit_clamp((g.o.z + t * g.d.z) - D(cell.j));
    return g.height(t) - patch_height(interpolation, c, u, v);
  };
  D f0 = edge(p.by_row_in, g.forward_x, g.forward_z, p.in);
  D f1 = edge(p.by_row_out, ~g.forward_x, ~g.forward_z, p.out);
  if (any(p.cut_in | p.cut_out)) {
    f0 = select(p.cut_in, inner(p.in), f0);
    f1 = select(p.cut_out, inner(p.out), f1);
  }
  if (interpolation == HeightInterpolation::triangles)
    height::triangle_crossings(g, cell, p, f0, f1, out);
  else
    height::bilinear_crossings(g, c, p, f0, f1, out);
  out.part[0] = out.part[1] = D(0.0);
}

/// The same for `nearest`: first the wall by which lines enter, then the level.
template <class D, class T>
OKTETT_INLINE void step_crossings(const GridLines<D>& g, const GridCell<T>& cell, const CellPassage<D>& p,
                                  CellCrossings<D>& out) {
  const D zero(0.0), here(cell.level);
  const D before = select(p.by_row_in, D(cell.before_row), D(cell.before_column));
  const D y0 = g.height(p.in), f_before = y0 - before, f0 = y0 - here, f1 = g.height(p.out) - here;
  const auto low = f_before < zero, low0 = f0 < zero, low1 = f1 < zero;
  out.found[0] = ~p.cut_in & ((low & ~low0) | (low0 & ~low));
  out.found[1] = (low0 & ~low1) | (low1 & ~low0);
  out.t[0] = p.in, out.turn[0] = turn_from(f_before);
  out.t[1] = straight_zero(p.in, f0, p.out, f1), out.turn[1] = turn_from(f0);
  // A wall that is entered faces the ray.
  const auto enters = out.turn[0] < zero;
  const auto faces_low = [&](const typename D::M& forward) {
    return (enters & forward) | (~enters & ~forward);
  };
  out.part[0] = select(p.by_row_in, select(faces_low(g.forward_z), D(kWallLowZ), D(kWallHighZ)),
                       select(faces_low(g.forward_x), D(kWallLowX), D(kWallHighX)));
  out.part[1] = zero;
}

}  // namespace oktett
