#pragma once
/// \file Crossings with the union of the convex solids at the nodes of a tree that comes to be while it is
/// walked.
///
/// A tree T has
/// - `T::Node`: a part, as the ray sees it; `T::kMaxChildren`;
/// - `tree.solid(node, span)`: whether the node has a solid of its own that the line meets, and where;
/// - `tree.children(node, spans)`: how many children the line may meet, and which ones. Each span contains
///   everything that the line meets of the child and its descendants;
/// - `tree.child(node, number)`.
/// Everything is a function of the line alone.
///
/// A walk that has looked at kMostUnionSteps parts is given up: it finds nothing more, and is counted
/// (interval::count_uncertified). Where parts overlap almost entirely, it would take forever.

#include <limits>

#include "kernels/exact/march.h"
#include "kernels/fractals/fractal.h"

namespace oktett {

/// Parts that the walk along one line may look at.
inline constexpr int kMostUnionSteps = 1 << 16;

/// Where a line is inside of something convex, in t; with the number of the child that it is.
struct UnionSpan {
  double near, far;
  int child;
};

template <class T, int kMaxDepth>
class UnionWalk {
 public:
  using Node = typename T::Node;
  /// Where a solid is met: the way to it from the root.
  struct Place {
    Node node;
    int level;
    std::uint8_t path[kMaxDepth];
  };

  /// From `root`, of which `bounds` hold all, `depth` levels down.
  UnionWalk(const T& tree, const Node& root, const UnionSpan& bounds, int depth)
      : tree_(tree), root_(root), bounds_(bounds), depth_(depth) {}

  /// The first crossing after a, at most b, as `next` tells it; finds out whether the line is inside right
  /// after a.
  bool first(double a, double b, bool& inside, double& t, Place& place) {
    bool found = false, within = false;
    double best = b;
    walk(
        [&](const Node& node, int level) {
          UnionSpan s;
          if (!tree_.solid(node, s) || !(a < s.far)) return;
          if (s.near <= a) {
            within = true;
          } else if (found ? s.near < best : s.near <= best) {
            best = s.near, found = true, held_until_ = s.far;
            keep(node, level, place);
          }
        },
        [&](const UnionSpan& s) { return !within && s.near <= best && a < s.far; });
    inside = within;
    if (within) {
      // What is entered later does not hold the line until then.
      held_until_ = -std::numeric_limits<double>::infinity();
      return next(a, b, inside, t, place);
    }
    t = best;
    return inside = found && !given_up();
  }

  /// The next crossing after a, at most b, as the solids tell that are entered and left; false if there is
  /// none. `inside` says whether the line is inside right after a, and afterwards whether it is beyond what
  /// was found.
  bool next(double a, double b, bool& inside, double& t, Place& place) {
    if (!inside) {
      if (!enter(a, b, t, place)) return false;
      return inside = true;
    }
    // The solid that was entered last is not left before b, so neither are all.
    if (held_until_ > b) return false;
    double out = a;
    if (!leave(out, place)) return false;
    for (;;) {
      // Gaps that vanish when t is rounded are none.
      Place other;
      double in = out;
      while (leave(in, other)) place = other, out = in;
      const double end = out + std::abs(out) * 0x1p-22 + 0x1p-140;
      if (!enter(out, end, in, other) || !same_float(in, out)) break;
      out = in;
      if (!leave(out, place)) break;
    }
    if (!(out <= b)) return false;
    t = out, inside = false;
    return true;
  }

  /// Whether the walk was given up.
  bool given_up() const { return steps_ > kMostUnionSteps; }

 private:
  struct Level {
    Node node;
    int count, next;
    UnionSpan spans[T::kMaxChildren];
  };

  /// Calls visit(node, level) for the root and, depth first, all descendants whose span is wanted; where
  /// children are looked at, the nearest come first.
  template <class Visit, class Wanted>
  void walk(Visit&& visit, Wanted&& wanted) {
    if (!wanted(bounds_)) return;
    visit(root_, 0);
    int at = 0;
    if (depth_ == 0) return;
    open(0, root_, wanted);
    while (at >= 0 && !given_up()) {
      Level& level = levels_[at];
      if (level.next == level.count) {
        --at;
        continue;
      }
      const UnionSpan& span = level.spans[level.next++];
      if (!wanted(span)) continue;
      path_[at] = static_cast<std::uint8_t>(span.child);
      const Node node = tree_.child(level.node, span.child);
      visit(node, at + 1);
      if (at + 1 < depth_) open(++at, node, wanted);
    }
  }

  template <class Wanted>
  void open(int at, const Node& node, Wanted&& wanted) {
    Level& level = levels_[at];
    level.node = node, level.next = 0;
    UnionSpan all[T::kMaxChildren];
    const int n = tree_.children(node, all);
    steps_ += n + 1;
    level.count = 0;
    for (int k = 0; k < n; ++k) {
      if (!wanted(all[k])) continue;
      int to = level.count++;
      for (; to > 0 && all[k].near < level.spans[to - 1].near; --to) level.spans[to] = level.spans[to - 1];
      level.spans[to] = all[k];
    }
  }

  void keep(const Node& node, int level, Place& place) const {
    place.node = node, place.level = level;
    for (int k = 0; k < level; ++k) place.path[k] = path_[k];
  }

  /// The first solid that is entered after a, at most at b.
  bool enter(double a, double b, double& t, Place& place) {
    bool found = false;
    double best = b;
    walk(
        [&](const Node& node, int level) {
          UnionSpan s;
          if (!tree_.solid(node, s) || !(a < s.near) || !(found ? s.near < best : s.near <= best)) return;
          best = s.near, found = true, held_until_ = s.far;
          keep(node, level, place);
        },
        [&](const UnionSpan& s) { return s.near <= best && a < s.far; });
    t = best;
    return found && !given_up();
  }

  /// Of the solids that hold the line right after t, the farthest end; false if there is none.
  bool leave(double& t, Place& place) {
    const double at = t;
    bool found = false;
    walk(
        [&](const Node& node, int level) {
          UnionSpan s;
          if (!tree_.solid(node, s) || !(s.near <= at && t < s.far)) return;
          t = s.far, found = true;
          keep(node, level, place);
        },
        [&](const UnionSpan& s) { return s.near <= at && t < s.far; });
    return found && !given_up();
  }

  const T& tree_;
  const Node& root_;
  UnionSpan bounds_;
  int depth_, steps_ = 0;
  double held_until_ = -std::numeric_limits<double>::infinity();  ///< where the solid entered last ends
  Level levels_[kMaxDepth];
  std::uint8_t path_[kMaxDepth];
};

/// Bounds in the world of what reaches as far as support(w) along w, both in the own space of an element in
/// `frame`, with room for rounding by `slack` times the coordinates; `radius` is about its size there.
template <class Support>
Box bounds_by_support(const ExactFrame& frame, double slack, double radius, Support&& support) {
  Vec3d lo, hi, reach;
  for (int k = 0; k < 3; ++k) {
    const auto& row = frame.to_world.m[k];
    const Vec3d w{row[0], row[1], row[2]};
    const double middle = row[3];
    reach[k] = std::abs(middle) + length(w) * radius;
    const double pad = slack * reach[k];
    lo[k] = middle - support(-w) - pad, hi[k] = middle + support(w) + pad;
  }
  const Vec3d pad = displacement(frame.to_own, frame.to_world, reach);
  return {round_down(lo - pad), round_up(hi + pad)};
}

/// F::find for a union: `tell(place, crossing)` adds the point and the normal.
template <class Walk, class Tell>
int find_in_union(Walk& walk, const FractalQuery& query, FractalCrossing* out, int room, Tell&& tell) {
  bool inside = false;
  double at = query.a;
  int count = 0;
  typename Walk::Place place;
  while (count < room && (count == 0 ? walk.first(at, query.b, inside, at, place)
                                     : walk.next(at, query.b, inside, at, place))) {
    FractalCrossing& c = out[count++];
    c = {};
    c.t = at, c.turn = inside ? -1 : 1;
    if (query.with_surface) tell(place, c);
  }
  if (OKTETT_UNLIKELY(walk.given_up())) interval::count_uncertified(1);
  return count;
}

}  // namespace oktett
