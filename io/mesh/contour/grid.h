#pragma once
/// \file Where the lines of a grid cross a surface. Within io/ only.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/accel.h"
#include "core/vec3.h"

namespace oktett {

/// Numbers of nodes or cells along the axes.
using GridPlace = std::array<std::int32_t, 3>;

/// The place `steps` further along an axis.
inline GridPlace moved(GridPlace p, int axis, std::int32_t steps) {
  p[static_cast<std::size_t>(axis)] += steps;
  return p;
}

/// A grid of cubes. Its nodes are floats, so that rays run exactly along its lines.
struct ContourGrid {
  std::array<std::vector<float>, 3> nodes;  ///< ascending coordinates along each axis
  double spacing = 0;                       ///< edge of a cell, but for rounding

  /// A grid around a box whose longest edge is `cells` cells. The box stands askew in it, so that faces along
  /// the axes do not coincide with lines of the grid.
  static ContourGrid around(const Vec3d& lo, const Vec3d& hi, std::uint32_t cells);

  std::int32_t cells(int axis) const {
    return static_cast<std::int32_t>(nodes[static_cast<std::size_t>(axis)].size()) - 1;
  }
  double node(int axis, std::int32_t i) const {
    return static_cast<double>(nodes[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)]);
  }
  Vec3d corner(const GridPlace& p) const { return {node(0, p[0]), node(1, p[1]), node(2, p[2])}; }
  /// Lines along an axis; the line through node p has the number line(axis, p).
  std::size_t lines(int axis) const {
    return nodes[static_cast<std::size_t>((axis + 1) % 3)].size() *
           nodes[static_cast<std::size_t>((axis + 2) % 3)].size();
  }
  std::size_t line(int axis, const GridPlace& p) const {
    const auto b = static_cast<std::size_t>((axis + 1) % 3), c = static_cast<std::size_t>((axis + 2) % 3);
    return static_cast<std::size_t>(p[b]) * nodes[c].size() + static_cast<std::size_t>(p[c]);
  }
  GridPlace start_of(int axis, std::size_t line) const {
    const auto b = static_cast<std::size_t>((axis + 1) % 3), c = static_cast<std::size_t>((axis + 2) % 3);
    GridPlace p{};
    p[b] = static_cast<std::int32_t>(line / nodes[c].size());
    p[c] = static_cast<std::int32_t>(line % nodes[c].size());
    return p;
  }
};

/// A place where an edge of the grid crosses the surface.
struct ContourCrossing {
  double at = 0;    ///< coordinate along the edge
  Vec3f normal;     ///< of length 1
  GridPlace place;  ///< the node where the edge begins
  std::uint32_t user = kNoId;
  std::uint8_t axis = 0;
  std::int8_t turn = 0;  ///< 1 where the edge leaves through the front of the surface, -1 where it enters
};

/// Crossings `first` up to `last`.
struct CrossingRange {
  std::uint32_t first = 0, last = 0;
  bool empty() const { return first == last; }
};

/// All crossings of the lines of a grid, those of a line in ascending order.
struct ContourCrossings {
  std::vector<ContourCrossing> all;                    ///< axis by axis, line by line
  std::array<std::vector<std::uint32_t>, 3> of_lines;  ///< where those of each line begin, and the end

  CrossingRange on_line(int axis, std::size_t line) const {
    const std::vector<std::uint32_t>& begin = of_lines[static_cast<std::size_t>(axis)];
    return {begin[line], begin[line + 1]};
  }
  /// Those on the edge that begins at a node.
  CrossingRange on_edge(const ContourGrid& grid, int axis, const GridPlace& p) const {
    const CrossingRange line = on_line(axis, grid.line(axis, p));
    const auto k = static_cast<std::size_t>(axis);
    const auto begin = all.begin() + line.first, end = all.begin() + line.last;
    const auto first = std::partition_point(
        begin, end, [&](const ContourCrossing& crossing) { return crossing.place[k] < p[k]; });
    auto last = first;
    while (last != end && last->place[k] == p[k]) ++last;
    return {static_cast<std::uint32_t>(first - all.begin()), static_cast<std::uint32_t>(last - all.begin())};
  }
  Vec3d position(const ContourGrid& grid, std::uint32_t i) const {
    Vec3d p = grid.corner(all[i].place);
    p[all[i].axis] = all[i].at;
    return p;
  }
};

/// What a ray met.
struct ContourSample {
  Vec3d position;
  Vec3f normal;
  std::uint32_t user = kNoId;
  std::uint32_t ray = 0;  ///< its number in the batch
  double t = 0;
};

/// All places where rays, whose directions have unit length, meet the surface, ray by ray.
std::vector<ContourSample> sample_rays(const Accel& accel, const RayBatch& rays);

/// Traces a ray along each line of the grid, in parallel. An edge has at most kMostOnEdge crossings; of more
/// an even number is left out. Throws Error if there are more than 2^29 crossings.
ContourCrossings sample_grid(const Accel& accel, const ContourGrid& grid);
inline constexpr std::size_t kMostOnEdge = 16;

}  // namespace oktett
