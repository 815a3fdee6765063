#pragma once
/// \file Functions of x, y and z inside of a box, solved by intervals along the ray
/// (kernels/exact/march.h; D. P. Mitchell: Robust ray intersection with interval arithmetic, 1990).

#include <memory>

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
  /// In the function's own variables; elements that follow each other share that of the same function.
  std::shared_ptr<const VariationGrid> grid;
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
    // The box may be entered and left as well.
    constexpr int kOwn = K > 2 ? K - 2 : K;
    const D size(e.size), zero(0.0), length = range.b - range.a;
    const auto place = [&](const D& o, const D& d) { return (o + range.a * d) * size; };
    const FunctionField<D> field{
        e.function,
        {place(line.o.x, line.d.x), place(line.o.y, line.d.y), place(line.o.z, line.d.z)},
        {line.d.x * size, line.d.y * size, line.d.z * size}};
    Crossings<kOwn, D> own;
    D sign;
    if (K > 1 || e.grid->cells.empty()) {
      sign = march(field, range.a, length, active, own);
    } else if constexpr (K == 1) {
      const auto enters = e.open ? ~active & active : range.enter_face > zero;
      const auto rest = first_by_strides(*e.grid, field, range.a, length, enters, active, own, sign);
      if (any(rest)) {
        Crossings<1, D> found;
        sign = select(rest, march(field, range.a, length, rest, found), sign);
        select_crossings(rest, found, own);
      }
    }
    if (!e.open) return close_by_cell(own, sign < zero, range, active, out);
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
    const Gradient<D> f = slope_of<Walls::flat>(e, p);
    value = f.v, gradient = f.d;
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
  OKTETT_NOINLINE static D march(const FunctionField<D>& field, const D& begin, const D& length,
                                 const typename D::M& active, Crossings<K, D>& out) {
    const D sign =
        interval::march<K>(field, D(0.0), length, length, active, interval::Jumps::list_steep, out);
    place_crossings(out, [&](const D& s) { return begin + s; });
    return sign;
  }

  template <Walls W, class D>
  OKTETT_INLINE static Gradient<D, W> slope_of(const ImplicitElement& e, const Vec3<D>& p) {
    const D size(e.size), zero(0.0);
    using T = Gradient<D, W>;
    return run_tape(e.function, T{p.x * size, {size, zero, zero}}, T{p.y * size, {zero, size, zero}},
                    T{p.z * size, {zero, zero, size}});
  }

  /// The normal of a wall, to the side where the function is not negative; zero where that is not to be told.
  template <class D>
  OKTETT_NOINLINE static Vec3<D> wall_normal(const ImplicitElement& e, const Vec3<D>& p) {
    const Vec3<D> d = slope_of<Walls::steep>(e, p).d;
    const D zero(0.0), greatest = max(max(abs(d.x), abs(d.y)), abs(d.z));
    // What is infinite or NaN tells nothing.
    const auto known = (zero < greatest) & (abs(d.x) + abs(d.y) + abs(d.z) < Interval<D>::infinity());
    const D per = select(known, D(1.0) / greatest, zero);
    const auto unit = [&](const D& x) { return select(known, x * per, zero); };
    const Vec3<D> n{unit(d.x), unit(d.y), unit(d.z)};
    const auto inside_at = [&](double by) {
      const D h(by);
      return slope_of<Walls::flat>(e, Vec3<D>{p.x + n.x * h, p.y + n.y * h, p.z + n.z * h}).v < zero;
    };
    const auto ahead = inside_at(0x1p-22), behind = inside_at(-0x1p-22);
    const D way = select(behind & ~ahead, D(1.0), select(ahead & ~behind, D(-1.0), zero));
    return {n.x * way, n.y * way, n.z * way};
  }
};

}  // namespace oktett
