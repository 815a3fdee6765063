#include "io/mesh/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/mesh.h"

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
  PlaneBox box;
  for (auto it = begin; it != end; ++it) box.grow(points[*it]);
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

// ---- Triangles.

namespace {

/// Whether all corners turn to the left, and the polygon goes around once: it turns back twice along x.
bool is_convex(const std::vector<PlanePoint>& points) {
  int changes = 0, way = 0, first = 0;
  for (std::size_t i = 0, before = points.size() - 1; i < points.size(); before = i++) {
    const std::size_t after = i + 1 < points.size() ? i + 1 : 0;
    if (orientation(points[before], points[i], points[after]) <= 0) return false;
    const double by = points[after].x - points[i].x;
    const int to = by > 0 ? 1 : by < 0 ? -1 : way;
    changes += way != 0 && to != way;
    way = to;
    if (first == 0) first = to;
  }
  return changes + (way != first) <= 2;
}

/// Corners up to which ears are cut off. Beyond, thin ears across thousands of corners take too long.
constexpr std::size_t kMostEars = 10000;

/// Corners with twins that may be looked at: enough for all pairs of a thousand corners at one place, and
/// beyond that for those that do not meet again and again.
constexpr std::int64_t kMostTwins = 1 << 20, kMostTwinsPerCorner = 16;

Vec3d area_vector(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return cross(b - a, c - a); }

}  // namespace

std::span<const std::uint32_t> PolygonTriangulator::run(std::span<const Vec3f> points) {
  crosses_itself_ = false;
  if (points.size() == 4) return cut_quad(points);
  triangles_.clear();
  remaining_ = points.size();
  link();
  if (!project(points)) {
    fan_out(0);
    return triangles_;
  }
  const bool is_small = points.size() <= kMostEars;
  if (!is_small || !is_convex(points_)) crosses_itself_ = !sweep_.run(points_);
  if (!is_small && !crosses_itself_) return sweep_.triangles();
  if (clip_ears()) return triangles_;
  return sweep_.triangles();
}

std::span<const std::uint32_t> PolygonTriangulator::cut_quad(std::span<const Vec3f> points) {
  static constexpr std::uint32_t first[6] = {0, 1, 2, 0, 2, 3};
  static constexpr std::uint32_t second[6] = {1, 2, 3, 1, 3, 0};
  const Vec3d a(points[0]), b(points[1]), c(points[2]), d(points[3]);
  // The diagonal must leave both triangles with the same winding.
  const double by_first = dot(area_vector(a, b, c), area_vector(a, c, d));
  if (by_first > 0) return first;
  const double by_second = dot(area_vector(b, c, d), area_vector(b, d, a));
  if (by_second > 0) return second;
  crosses_itself_ = by_first < 0 && by_second < 0;
  return first;
}

/// Along the axis in which the area vector (Newell's) is longest, so that the winding becomes positive. Where
/// areas cancel each other, that of the largest triangle counts. False if there is none.
bool PolygonTriangulator::project(std::span<const Vec3f> points) {
  Vec3d area, largest;
  const Vec3d origin(points[0]);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vec3d part = area_vector(origin, Vec3d(points[i]), Vec3d(points[i + 1]));
    area += part;
    if (max_component(abs(part)) > max_component(abs(largest))) largest = part;
  }
  if (max_component(abs(area)) == 0) area = largest;
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

/// A corner that cannot be cut off is tried again when a neighbour was cut off, or when the corner that
/// blocks it no longer does; nothing else changes the answer. A polygon that touches itself may have no ear
/// by the strictest rule, then a more lenient one is taken; false if there is none by that, either, or if it
/// took for an ear what is none. One that crosses itself is cut all the same.
bool PolygonTriangulator::clip_ears() {
  const std::size_t count = points_.size();
  find_blocking();
  first_waiter_.assign(count, kNoId);
  waiters_.clear();
  due_.assign(count, 0);
  round_ = 0, last_ = 0;
  twins_left_ = kMostTwins + kMostTwinsPerCorner * static_cast<std::int64_t>(count);
  now_.clear(), later_.clear();
  for (std::uint32_t i = 0; i < count && remaining_ > 3; ++i)
    if (is_left(i) && encloses_nothing(i)) cut_off(i);
  // From corner 1 on, so that a convex polygon begins with the triangle of its first three.
  for (std::uint32_t i = 1; i <= count; ++i)
    if (const std::uint32_t corner = i < count ? i : 0; is_left(corner)) try_again(corner);
  cut_in_rounds(Rule::no_contact);
  if (remaining_ > 3) {
    for (std::uint32_t corner = last_, k = 0, left = static_cast<std::uint32_t>(remaining_); k < left;
         ++k, corner = next_[corner])
      try_again(corner);
    cut_in_rounds(Rule::no_overlap);
  }
  // Areas always add up, and only the last triangle can be turned over. If it is not, none overlap.
  if (!crosses_itself_ && (remaining_ > 3 || turn(next_[last_]) < 0)) return false;
  std::int64_t budget = 64 * static_cast<std::int64_t>(count);
  while (remaining_ > 3 && twins_left_ > 0 && (budget -= static_cast<std::int64_t>(remaining_)) > 0) {
    if (!cut_one(Rule::flat) && !cut_one(Rule::convex)) cut_one(Rule::any);
    cut_in_rounds(Rule::no_overlap);
  }
  fan_out(last_);
  return true;
}

/// Tries all corners that are due, and those that become due thereby.
void PolygonTriangulator::cut_in_rounds(Rule rule) {
  while (remaining_ > 3 && twins_left_ > 0 && !later_.empty()) {
    ++round_;
    std::swap(now_, later_);
    later_.clear();
    for (const std::uint32_t corner : now_) {
      if (twins_left_ <= 0) return;
      if (due_[corner] != round_) continue;
      due_[corner] = 0;
      if (turn(corner) <= 0) continue;
      if (const std::uint32_t blocker = find_blocker(corner, rule); blocker != kNoId) {
        waiters_.push_back({corner, first_waiter_[blocker]});
        first_waiter_[blocker] = static_cast<std::uint32_t>(waiters_.size() - 1);
        continue;
      }
      // The next corner waits for the next round: that spreads the cuts around the polygon, which keeps
      // triangles from growing thin.
      cut_off(corner);
      if (remaining_ <= 3) return;
    }
  }
}

/// Cuts off the first corner that a lenient rule allows.
bool PolygonTriangulator::cut_one(Rule rule) {
  std::uint32_t corner = last_;
  for (std::size_t k = 0; k < remaining_; ++k, corner = next_[corner]) {
    const int turned = turn(corner);
    if (rule == Rule::flat ? turned != 0 : rule == Rule::convex && turned <= 0) continue;
    cut_off(corner);
    return true;
  }
  return false;
}

/// Also cuts off what encloses nothing then: behind it another corner could be taken for an ear.
void PolygonTriangulator::cut_off(std::uint32_t corner) {
  while (true) {
    const std::uint32_t before = previous_[corner], after = next_[corner];
    triangles_.insert(triangles_.end(), {before, corner, after});
    next_[before] = after;
    previous_[after] = before;
    --remaining_;
    last_ = after;
    due_[corner] = 0;
    if (blocking_[corner]) {
      blockers_.change(corner, -1);
      blocking_[corner] = 0;
      try_again_those_kept_by(corner);
    }
    for (const std::uint32_t neighbour : {after, before}) {
      update_blocking(neighbour);
      try_again(neighbour);
    }
    if (remaining_ <= 3) return;
    if (encloses_nothing(after))
      corner = after;
    else if (encloses_nothing(before))
      corner = before;
    else
      return;
  }
}

void PolygonTriangulator::try_again(std::uint32_t corner) {
  if (due_[corner] == round_ + 1) return;
  due_[corner] = round_ + 1;
  later_.push_back(corner);
}

void PolygonTriangulator::try_again_those_kept_by(std::uint32_t corner) {
  for (std::uint32_t w = std::exchange(first_waiter_[corner], kNoId); w != kNoId; w = waiters_[w].next) {
    const std::uint32_t kept = waiters_[w].corner;
    if (is_left(kept)) try_again(kept);
  }
}

void PolygonTriangulator::fan_out(std::uint32_t first) {
  for (; remaining_ > 2; --remaining_) {
    const std::uint32_t second = next_[first], third = next_[second];
    triangles_.insert(triangles_.end(), {first, second, third});
    next_[first] = third;
  }
}

int PolygonTriangulator::turn(std::uint32_t corner) const {
  return orientation(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
}

/// An edge without length, or one that is walked back and forth.
bool PolygonTriangulator::encloses_nothing(std::uint32_t corner) const {
  const Point& after = points_[next_[corner]];
  return points_[corner] == after || points_[previous_[corner]] == after;
}

/// A corner that blocks the triangle at `corner`, or kNoId. If the rest of the polygon reaches into the
/// triangle, a reflex corner lies there, or a corner at the same place as one of the triangle's leads into
/// it.
std::uint32_t PolygonTriangulator::find_blocker(std::uint32_t corner, Rule rule) {
  std::uint32_t found = kNoId;
  if (blockers_.blocking() == 0) return found;
  const std::uint32_t before = previous_[corner], after = next_[corner];
  const Point &a = points_[before], &b = points_[corner], &c = points_[after];
  const int least = rule == Rule::no_contact ? 0 : 1;
  const auto keeps = [&](std::uint32_t other) {
    if (!blocking_[other] || other == before || other == corner || other == after) return false;
    const Point& p = points_[other];
    if (twin_[other]) --twins_left_;
    const bool blocks = p == a   ? enters(before, corner, after, other)
                        : p == b ? enters(corner, after, before, other)
                        : p == c ? enters(after, before, corner, other)
                                 : orientation(a, b, p) >= least && orientation(b, c, p) >= least &&
                                       orientation(c, a, p) >= least;
    if (blocks) found = other;
    return blocks;
  };
  // Mostly it is one of the two corners next to the triangle.
  if (!keeps(next_[after]) && !keeps(previous_[before])) blockers_.any_in(a, b, c, keeps);
  return found;
}

/// Whether an edge at `twin`, which stands at the same place as `corner`, leads between the directions to
/// `right` and, to the left of that, to `left`.
bool PolygonTriangulator::enters(std::uint32_t corner, std::uint32_t right, std::uint32_t left,
                                 std::uint32_t twin) const {
  for (const std::uint32_t to : {next_[twin], previous_[twin]})
    if (orientation(points_[corner], points_[right], points_[to]) > 0 &&
        orientation(points_[corner], points_[to], points_[left]) > 0)
      return true;
  return false;
}

/// If the corner no longer blocks, or has a twin and other edges now, those that it blocked are due again.
void PolygonTriangulator::update_blocking(std::uint32_t corner) {
  const bool blocks = twin_[corner] || turn(corner) <= 0;
  if (blocks != static_cast<bool>(blocking_[corner])) {
    blocking_[corner] = blocks;
    blockers_.change(corner, blocks ? 1 : -1);
  }
  if (!first_waiter_.empty() && (!blocks || twin_[corner])) try_again_those_kept_by(corner);
}

void PolygonTriangulator::find_blocking() {
  const std::size_t count = points_.size();
  first_waiter_.clear();
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
