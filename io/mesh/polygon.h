#pragma once
/// \file Triangulation of polygons that may be concave, not quite plane, or degenerate.

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.h"
#include "io/mesh/blocker_tree.h"

namespace oktett {

/// Cuts polygons into triangles, always two fewer than corners. Keeps its buffers from one polygon to the
/// next.
class PolygonTriangulator {
 public:
  /// Three corner numbers for each triangle, in the winding of the polygon; valid until the next call. A
  /// simple polygon is covered without overlap, and no triangle is degenerate unless two corners coincide.
  /// The time grows like n log n. If a polygon of more than a thousand corners would take longer, because it
  /// meets itself again and again, what is left of it is cut into a fan. Points must be finite.
  std::span<const std::uint32_t> run(std::span<const Vec3f> points);

 private:
  using Point = PlanePoint;
  /// What keeps a corner from being cut off, from the strictest to the most lenient demand.
  enum class Rule { no_contact, no_overlap, flat, convex, any };

  bool project(std::span<const Vec3f> points);
  void link();
  void clip_ears();
  void cut_off(std::uint32_t corner);
  void fan_out(std::uint32_t first);
  bool may_cut_off(std::uint32_t corner, Rule rule);
  bool is_blocked(std::uint32_t corner, Rule rule);
  bool enters(std::uint32_t corner, std::uint32_t right, std::uint32_t left, std::uint32_t twin) const;
  void update_blocking(std::uint32_t corner);
  void find_blocking();
  double turn(std::uint32_t corner) const;

  std::vector<Point> points_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint8_t> twin_;      ///< another corner stands at the same place
  std::vector<std::uint8_t> blocking_;  ///< reflex, straight or twin, and not cut off yet
  BlockerTree blockers_;
  std::vector<std::uint32_t> by_place_;
  std::size_t remaining_ = 0;
  std::int64_t budget_ = 0;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace oktett
