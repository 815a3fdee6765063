#pragma once
/// \file Triangulation of polygons that may be concave, not quite plane, or degenerate.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/vec3.h"
#include "io/mesh/plane_point.h"
#include "io/mesh/polygon_sweep.h"

namespace oktett {

// ---- Corners of a polygon in the plane, to find those within a triangle that keep it from being cut off.

/// A box in the plane, empty at first.
struct PlaneBox {
  PlanePoint lo{HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL};

  void grow(const PlanePoint& p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
  }
  /// Boxes that touch meet, too.
  bool meets(const PlaneBox& b) const {
    return lo.x <= b.hi.x && b.lo.x <= hi.x && lo.y <= b.hi.y && b.lo.y <= hi.y;
  }
};

/// All corners in a balanced kd-tree (Bentley 1975) whose nodes count the corners that block.
class BlockerTree {
 public:
  /// For these points, none of which blocks.
  void build(const std::vector<PlanePoint>& points);

  /// Corner `i`, which did not block so far, does from now on (1), or the other way round (-1).
  void change(std::uint32_t i, int by) {
    for (std::uint32_t node = leaf_of_[i]; node > 0; node /= 2)
      blocking_[node] += static_cast<std::uint32_t>(by);
  }

  std::uint32_t blocking() const { return blocking_[1]; }

  /// Whether visit(corner) is true for some corner that may block in the triangle a, b, c, which turns to the
  /// left. Corners outside of it, and those that do not block, may be visited, too. Those with the place of
  /// a, b or c are visited.
  template <class Visit>
  bool any_in(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, Visit&& visit) const {
    const Triangle triangle(a, b, c);
    std::uint32_t waiting[2 * 32];
    int count = 0;
    waiting[count++] = 1;
    while (count > 0) {
      const std::uint32_t node = waiting[--count];
      if (blocking_[node] == 0 || triangle.misses(boxes_[node])) continue;
      if (node < first_leaf_) {
        waiting[count++] = 2 * node, waiting[count++] = 2 * node + 1;
        continue;
      }
      const std::size_t leaf = node - first_leaf_;
      for (std::size_t k = begin_of(leaf); k < begin_of(leaf + 1); ++k)
        if (visit(order_[k])) return true;
    }
    return false;
  }

 private:
  /// A line that a triangle lies to the left of.
  struct Edge {
    PlanePoint from, to;
    bool sure;  ///< rounding leaves the third corner on that side

    /// Rounding is monotonic, so no point of the box computes to a greater area than this corner of it.
    bool misses(const PlaneBox& box) const {
      const PlanePoint most{to.y - from.y >= 0 ? box.lo.x : box.hi.x,
                            to.x - from.x >= 0 ? box.hi.y : box.lo.y};
      return sure && cross(from, to, most) < 0;
    }
  };
  struct Triangle {
    PlaneBox box;
    Edge edges[3];

    Triangle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c)
        : box{{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
              {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})}},
          edges{{a, b, cross(a, b, c) >= 0}, {b, c, cross(b, c, a) >= 0}, {c, a, cross(c, a, b) >= 0}} {}
    bool misses(const PlaneBox& b) const {
      return !box.meets(b) || edges[0].misses(b) || edges[1].misses(b) || edges[2].misses(b);
    }
  };

  std::size_t begin_of(std::size_t leaf) const { return order_.size() * leaf / first_leaf_; }
  void split(const std::vector<PlanePoint>& points, std::uint32_t node, std::size_t leaf, std::size_t leaves);

  std::uint32_t first_leaf_ =
      1;  ///< number of leaves; nodes are numbered from 1, the children of k are 2k and 2k + 1
  std::vector<std::uint32_t> order_, leaf_of_;
  std::vector<PlaneBox> boxes_;
  std::vector<std::uint32_t> blocking_;
};

/// Cuts polygons into triangles, always two fewer than corners: small ones by taking off ears (Meisters
/// 1975), which gives the better triangles, large ones by a sweep. Keeps its buffers from one polygon to the
/// next.
class PolygonTriangulator {
 public:
  /// Three corner numbers for each triangle, in the winding of the polygon; valid until the next call. A
  /// polygon that does not cross itself, seen along the axis in which its area is greatest, is covered
  /// without overlap, also where it touches itself or holes are joined to it by bridges; no triangle is
  /// degenerate unless corners coincide or lie on an edge that they do not end. The time grows like n log n.
  /// Points must be finite.
  std::span<const std::uint32_t> run(std::span<const Vec3f> points);

  /// Whether the polygon of the last call crosses itself, so that its triangles may overlap or be turned
  /// over: exactly, but that spikes without width may cross anything, and that where one angle is walked
  /// three times and more a contact may be taken for a crossing. Of four corners only those are told that no
  /// diagonal cuts into triangles of one winding.
  bool crosses_itself() const { return crosses_itself_; }

 private:
  using Point = PlanePoint;
  /// What keeps a corner from being cut off, from the strictest to the most lenient demand.
  enum class Rule { no_contact, no_overlap, flat, convex, any };
  /// A corner that another one keeps from being cut off, and the next of those it keeps.
  struct Waiter {
    std::uint32_t corner, next;
  };

  std::span<const std::uint32_t> cut_quad(std::span<const Vec3f> points);
  bool project(std::span<const Vec3f> points);
  void link();
  bool clip_ears();
  void cut_in_rounds(Rule rule);
  bool cut_one(Rule rule);
  void cut_off(std::uint32_t corner);
  void fan_out(std::uint32_t first);
  void try_again(std::uint32_t corner);
  void try_again_those_kept_by(std::uint32_t corner);
  /// Corners that were cut off are linked from none.
  bool is_left(std::uint32_t corner) const { return next_[previous_[corner]] == corner; }
  bool encloses_nothing(std::uint32_t corner) const;
  std::uint32_t find_blocker(std::uint32_t corner, Rule rule);
  bool enters(std::uint32_t corner, std::uint32_t right, std::uint32_t left, std::uint32_t twin) const;
  void update_blocking(std::uint32_t corner);
  void find_blocking();
  int turn(std::uint32_t corner) const;

  std::vector<Point> points_;
  PolygonSweep sweep_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint8_t> twin_;      ///< another corner stands at the same place
  std::vector<std::uint8_t> blocking_;  ///< reflex, straight or twin, and not cut off yet
  BlockerTree blockers_;
  std::vector<std::uint32_t> by_place_;
  std::uint32_t last_ = 0;  ///< a corner that is left
  std::size_t remaining_ = 0;
  std::uint32_t round_ = 0;                  ///< from 1 on
  std::vector<std::uint32_t> due_;           ///< per corner: the round in which it is tried
  std::vector<std::uint32_t> now_, later_;   ///< corners to be tried in this and in the next round
  std::vector<std::uint32_t> first_waiter_;  ///< per corner: the first of those it keeps, in `waiters_`
  std::vector<Waiter> waiters_;
  std::int64_t twins_left_ = 0;  ///< how many corners with twins may still be looked at
  bool crosses_itself_ = false;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace oktett
