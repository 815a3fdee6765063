#pragma once
/// \file Functions of x, y and z inside of a box, solved by intervals along the ray
/// (kernels/exact/march.h; D. P. Mitchell: Robust ray intersection with interval arithmetic, 1990), in cells
/// in which parts of the function do not matter (implicit_cells.h).

#include <memory>

#include "kernels/exact/implicit_cells.h"
#include "kernels/exact/implicit_data.h"
#include "kernels/exact/march.h"
#include "kernels/exact/stride.h"
#include "kernels/functions/function_tape.h"

namespace oktett {

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
