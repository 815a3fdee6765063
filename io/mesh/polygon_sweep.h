#pragma once
/// \file Triangulation of polygons in the plane by a sweep, which finds out whether they cross themselves.

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "io/mesh/plane_point.h"

namespace oktett {

/// Cuts a polygon into triangles as a line moves over it from left to right (Hertel and Mehlhorn 1983), in
/// O(n log n). Keeps its buffers from one polygon to the next.
///
/// What lies inside to the left of the line is cut already, but for a chain of corners in each stretch of the
/// line that is inside: from the left end of the edge below to that of the edge above, turning only to the
/// left, so that nothing can be cut off it before the next corner. Where edges lie on each other or corners
/// at one place, the order along the line is that of a polygon moved apart a little. Edges that come to lie
/// next to each other are tested against each other (Shamos and Hoey 1976).
class PolygonSweep {
 public:
  /// False if the polygon crosses itself, or if it is wound to the right. It may touch itself in corners and
  /// along edges, also walk edges back and forth. Coordinates are those of floats.
  bool run(const std::vector<PlanePoint>& points);

  /// Of the last call, if that was true: three corner numbers for each triangle, two triangles fewer than
  /// corners. None turns to the right; those at places where the polygon touches itself or is walked back and
  /// forth may be flat.
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }

 private:
  enum class Kind : std::uint8_t { begins, splits, ends, joins, goes_on_below, goes_on_above, gone };
  /// A corner of a polygon: where it is, among all from left to right, of equals the same; its neighbours,
  /// what happens there, and the stretches whose lower or upper edge has its right end there. All in one line
  /// of the cache, as they are visited in the order of the line.
  struct alignas(32) Corner {
    float x, y;
    std::uint32_t rank, next, previous;
    std::uint32_t low_of, high_of;
    Kind kind;
  };
  /// From left to right.
  struct Edge {
    float left_x, left_y, right_x, right_y;

    PlanePoint left() const { return {left_x, left_y}; }
    PlanePoint right() const { return {right_x, right_y}; }
  };
  /// A stretch of the line that is inside, in a treap (Aragon and Seidel 1989) and a list.
  struct alignas(64) Stretch {
    Edge low, high;
    std::uint32_t left, right, parent;
    std::uint32_t below, above;  ///< neighbours along the line
  };
  /// What else is known of it. Edges bear the number of the corner where they begin in the order of the
  /// polygon: it lies left on edges below the inside, and right on those above.
  struct Inside {
    std::uint32_t low, high;            ///< edges
    std::uint32_t first, last, newest;  ///< links of the chain: its ends, and the one that was added last
  };
  /// A corner of a chain.
  struct Link {
    std::uint32_t corner, before, after;
  };
  struct Place {
    std::uint64_t key;
    std::uint32_t corner;
  };
  /// A corner that begins a stretch or splits one, and the right ends of its edges.
  struct Opening {
    std::uint32_t corner, low, high;
    bool begins;
  };
  struct Found {
    std::uint32_t stretch;
    bool within;
  };
  /// Openings of one angle among which one is chosen.
  static constexpr std::size_t kMostTried = 16;
  /// Corners that are fetched ahead.
  static constexpr std::size_t kAhead = 16;

  void sort_corners(const std::vector<PlanePoint>& points);
  bool encloses_nothing(std::uint32_t corner) const;
  void cut_what_encloses_nothing();
  void set_kinds();
  void add_place(std::span<const Place> place);
  void close(std::uint32_t corner);
  void go_on(std::uint32_t corner);
  void open_all();
  void begin(std::uint32_t below, std::uint32_t corner);
  void split(std::uint32_t stretch, std::uint32_t corner);
  void join(std::uint32_t below, std::uint32_t above, std::uint32_t corner);

  PlanePoint point(std::uint32_t c) const { return {corners_[c].x, corners_[c].y}; }
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(point(a), point(b), point(c));
  }
  Edge edge(std::uint32_t left, std::uint32_t right) const {
    return {corners_[left].x, corners_[left].y, corners_[right].x, corners_[right].y};
  }
  void set_low(std::uint32_t stretch, std::uint32_t edge);
  void set_high(std::uint32_t stretch, std::uint32_t edge);
  void check_order(const Edge& lower, const Edge& upper);
  void check_within(std::uint32_t stretch);
  void check_below(std::uint32_t stretch);
  int side(const Edge& edge, const Opening& opening);
  Found find(const Opening& opening);

  void cut(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.insert(triangles_.end(), {a, b, c});
  }
  std::uint32_t new_link(std::uint32_t corner, std::uint32_t before, std::uint32_t after);
  void add_first(Inside& inside, std::uint32_t corner);
  void add_last(Inside& inside, std::uint32_t corner);

  std::uint32_t insert_above(std::uint32_t below);
  std::pair<std::uint32_t, std::uint32_t> remove(std::uint32_t stretch);
  void lift(std::uint32_t stretch);
  void replace_child(std::uint32_t parent, std::uint32_t from, std::uint32_t to);

  std::vector<Corner> corners_;
  std::vector<Place> by_place_;
  std::vector<std::uint32_t> waiting_;
  std::vector<Opening> openings_;
  /// Number 0 is none: above it is the lowest stretch, below it the highest, and its right child is the root.
  std::vector<Stretch> stretches_;
  std::vector<Inside> insides_;
  std::vector<std::uint32_t> unused_;
  std::vector<Link> links_;
  bool crosses_ = false;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace oktett
