#pragma once
/// \file What all fractals have in common. Their crossings are found one ray at a time, by walks over parts
/// that come to be while the ray descends: a walk keeps one path from the whole down to the part it is at, so
/// its memory grows with the depth and not with the number of parts.
///
/// A fractal F has, beside what exact.h asks for,
/// - `F::find(element, query, out, room)`: lists crossings, see TurnList;
/// and is derived from Fractal.

#include <cmath>
#include <cstdint>

#include "kernels/closed/surface_points.h"
#include "kernels/exact/exact.h"
#include "kernels/exact/exact_pool.h"
#include "kernels/exact/line_columns.h"
#include "kernels/exact/surface_uv.h"

namespace oktett {

/// Where to look for crossings: at a < t <= b on the line o + t d in the element's own space. What lies at a
/// itself says whether the line starts inside.
struct FractalQuery {
  Vec3d o, d;
  double a = 0, b = HUGE_VAL;
  bool with_surface = false;  ///< whether points, normals and uv are wanted
};

/// A crossing: `turn` as in Crossings; the rest, in the element's own space, only if it was asked for.
struct FractalCrossing {
  double t = 0, turn = 0, part = 0;
  Vec3d point, normal, tangent, bitangent;  ///< the last two as in SurfaceInteraction
  double u = 0, v = 0;
};

/// Whether two distances are one after rounding to float, as they are stored. What is open for less than that
/// counts as closed, so that every query sees the same crossings.
inline bool same_float(double a, double b) { return static_cast<float>(a) == static_cast<float>(b); }

/// Makes a list of crossings out of what a walk meets, in ascending order.
class TurnList {
 public:
  TurnList(FractalCrossing* out, int room) : out_(out), room_(room) {}

  int count() const { return count_; }
  bool full() const { return count_ == room_; }
  /// Whether the line is inside, as far as the walk knows.
  bool inside() const { return inside_ && !leaves_; }
  void begin(bool inside) { inside_ = inside; }

  void enter(const FractalCrossing& c) {
    pass(c.t);
    // What was open for no longer than rounding was not.
    if (leaves_)
      leaves_ = false;
    else if (!inside_ && !full())
      out_[count_++] = c, inside_ = true;
  }
  void leave(const FractalCrossing& c) {
    if (inside_ && !leaves_) left_ = c, leaves_ = true;
  }
  /// The walk has come to t.
  void pass(double t) {
    if (leaves_ && !same_float(left_.t, t)) finish();
  }
  void finish() {
    if (!leaves_) return;
    if (!full()) out_[count_++] = left_;
    inside_ = leaves_ = false;
  }

 private:
  FractalCrossing* out_;
  int room_, count_ = 0;
  bool inside_ = false, leaves_ = false;
  FractalCrossing left_;
};

/// A line in units of a grid, whose cells are boxes. What is asked of it is one formula of the plane's
/// number, which grows with it: so neighbouring cells agree on where one ends and the other begins.
struct GridLine {
  /// Where the line leaves a box, or enters it.
  struct Gate {
    double t = HUGE_VAL;
    int axis = 0;
    double plane = 0;
  };
  Vec3d o, d, inverse;
  int way[3];  ///< 1 or -1; 0 where the line is closer to parallel to the planes than a double can resolve

  /// The point p of the element's own space is (p + shift) * scale in the grid.
  GridLine(const FractalQuery& query, const Vec3d& shift, const Vec3d& scale)
      : o((query.o + shift) * scale), d(query.d * scale) {
    for (int k = 0; k < 3; ++k) {
      inverse[k] = 1 / d[k];
      way[k] = !(std::abs(inverse[k]) < HUGE_VAL) || inverse[k] == 0 ? 0 : d[k] > 0 ? 1 : -1;
    }
  }
  /// Where it meets a plane that it is not parallel to.
  double at(int axis, double plane) const { return (plane - o[axis]) * inverse[axis]; }
  double place(int axis, double t) const { return o[axis] + t * d[axis]; }
  /// Whether right after t it is on the side of the plane where coordinates are greater.
  bool is_beyond(int axis, double plane, double t) const {
    if (way[axis] == 0) return plane <= o[axis];
    return way[axis] > 0 ? at(axis, plane) <= t : !(at(axis, plane) <= t);
  }
  /// The part in a box; false if there is none.
  bool clip(const Vec3d& lo, const Vec3d& hi, Gate& in, Gate& out) const {
    in = {-HUGE_VAL}, out = {};
    for (int k = 0; k < 3; ++k) {
      if (way[k] == 0) {
        if (!(lo[k] <= o[k] && o[k] < hi[k])) return false;
        continue;
      }
      const double near = way[k] > 0 ? lo[k] : hi[k], far = way[k] > 0 ? hi[k] : lo[k];
      if (at(k, near) > in.t) in = {at(k, near), k, near};
      if (at(k, far) < out.t) out = {at(k, far), k, far};
    }
    return in.t < out.t && -HUGE_VAL < in.t && out.t < HUGE_VAL;
  }
};

/// The crossing at `gate` with the plane across its axis at `place` in the element's own space, whose normal
/// has the sign `out`; its part is the number of a face as in LineRange. uv as on the square [-1, 1]^2.
inline FractalCrossing wall_crossing(const FractalQuery& query, const GridLine::Gate& gate, double place,
                                     double out, double turn) {
  const int axis = gate.axis, u = (axis + 1) % 3, v = (axis + 2) % 3;
  FractalCrossing c;
  c.t = gate.t, c.turn = turn, c.part = 1 + 2 * axis + (out > 0);
  if (!query.with_surface) return c;
  c.point = query.o + query.d * gate.t;
  c.point[axis] = place, c.normal[axis] = out;
  c.u = 0.5 * (c.point[u] + 1), c.v = 0.5 * (c.point[v] + 1), c.tangent[u] = 2, c.bitangent[v] = 2;
  return c;
}

/// uv of the point p of the unit sphere as of globe_uv, dp/du and dp/dv.
inline void set_ball_uv(const Vec3d& p, FractalCrossing& c, Vec3d& tangent, Vec3d& bitangent) {
  const double across = std::sqrt(p.x * p.x + p.z * p.z);
  c.u = turn_of(p.z, p.x), c.v = 0.5 + portable::atan2(p.y, across) / std::numbers::pi;
  tangent = Vec3d{-p.z, 0, p.x} * (2 * std::numbers::pi);
  bitangent = {0, 0, 0};
  if (across > 0) bitangent = Vec3d{-p.y * p.x / across, across, -p.y * p.z / across} * std::numbers::pi;
}

/// The crossing that `hit` was before its t was rounded to float, on the line of `query`, whose range is not
/// looked at. If rounding took the line itself past it, a point on the line that faces the ray.
template <class F>
FractalCrossing resolve_crossing(const typename F::Element& element, FractalQuery query, double t,
                                 double turn) {
  const double off = std::abs(t) * 0x1p-22 + 0x1p-140;
  query.a = t - off, query.b = t + off, query.with_surface = true;
  constexpr int kRoom = 8;
  FractalCrossing found[kRoom], best{};
  double least = HUGE_VAL;
  for (;;) {
    const int count = F::find(element, query, found, kRoom);
    for (int k = 0; k < count; ++k) {
      const double away = same_float(found[k].t, t) ? 0 : std::abs(found[k].t - t);
      if (found[k].turn == turn && away < least) best = found[k], least = away;
    }
    if (count < kRoom || least == 0) break;
    query.a = found[kRoom - 1].t;
  }
  if (least < HUGE_VAL) return best;
  best.t = t, best.turn = turn;
  best.point = query.o + query.d * t, best.normal = query.d * turn;
  return best;
}

/// What all fractals have alike: F is the fractal, Shape its data, E its element.
template <class F, class Shape, class E>
struct Fractal {
  using Data = Shape;
  using Element = E;
  using Pool = ExactPool<Element>;
  static constexpr int kMaxCrossings = 32;
  static constexpr bool kWholeLines = true, kStopsAtLimit = true;

  /// F::find for each lane: up to K crossings in ascending order.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const LineColumns<D> rays(line, range);
    CrossingColumns<K, D> columns;
    for (unsigned lanes = bits(active); lanes != 0; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      FractalCrossing found[K];
      const int count =
          F::find(pool.elements[cell.element], {rays.o(i), rays.d(i), rays.a(i), rays.b(i)}, found, K);
      for (int k = 0; k < count; ++k)
        columns.t[k][i] = found[k].t, columns.turn[k][i] = found[k].turn, columns.part[k][i] = found[k].part;
      if (count == K) columns.up_to[i] = found[K - 1].t;
    }
    columns.load(out);
  }

  static SurfaceInteraction interaction(const Pool& pool, std::size_t i, const Ray& ray, const Hit& hit) {
    const ExactFrame& frame = pool.frames[i];
    const FractalQuery query{frame.to_own.point(Vec3d(ray.origin)),
                             frame.to_own.vector(Vec3d(ray.direction))};
    const FractalCrossing c = resolve_crossing<F>(pool.elements[i], query, hit.t, hit.v);
    SurfaceInteraction s;
    const Vec3d point = frame.to_world.point(c.point);
    set_position(s, point, ray, c.t, 0x1p-44 * (length(point) + stretch(frame.to_world)));
    const Vec3d n = frame.to_own.normal_by_inverse(c.normal);
    s.geometric_normal = s.shading_normal = Vec3f(n / length(n));
    s.uv = {static_cast<float>(c.u), static_cast<float>(c.v)};
    s.tangent = Vec3f(frame.to_world.vector(c.tangent));
    s.bitangent = Vec3f(frame.to_world.vector(c.bitangent));
    return s;
  }
};

}  // namespace oktett
