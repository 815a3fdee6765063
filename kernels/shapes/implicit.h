#pragma once
/// \file Functions of x, y and z inside of a box, solved by intervals along the ray
/// (kernels/interval/march.h; D. P. Mitchell: Robust ray intersection with interval arithmetic, 1990).

#include "kernels/function_tape.h"
#include "kernels/interval/march.h"

namespace oktett {

struct ImplicitElement {
  FunctionTape function;
  double size;  ///< a power of two: so many units of the function's are 1 in the own space
  bool open;
  Vec3d lo, hi;
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
};

/// Parts: 0 the surface, 1 to 6 the faces of the box, kJumpPart where the function jumps.
struct Implicit {
  using Data = ImplicitShape;
  using Pool = ExactPool<ImplicitElement>;
  static constexpr int kMaxCrossings = 18;

  static void add(Pool& pool, const ExactShape& shape, const Affine& to_world, std::uint32_t item);

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
    const D sign = interval::march<kOwn>(field, zero, length, length, active, interval::Jumps::list, own);
    const auto to_t = [&](const D& s) { return select(s < D(roots::kNoRoot), range.a + s, s); };
    for (int k = 0; k < kOwn; ++k) own.t[k] = to_t(own.t[k]);
    own.up_to = to_t(own.up_to);
    if (!e.open) return close_by_cell(own, sign < zero, range, active, out);
    CrossingList<K, D> list(out);
    for (int k = 0; k < kOwn; ++k)
      list.push(own.t[k] < D(roots::kNoRoot), own.t[k], own.turn[k], own.part[k]);
    list.finish(own.up_to);
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const ImplicitElement& e = pool.elements[i];
    const D size(e.size), zero(0.0);
    const Gradient<D> f =
        run_tape(e.function, Gradient<D>{p.x * size, {size, zero, zero}},
                 Gradient<D>{p.y * size, {zero, size, zero}}, Gradient<D>{p.z * size, {zero, zero, size}});
    // No slope tells of where a wall is, nor which way it faces.
    const auto wall = part == D(interval::kJumpPart);
    value = f.v;
    gradient = {select(wall, zero, f.d.x), select(wall, zero, f.d.y), select(wall, zero, f.d.z)};
    select_faces(e.lo, e.hi, select(wall, zero, part), p, value, gradient);
  }
  /// NaN where the function is not defined.
  static double value(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static Vec3d gradient(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// None.
  static void uv(const Pool& pool, std::size_t i, int part, const Vec3d& p, Surface& s);
};

}  // namespace oktett
