#pragma once
/// \file What an exact surface is to the tracer: a shape whose crossings with a ray are found by solving an
/// equation in double, several rays in lanes.
///
/// An element lives in its own space, which it chooses so that it is about 1 in size and about the origin,
/// and is looked for inside of *cells*, boxes of that space: one as a rule, several where that spares work
/// (then each may point to the parts of the element that matter in it). Cells are what the leaves of the tree
/// hold. What is found depends on the ray and the cell only, never on how near other hits are, so that every
/// order of visits finds the same bits.
///
/// A surface S (one header and one source file each, and one line in surfaces.def) has
/// - `S::Data`: what describes it, in a header of its own (e.g. torus_data.h);
/// - `S::Pool`: an ExactPool of its elements; `S::add(pool, data, place)` appends an element with its frame
///   and cells, or nothing if the shape is degenerate;
/// - `S::kMaxCrossings`: room for all crossings with a line, or as many as are listed at a time;
/// - `S::crossings<K>(pool, cell, line, range, active, out)`: the first K crossings, see Crossings;
/// - `S::slope(pool, i, part, p, value, gradient)` in lanes: the function whose zeros the part is, negative
///   inside, and its gradient. Or `S::slope_at(pool, i, part, p)`, which returns both as a Slope for one
///   point; then the interactions of its hits are found one by one.
/// It may have
/// - `S::inside(pool, i, p)`, where what is inside is not the points of the element's box `lo`, `hi` (if it
///   has one) at which the function of part 0 is negative;
/// - `S::uv(pool, i, part, p)`: texture coordinates as functions in its own space;
/// - `S::kOneCell`: each element is one cell, and its crossings are listed as they are. Without it an
///   element may have several cells. Two cells that meet may both list the crossing there, so the lists are
///   merged;
/// - `S::kSheets`: what goes in need not come out, as of surfaces that are not closed. Of the lists of cells
///   only those crossings are merged that are the same one;
/// - `S::kWholeLines`: its only cell is no more than bounds. The range is not cut to the cell then, only to
///   where the ray begins; `crossings` bears NaN and infinities;
/// - `S::kLoneLanes`: a ray on its own is traced as numbers rather than in one of many lanes;
/// - `S::kStopsAtLimit`: crossings up to some t do not depend on where the range ends, which then is where
///   the ray does;
/// - `S::is_smooth(pool, i)`, `S::smooth_gradient(pool, i, part, p)`: whether light falls by another
/// gradient,
///   and that gradient;
/// - `S::interaction(pool, i, ray, hit)` in place of slope and uv: a fractal (fractal.h);
/// - `S::world_bounds(pool, i)`: bounds of element i in the world, its only cell's, where they can be tighter
///   than the image of the cell;
/// - `S::closest(pool, i, to_world, p)` and `S::is_kept_by(to_world)`: see ExactOps.

#include <limits>

#include "core/lanes.h"
#include "core/ray.h"
#include "core/surface_interaction.h"
#include "kernels/exact/exact_pool.h"
#include "kernels/exact/surface_uv.h"
#include "kernels/roots/roots.h"

namespace oktett {

/// The points o + t d in an element's own space. d is the ray's direction, not normalised: t means the same
/// as in the world.
template <class D>
struct Line {
  Vec3<D> o, d;
};

/// Where on the line to look: a <= t <= b, the part inside the cell. A face is 1 + 2 axis + side (side 1 =
/// high) where the line enters or leaves the cell at a or b, 0 where the ray itself begins.
template <class D>
struct LineRange {
  D a, b;
  D enter_face, exit_face;
};

/// Crossings of a line with the surface in ascending order, kNoRoot where there are no more. `turn` is -1
/// where the line enters the inside (the function falls) and 1 where it leaves. `part` is what part of the
/// surface was met: 0 or as the shape says. Only lanes that are asked for hold anything valid.
template <int K, class D>
struct Crossings {
  D t[K], turn[K], part[K];
  /// All crossings below this are listed; at least b unless K was too few.
  D up_to;

  OKTETT_INLINE void clear() {
    for (int k = 0; k < K; ++k) t[k] = D(roots::kNoRoot), turn[k] = part[k] = D(0.0);
    up_to = D(roots::kNoRoot);
  }
};

/// Takes the crossings of `from` in the lanes of `where`.
template <int K, class D>
OKTETT_INLINE void select_crossings(const typename D::M& where, const Crossings<K, D>& from,
                                    Crossings<K, D>& out) {
  for (int k = 0; k < K; ++k) {
    out.t[k] = select(where, from.t[k], out.t[k]);
    out.turn[k] = select(where, from.turn[k], out.turn[k]);
    out.part[k] = select(where, from.part[k], out.part[k]);
  }
  out.up_to = select(where, from.up_to, out.up_to);
}

/// Turns the places of crossings and their end into distances by to_t.
template <int K, class D, class F>
OKTETT_INLINE void place_crossings(Crossings<K, D>& list, const F& to_t) {
  const D none(roots::kNoRoot);
  for (int k = 0; k < K; ++k) list.t[k] = select(list.t[k] < none, to_t(list.t[k]), none);
  list.up_to = select(list.up_to < none, to_t(list.up_to), none);
}

/// Crossings in columns of numbers, for what finds them one lane after the other. They begin as empty lists,
/// or as those of `from`.
template <int K, class D>
struct CrossingColumns {
  static constexpr int W = D::kWidth;
  double t[K][W], turn[K][W], part[K][W], up_to[W];

  CrossingColumns() {
    Crossings<K, D> none;
    none.clear();
    *this = CrossingColumns(none);
  }
  explicit CrossingColumns(const Crossings<K, D>& from) {
    for (int k = 0; k < K; ++k)
      from.t[k].store(t[k]), from.turn[k].store(turn[k]), from.part[k].store(part[k]);
    from.up_to.store(up_to);
  }
  void load(Crossings<K, D>& out) const {
    for (int k = 0; k < K; ++k)
      out.t[k] = D::load(t[k]), out.turn[k] = D::load(turn[k]), out.part[k] = D::load(part[k]);
    out.up_to = D::load(up_to);
  }
};

/// Fills a list of crossings from the front.
template <int K, class D>
struct CrossingList {
  Crossings<K, D>& out;
  D count = D(0.0);

  explicit OKTETT_INLINE CrossingList(Crossings<K, D>& list) : out(list) { out.clear(); }
  /// Appends one in the lanes of `where` that have room.
  OKTETT_INLINE void push(const typename D::M& where, const D& t, const D& turn, const D& part) {
    // Long lists have few entries.
    if (K > 8 && none(where)) return;
    for (int k = 0; k < K; ++k) {
      const auto here = where & (count == D(k));
      out.t[k] = select(here, t, out.t[k]);
      out.turn[k] = select(here, turn, out.turn[k]);
      out.part[k] = select(here, part, out.part[k]);
    }
    count = select(where, count + D(1.0), count);
  }
  /// All crossings below `up_to` have been pushed; where there was no room for all, the list ends earlier.
  OKTETT_INLINE void finish(const D& up_to) { out.up_to = select(count > D(K), out.t[K - 1], up_to); }
};

/// Crossings of what is inside of both a surface and its cell: the faces of the cell close it. `open` are the
/// crossings of the surface alone, `starts_inside` the lanes in which the function is negative at range.a
/// (asked only where there is no crossing to tell).
template <int K, int M, class D>
OKTETT_INLINE void close_by_cell(const Crossings<M, D>& open, const typename D::M& starts_inside,
                                 const LineRange<D>& range, const typename D::M& active,
                                 Crossings<K, D>& out) {
  CrossingList<K, D> list(out);
  const auto crosses = open.t[0] < D(roots::kNoRoot);
  auto inside = active & ((crosses & (open.turn[0] > D(0.0))) | (~crosses & starts_inside));
  list.push(inside & (range.enter_face > D(0.0)), range.a, D(-1.0), range.enter_face);
  for (int i = 0; i < M; ++i) {
    const auto found = active & (open.t[i] < D(roots::kNoRoot));
    list.push(found, open.t[i], open.turn[i], open.part[i]);
    inside = (found & (open.turn[i] < D(0.0))) | (~found & inside);
  }
  list.push(inside & (open.up_to >= range.b) & (range.exit_face > D(0.0)), range.b, D(1.0), range.exit_face);
  list.finish(open.up_to);
}

/// The distance of p from a face of a cell, negative inside; and its gradient.
inline double face_value(const Vec3d& lo, const Vec3d& hi, int face, const Vec3d& p) {
  const int axis = (face - 1) / 2;
  return (face - 1) % 2 == 1 ? p[axis] - hi[axis] : lo[axis] - p[axis];
}
OKTETT_INLINE Vec3d face_gradient(int face) {
  Vec3d g{0, 0, 0};
  g[(face - 1) / 2] = (face - 1) % 2 == 1 ? 1 : -1;
  return g;
}

/// The same in the lanes whose part is a face of the box.
template <class D>
OKTETT_INLINE void select_faces(const Vec3d& lo, const Vec3d& hi, const D& part, const Vec3<D>& p, D& value,
                                Vec3<D>& gradient) {
  if (none(part > D(0.0))) return;
  const D at[3] = {p.x, p.y, p.z};
  for (int face = 1; face <= 6; ++face) {
    const auto here = part == D(face);
    const int axis = (face - 1) / 2;
    const bool high = (face - 1) % 2 == 1;
    value = select(here, high ? at[axis] - D(hi[axis]) : D(lo[axis]) - at[axis], value);
    gradient = select_lanes(here, broadcast<D>(face_gradient(face)), gradient);
  }
}

/// Whether S has a slope for lanes of D.
template <class S, class D>
concept HasSlope = requires(const typename S::Pool& pool, D& value, Vec3<D>& gradient) {
  S::slope(pool, std::size_t{0}, D(), Vec3<D>(), value, gradient);
};

/// The value and the gradient of a function at one point.
struct Slope {
  double value;
  Vec3d gradient;
};

/// The function of a part of element i, and its gradient.
template <class S, class D>
OKTETT_INLINE void slope_lanes(const typename S::Pool& pool, std::size_t i, const D& part, const Vec3<D>& p,
                               D& value, Vec3<D>& gradient) {
  if constexpr (HasSlope<S, D>) {
    S::slope(pool, i, part, p, value, gradient);
  } else {
    const Slope at = S::slope_at(pool, i, static_cast<int>(only_lane(part)), only_lane(p));
    value = D(at.value), gradient = broadcast<D>(at.gradient);
  }
}

/// The same at one point.
template <class S>
Slope slope_at(const typename S::Pool& pool, std::size_t i, int part, const Vec3d& p) {
  using D = Simd<double, 1, ScalarIsa>;
  D value;
  Vec3<D> gradient;
  slope_lanes<S>(pool, i, D(part), broadcast<D>(p), value, gradient);
  return {only_lane(value), only_lane(gradient)};
}

/// Whether p, in the own space of element i, is inside.
template <class S>
bool is_inside(const typename S::Pool& pool, std::size_t i, const Vec3d& p) {
  if constexpr (requires { S::inside(pool, i, p); }) {
    return S::inside(pool, i, p);
  } else {
    const auto& e = pool.elements[i];
    if constexpr (requires { e.lo; })
      for (int k = 0; k < 3; ++k)
        if (!(e.lo[k] <= p[k] && p[k] <= e.hi[k])) return false;
    return slope_at<S>(pool, i, 0, p).value < 0;
  }
}

/// The part of a line that is in a box. A line parallel to a slab lies in it or not: no threshold. The ends
/// are moved out by a few units in the last place, so that what lies on a face is inside.
template <class D>
OKTETT_INLINE typename D::M clip_line(const Line<D>& line, const Vec3d& lo, const Vec3d& hi,
                                      LineRange<D>& range) {
  const D inf(std::numeric_limits<double>::infinity());
  D near = -inf, far = inf, enter(0.0), exit(0.0);
  auto meets = line.o.x == line.o.x;
  const D* o[3] = {&line.o.x, &line.o.y, &line.o.z};
  const D* d[3] = {&line.d.x, &line.d.y, &line.d.z};
  for (int k = 0; k < 3; ++k) {
    const D low(lo[k]), high(hi[k]);
    const auto parallel = *d[k] == D(0.0), back = *d[k] < D(0.0);
    const D p = (low - *o[k]) / *d[k], q = (high - *o[k]) / *d[k];
    const D n = select(parallel, -inf, select(back, q, p)), f = select(parallel, inf, select(back, p, q));
    const D low_face(1.0 + 2 * k), high_face(2.0 + 2 * k);
    enter = select(n > near, select(back, high_face, low_face), enter);
    exit = select(f < far, select(back, low_face, high_face), exit);
    near = max(n, near), far = min(f, far);
    meets = meets & (~parallel | ((low <= *o[k]) & (*o[k] <= high))) & (*d[k] == *d[k]);
  }
  range = {near - abs(near) * D(0x1p-50), far + abs(far) * D(0x1p-50), enter, exit};
  return meets & (near <= far);
}

/// A line with its parameter shifted and scaled: s = 0 is the point nearest to the origin, and s counts
/// lengths of the shape's own space.
template <class D>
struct CenteredLine {
  Vec3<D> p, u;    ///< the point nearest to the origin, and the unit direction
  D shift, scale;  ///< t = shift + s * scale

  explicit OKTETT_INLINE CenteredLine(const Line<D>& line) {
    const D dd = dot_lanes(line.d, line.d);
    scale = D(1.0) / sqrt(dd);
    shift = -(dot_lanes(line.o, line.d) / dd);
    p = {line.o.x + shift * line.d.x, line.o.y + shift * line.d.y, line.o.z + shift * line.d.z};
    u = {line.d.x * scale, line.d.y * scale, line.d.z * scale};
  }
  OKTETT_INLINE D to_s(const D& t) const { return (t - shift) / scale; }
  OKTETT_INLINE D to_t(const D& s) const { return shift + s * scale; }
};

}  // namespace oktett
