#pragma once
/// \file The ways of single lines over the cells of a height field, and what they share with that of many
/// lines (height_pyramid.h). Each way visits, in the order of the line, all cells in which height_cell.h may
/// find a crossing, so all find the same ones.

#include "kernels/heights/height_cell.h"

namespace oktett {

/// Looks for crossings at t > begin in the lanes of `wanted`, and stops where t > end.
template <int K, class D>
struct HeightSearch {
  using M = typename D::M;
  const HeightGrid& grid;
  const GridLines<D>& g;
  D begin, end;
  M wanted;
  CrossingList<K, D> list;
  D left_out = D(0.0);  ///< the first crossing that the list has no room for
  D from, to;           ///< begin and end, and where the line's height matters

  OKTETT_INLINE HeightSearch(const HeightGrid& heights, const GridLines<D>& lines, const D& first,
                             const D& last, const M& active, Crossings<K, D>& out)
      : grid(heights),
        g(lines),
        begin(first),
        end(last),
        wanted(active),
        list(out),
        from(max(first, lines.enter)),
        to(min(last, lines.leave)) {
    wanted = wanted & (from <= to);
  }

  /// A cell, passed as `p` says. Cells that lines enter behind their ends are left out: crossings before
  /// these cells may have been left out, too.
  template <class T>
  OKTETT_INLINE void look(const GridCell<T>& cell, const M& lanes, const CellPassage<D>& p) {
    CellCrossings<D> c;
    if (grid.interpolation() == HeightInterpolation::nearest)
      step_crossings(g, cell, p, c);
    else
      patch_crossings(grid.interpolation(), g, cell, p, c);
    const M here = lanes & p.passes & (p.in <= to);
    for (int k = 0; k < 2; ++k) {
      const M found = here & c.found[k] & (begin < c.t[k]);
      if constexpr (K > 1) left_out = select(found & (list.count == D(K)), c.t[k], left_out);
      list.push(found, c.t[k], c.turn[k], c.part[k]);
    }
    // One more than there is room for tells that the list ends early; nobody asks that of a single one.
    wanted = wanted & (list.count < D(K > 1 ? K + 1 : 1));
  }
  /// Ends the list. Two walls that meet in a corner are crossed at one t: both are listed or none.
  OKTETT_INLINE void finish() {
    list.finish(D(roots::kNoRoot));
    if constexpr (K > 1) {
      const M full = list.count > D(K);
      if (none(full)) return;
      for (int k = K; k-- > 1;) {
        const M parted = full & (list.out.t[k] == left_out);
        list.out.t[k] = select(parted, D(roots::kNoRoot), list.out.t[k]);
        list.out.up_to = select(parted, list.out.t[k - 1], list.out.up_to);
      }
    }
  }
  /// Whether lines between the heights y0 and y1 may meet what lies between `least` and `greatest`.
  template <class T>
  OKTETT_INLINE M meets(const D& y0, const D& y1, const T& least, const T& greatest) const {
    return (D(least) <= max(y0, y1) + g.noise) & (min(y0, y1) - g.noise <= D(greatest));
  }
};

/// What walks of a single line share. A lone lane is a number.
template <int K, class D>
struct LineWalk {
  static_assert(D::kWidth == 1);
  using M = typename D::M;
  HeightSearch<K, D>& s;
  const GridLines<D>& g;
  const int columns, rows;  ///< of cells
  const bool forward_x, forward_z;

  explicit OKTETT_INLINE LineWalk(HeightSearch<K, D>& search)
      : s(search),
        g(search.g),
        columns(static_cast<int>(s.grid.columns()) - 1),
        rows(static_cast<int>(s.grid.rows()) - 1),
        forward_x(any(g.forward_x)),
        forward_z(any(g.forward_z)) {}

  static OKTETT_INLINE double value(const D& x) { return x.part[0].v; }
  /// Where the line meets column c; the same for rows.
  OKTETT_INLINE double column(int c) const { return value(g.at_column(D(c))); }
  OKTETT_INLINE double row(int r) const { return value(g.at_row(D(r))); }
  OKTETT_INLINE double column_in(int i) const { return column(forward_x ? i : i + 1); }
  OKTETT_INLINE double column_out(int i) const { return column(forward_x ? i + 1 : i); }
  OKTETT_INLINE double row_in(int j) const { return row(forward_z ? j : j + 1); }
  OKTETT_INLINE double row_out(int j) const { return row(forward_z ? j + 1 : j); }
  OKTETT_INLINE bool in_field(int i, int j) const { return i >= 0 && i < columns && j >= 0 && j < rows; }

  /// The cell in which the line is at `from`.
  OKTETT_INLINE void start(int& i, int& j) const {
    const double t = value(s.from);
    i = near(value(g.meet_x) + t * (value(g.per_x) < kInf ? value(g.d.x) : 0), columns);
    j = near(value(g.meet_z) + t * (value(g.per_z) < kInf ? value(g.d.z) : 0), rows);
    const int x = forward_x ? 1 : -1, z = forward_z ? 1 : -1;
    while (i - x >= 0 && i - x < columns && column_in(i) > t) i -= x;
    while (i + x >= 0 && i + x < columns && column_out(i) < t) i += x;
    while (j - z >= 0 && j - z < rows && row_in(j) > t) j -= z;
    while (j + z >= 0 && j + z < rows && row_out(j) < t) j += z;
  }

  /// Whether a line between the heights y0 and y1 may meet the surface in a cell.
  OKTETT_INLINE bool may_meet(const GridCell<double>& cell, double y0, double y1) const {
    return any(s.meets(D(y0), D(y1), cell.least, cell.greatest));
  }
  OKTETT_INLINE GridCell<double> cell(int i, int j) const {
    return {s.grid, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), forward_x, forward_z};
  }
  OKTETT_INLINE double height(double t) const { return value(g.height(D(t))); }

 private:
  static constexpr double kInf = std::numeric_limits<double>::infinity();
  static OKTETT_INLINE int near(double x, int cells) {
    return x >= 1 ? (x < cells ? static_cast<int>(x) : cells - 1) : 0;
  }
};

/// Cell by cell (Zachmann 2010).
template <int K, class D>
OKTETT_INLINE void walk_cells(HeightSearch<K, D>& search) {
  if (none(search.wanted)) return;
  const LineWalk<K, D> w(search);
  const double from = w.value(search.from), to = w.value(search.to);
  int i, j;
  w.start(i, j);
  double x_in = w.column_in(i), z_in = w.row_in(j), x_out = w.column_out(i), z_out = w.row_out(j);
  double in = from;
  while (in <= to && any(search.wanted) && w.in_field(i, j)) {
    const bool by_row = z_out < x_out;
    const double out = by_row ? z_out : x_out;
    const GridCell<double> cell = w.cell(i, j);
    if (w.may_meet(cell, w.height(in), w.height(out < to ? out : to)))
      search.look(cell, search.wanted, pass_cell(w.g, D(x_in), D(x_out), D(z_in), D(z_out)));
    if (by_row)
      j += w.forward_z ? 1 : -1, z_in = z_out, z_out = w.row_out(j);
    else
      i += w.forward_x ? 1 : -1, x_in = x_out, x_out = w.column_out(i);
    in = out > from ? out : from;
  }
}

/// By spans: the cells that a line passes between two grid lines across its lesser direction. With
/// m = |lesser / greater| <= 1 they are floor(1 / m) or one more, which is decided by where the line meets
/// the first of them (C. Henning, P. Stephenson: Accelerating the Ray Tracing of Height Fields, GRAPHITE
/// 2004; Zachmann 2010). Here a decision that rounding may have changed is made by the lines of the grid
/// themselves, and the heights of the cells of a span are compared with the line in groups of up to kGroup.
template <int K, class D, bool kAlongX>
class SpanWalk {
 public:
  explicit OKTETT_INLINE SpanWalk(HeightSearch<K, D>& search) : w_(search), s_(search) {}

  OKTETT_INLINE void run() {
    int i, j;
    w_.start(i, j);
    int along = kAlongX ? i : j, across = kAlongX ? j : i;
    const int step_along = forward_along() ? 1 : -1, step_across = forward_across() ? 1 : -1;
    const double slope =
        __builtin_fabs(w_.value(kAlongX ? w_.g.d.z : w_.g.d.x) / w_.value(kAlongX ? w_.g.d.x : w_.g.d.z));
    // Longer than the field is endless.
    const double most = cells_along();
    const bool endless = !(slope * most > 1);
    const int r = endless ? 0 : static_cast<int>(1 / slope);
    const double beta = 1 - slope * r, doubt = doubtful();
    double b = -1, in = w_.value(s_.from);
    const double to = w_.value(s_.to);
    while (in <= to && any(s_.wanted) && in_field(along, across)) {
      const double out = across_out(across);
      int last;
      // Near the corner of a cell rounding might decide.
      if (b > doubt && b < slope - doubt && __builtin_fabs(b - beta) > doubt) {
        const bool is_short = b > beta;
        last = along + step_along * (is_short ? r : r + 1);
        b += is_short ? -beta : slope - beta;
      } else {
        last = cell_at(along, out, step_along);
        b = endless ? -1 : offset_after(last, out, slope);
      }
      span(along, last, across, in, out < to ? out : to, step_along);
      along = last, across += step_across;
      in = out > in ? out : in;
    }
  }

 private:
  static constexpr int kGroup = 8;

  OKTETT_INLINE bool forward_along() const { return kAlongX ? w_.forward_x : w_.forward_z; }
  OKTETT_INLINE bool forward_across() const { return kAlongX ? w_.forward_z : w_.forward_x; }
  OKTETT_INLINE double along_out(int c) const { return kAlongX ? w_.column_out(c) : w_.row_out(c); }
  OKTETT_INLINE double across_out(int c) const { return kAlongX ? w_.row_out(c) : w_.column_out(c); }
  OKTETT_INLINE int cells_along() const { return kAlongX ? w_.columns : w_.rows; }
  OKTETT_INLINE bool in_field(int along, int across) const {
    return kAlongX ? w_.in_field(along, across) : w_.in_field(across, along);
  }

  /// Where the line is, in cells along, when it leaves a span at t.
  OKTETT_INLINE double place(double t) const {
    return w_.value(kAlongX ? w_.g.o.x : w_.g.o.z) + t * w_.value(kAlongX ? w_.g.d.x : w_.g.d.z);
  }
  /// A bound on the error of `b`: that of places on the line, and what adding up may make of it in the
  /// longest of walks.
  OKTETT_INLINE double doubtful() const {
    const D reach = abs(w_.g.o.x) + abs(w_.g.o.z) + D(kMaxHeightSide);
    return w_.value(reach) * 0x1p-36;
  }
  /// The cell in which the line is at `out`, after it has come to cell `along`; one beyond the field at most.
  /// Where two lines of the grid meet, columns come first.
  OKTETT_INLINE int cell_at(int along, double out, int step) const {
    const double p = place(out), most = cells_along();
    int last = static_cast<int>(p > -1 ? (p < most ? __builtin_floor(p) : most) : -1);
    if ((last - along) * step < 0) last = along;
    const auto left = [&](int c) { return kAlongX ? along_out(c) <= out : along_out(c) < out; };
    while (last >= 0 && last < cells_along() && left(last)) last += step;
    while (last != along && !left(last - step)) last -= step;
    return last;
  }
  /// How far the line is above the lower edge of its row, where it enters the first cell after `last`.
  OKTETT_INLINE double offset_after(int last, double out, double slope) const {
    const double p = place(out), edge = forward_along() ? last + 1.0 - p : p - last;
    const double b = slope * edge;
    return b > 0 ? (b < slope ? b : slope) : 0;
  }
  /// Extremes of the two samples at one end of a row of cells.
  struct Pair {
    double least, greatest;
  };
  OKTETT_INLINE Pair pair(int along, int across) const {
    const auto a = static_cast<std::uint32_t>(along), b = static_cast<std::uint32_t>(across);
    const double p = kAlongX ? s_.grid.at(a, b) : s_.grid.at(b, a);
    const double q = kAlongX ? s_.grid.at(a, b + 1) : s_.grid.at(b + 1, a);
    return p < q ? Pair{p, q} : Pair{q, p};
  }

  /// The cells from `along` to `last`, between t = in and t = out.
  OKTETT_INLINE void span(int along, int last, int across, double in, double out, int step) {
    const int end = last + step, near = step > 0 ? 0 : 1;
    const bool steps = s_.grid.interpolation() == HeightInterpolation::nearest;
    const double noise = w_.value(w_.g.noise);
    double y0 = w_.height(in);
    Pair before = pair(along + near, across);
    while (along != end && in <= out) {
      int group = (end - along) * step;
      if (group > kGroup) group = kGroup;
      double next = out;
      if (along + step * group != end) {
        const double left = along_out(along + step * (group - 1));
        next = left < out ? left : out;
      }
      const double y1 = w_.height(next);
      const double low = (y0 < y1 ? y0 : y1) - noise, high = (y0 < y1 ? y1 : y0) + noise;
      for (int k = 0; k < group; ++k, along += step) {
        if (along < 0 || along >= cells_along()) return;
        const Pair after = pair(along + 1 - near, across);
        const double least = before.least < after.least ? before.least : after.least;
        const double greatest = before.greatest > after.greatest ? before.greatest : after.greatest;
        before = after;
        // A step may have walls to where its own corners do not reach.
        if (!steps && (least > high || greatest < low)) continue;
        look(along, across, y0, y1);
        if (none(s_.wanted)) return;
      }
      in = next > in ? next : in, y0 = y1;
    }
  }

  OKTETT_INLINE void look(int along, int across, double y0, double y1) {
    const int i = kAlongX ? along : across, j = kAlongX ? across : along;
    const GridCell<double> cell = w_.cell(i, j);
    if (w_.may_meet(cell, y0, y1))
      s_.look(cell, s_.wanted,
              pass_cell(w_.g, D(w_.column_in(i)), D(w_.column_out(i)), D(w_.row_in(j)), D(w_.row_out(j))));
  }

  const LineWalk<K, D> w_;
  HeightSearch<K, D>& s_;
};

template <int K, class D>
OKTETT_INLINE void walk_spans(HeightSearch<K, D>& search) {
  if (none(search.wanted)) return;
  const D inf(std::numeric_limits<double>::infinity());
  if (any((search.g.per_x == inf) & (search.g.per_z == inf))) return walk_cells(search);
  if (any(abs(search.g.d.z) <= abs(search.g.d.x)))
    SpanWalk<K, D, true>(search).run();
  else
    SpanWalk<K, D, false>(search).run();
}

}  // namespace oktett
