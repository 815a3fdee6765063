#include "io/mesh/polygon.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace oktett {

// ---- Corners of a polygon in the plane, to find those within a triangle that keep it from being cut off.

/// Corners in a leaf: polygons of about this size need no tree.
static constexpr std::size_t kLeafSize = 16;

void BlockerTree::build(const std::vector<PlanePoint>& points) {
  first_leaf_ = 1;
  while (points.size() > kLeafSize * first_leaf_) first_leaf_ *= 2;
  order_.resize(points.size());
  std::iota(order_.begin(), order_.end(), 0u);
  leaf_of_.resize(points.size());
  boxes_.resize(std::size_t{2} * first_leaf_);
  blocking_.assign(std::size_t{2} * first_leaf_, 0);
  split(points, 1, 0, first_leaf_);
}

/// Makes `node`, which has the leaves from `leaf` on.
void BlockerTree::split(const std::vector<PlanePoint>& points, std::uint32_t node, std::size_t leaf,
                        std::size_t leaves) {
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(leaf));
  const auto end = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(leaf + leaves));
  Box box{points[*begin], points[*begin]};
  for (auto it = begin; it != end; ++it) {
    const PlanePoint& p = points[*it];
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y)};
  }
  boxes_[node] = box;
  if (leaves == 1) {
    for (auto it = begin; it != end; ++it) leaf_of_[*it] = node;
    return;
  }
  const bool along_x = box.hi.x - box.lo.x >= box.hi.y - box.lo.y;
  const auto middle = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(leaf + leaves / 2));
  std::nth_element(begin, middle, end, [&](std::uint32_t i, std::uint32_t j) {
    return along_x ? points[i].x < points[j].x : points[i].y < points[j].y;
  });
  split(points, 2 * node, leaf, leaves / 2);
  split(points, 2 * node + 1, leaf + leaves / 2, leaves / 2);
}

namespace {

/// Corners that may be looked at while a polygon is cut: enough for all pairs of a thousand corners, and
/// beyond that for any that do not meet themselves again and again.
constexpr std::int64_t kBudget = 1 << 20, kBudgetPerCorner = 64;

Vec3d area_vector(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return cross(b - a, c - a); }

/// Whether the diagonal between corners 0 and 2 leaves both triangles with the same winding.
bool splits_at_first(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return dot(area_vector(a, b, c), area_vector(a, c, d)) > 0;
}

std::span<const std::uint32_t> triangulate_quad(std::span<const Vec3f> points) {
  static constexpr std::uint32_t first[6] = {0, 1, 2, 0, 2, 3};
  static constexpr std::uint32_t second[6] = {1, 2, 3, 1, 3, 0};
  const Vec3d a(points[0]), b(points[1]), c(points[2]), d(points[3]);
  return !splits_at_first(a, b, c, d) && splits_at_first(b, c, d, a) ? second : first;
}

}  // namespace

std::span<const std::uint32_t> PolygonTriangulator::run(std::span<const Vec3f> points) {
  if (points.size() == 4) return triangulate_quad(points);
  triangles_.clear();
  remaining_ = points.size();
  link();
  if (project(points))
    clip_ears();
  else
    fan_out(0);
  return triangles_;
}

/// Along the axis in which the area vector (Newell's) is longest, so that the winding becomes positive. False
/// if there is no area.
bool PolygonTriangulator::project(std::span<const Vec3f> points) {
  Vec3d area;
  const Vec3d origin(points[0]);
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    area += area_vector(origin, Vec3d(points[i]), Vec3d(points[i + 1]));
  const int axis = dominant_axis(area);
  if (area[axis] == 0) return false;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (area[axis] < 0) std::swap(u, v);
  points_.clear();
  for (const Vec3f& p : points) points_.push_back({p[u], p[v]});
  return true;
}

void PolygonTriangulator::link() {
  const std::size_t count = remaining_;
  next_.resize(count);
  previous_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    next_[i] = static_cast<std::uint32_t>(i + 1 < count ? i + 1 : 0);
    previous_[i] = static_cast<std::uint32_t>(i > 0 ? i - 1 : count - 1);
  }
}

/// Ear clipping (Meisters 1975). Corners are tried in turn; if a whole round finds no ear, the polygon
/// touches or crosses itself and the demands are lowered step by step until one can be cut off.
void PolygonTriangulator::clip_ears() {
  const std::size_t count = points_.size();
  budget_ = kBudget + kBudgetPerCorner * static_cast<std::int64_t>(count);
  find_blocking();

  std::uint32_t corner = 1;
  Rule rule = Rule::no_contact;
  std::size_t misses = 0;
  while (remaining_ > 3 && budget_ > 0) {
    if (may_cut_off(corner, rule)) {
      const std::uint32_t next = next_[corner];
      cut_off(corner);
      // Skipping one spreads the cuts around the polygon, which keeps triangles from growing thin.
      corner = next_[next];
      rule = Rule::no_contact;
      misses = 0;
    } else {
      corner = next_[corner];
      if (++misses == remaining_) {
        rule = static_cast<Rule>(static_cast<int>(rule) + 1);
        misses = 0;
      }
    }
  }
  fan_out(previous_[corner]);
}

void PolygonTriangulator::cut_off(std::uint32_t corner) {
  const std::uint32_t before = previous_[corner], after = next_[corner];
  triangles_.insert(triangles_.end(), {before, corner, after});
  next_[before] = after;
  previous_[after] = before;
  --remaining_;
  if (blocking_[corner]) blockers_.change(corner, -1);
  blocking_[corner] = 0;
  update_blocking(before);
  update_blocking(after);
}

void PolygonTriangulator::fan_out(std::uint32_t first) {
  for (; remaining_ > 2; --remaining_) {
    const std::uint32_t second = next_[first], third = next_[second];
    triangles_.insert(triangles_.end(), {first, second, third});
    next_[first] = third;
  }
}

double PolygonTriangulator::turn(std::uint32_t corner) const {
  return cross(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
}

bool PolygonTriangulator::may_cut_off(std::uint32_t corner, Rule rule) {
  --budget_;
  // An edge without length, or one that is walked back and forth, encloses nothing.
  const Point& after = points_[next_[corner]];
  if (points_[corner] == after || points_[previous_[corner]] == after) return true;
  const double turned = turn(corner);
  switch (rule) {
    case Rule::no_contact:
    case Rule::no_overlap:
      return turned > 0 && !is_blocked(corner, rule);
    case Rule::flat:
      return turned == 0;
    case Rule::convex:
      return turned > 0;
    case Rule::any:
      break;
  }
  return true;
}

/// Whether the rest of the polygon reaches into the triangle at `corner`. If it does, one of its reflex
/// corners lies there, or a corner at the same place as one of the triangle's leads into it.
bool PolygonTriangulator::is_blocked(std::uint32_t corner, Rule rule) {
  if (blockers_.blocking() == 0) return false;
  const std::uint32_t before = previous_[corner], after = next_[corner];
  const Point &a = points_[before], &b = points_[corner], &c = points_[after];
  return blockers_.any_in(a, b, c, [&](std::uint32_t other) {
    --budget_;
    if (!blocking_[other] || other == before || other == corner || other == after) return false;
    const Point& p = points_[other];
    if (p == a) return enters(before, corner, after, other);
    if (p == b) return enters(corner, after, before, other);
    if (p == c) return enters(after, before, corner, other);
    const double ab = cross(a, b, p), bc = cross(b, c, p), ca = cross(c, a, p);
    return rule == Rule::no_contact ? ab >= 0 && bc >= 0 && ca >= 0 : ab > 0 && bc > 0 && ca > 0;
  });
}

/// Whether an edge at `twin`, which stands at the same place as `corner`, leads between the directions to
/// `right` and, to the left of that, to `left`.
bool PolygonTriangulator::enters(std::uint32_t corner, std::uint32_t right, std::uint32_t left,
                                 std::uint32_t twin) const {
  for (const std::uint32_t to : {next_[twin], previous_[twin]})
    if (cross(points_[corner], points_[right], points_[to]) > 0 &&
        cross(points_[corner], points_[to], points_[left]) > 0)
      return true;
  return false;
}

void PolygonTriangulator::update_blocking(std::uint32_t corner) {
  const bool blocks = twin_[corner] || !(turn(corner) > 0);
  if (blocks == static_cast<bool>(blocking_[corner])) return;
  blocking_[corner] = blocks;
  blockers_.change(corner, blocks ? 1 : -1);
}

void PolygonTriangulator::find_blocking() {
  const std::size_t count = points_.size();
  blockers_.build(points_);
  by_place_.resize(count);
  std::iota(by_place_.begin(), by_place_.end(), 0u);
  std::sort(by_place_.begin(), by_place_.end(), [this](std::uint32_t i, std::uint32_t j) {
    const Point &p = points_[i], &q = points_[j];
    return p.x != q.x ? p.x < q.x : p.y < q.y;
  });
  twin_.assign(count, 0);
  for (std::size_t i = 1; i < count; ++i) {
    const std::uint32_t p = by_place_[i - 1], q = by_place_[i];
    if (points_[p] == points_[q]) twin_[p] = twin_[q] = 1;
  }
  blocking_.assign(count, 0);
  for (std::uint32_t i = 0; i < count; ++i) update_blocking(i);
}

}  // namespace oktett
