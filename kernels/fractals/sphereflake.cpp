#include "kernels/fractals/sphereflake.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "kernels/exact/round_uv.h"
#include "kernels/fractals/fractal_union.h"

namespace oktett {
namespace {

constexpr int kChildren = 9;
/// Smaller balls are left out: they are lost in the rounding of t long before.
constexpr double kLeastRadius = 0x1p-40;

/// Rounding displaces a line by less than 2^-46 of the first ball; bounds of a generation are larger by that.
double with_margin(double reach, double radius) { return reach + 0x1p-46 / radius; }

/// A child's space: its y axis points away from the parent, its x axis east.
struct Frame {
  Vec3d x, y, z;

  Vec3d inwards(const Vec3d& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3d outwards(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
};

std::array<Frame, kChildren> make_frames() {
  const double h = std::sqrt(0.75), third = std::sqrt(1.0 / 3), up = std::sqrt(2.0 / 3);
  const double ring[6][2] = {{1, 0}, {0.5, h}, {-0.5, h}, {-1, 0}, {-0.5, -h}, {0.5, -h}};
  const double crown[3][2] = {{h, 0.5}, {-h, 0.5}, {0, -1}};
  std::array<Frame, kChildren> frames;
  for (int k = 0; k < kChildren; ++k) {
    const double* const at = k < 6 ? ring[k] : crown[k - 6];
    const double across = k < 6 ? 1 : third, high = k < 6 ? 0 : up;
    const Vec3d x{-at[1], 0, at[0]}, y{at[0] * across, high, at[1] * across};
    frames[k] = {x, y, cross(x, y)};
  }
  return frames;
}
const std::array<Frame, kChildren> kFrames = make_frames();

/// The line in the space of one ball: the points p + x u, with p nearest to the ball's centre; s is where p
/// is, in units of the first ball.
struct FlakeNode {
  Vec3d p, u;
  double s;
  int generation;
};

struct FlakeTree {
  using Node = FlakeNode;
  static constexpr int kMaxChildren = kChildren;
  const SphereflakeElement& e;
  double shift, scale;  ///< t = shift + s * scale

  double to_t(double s) const { return shift + s * scale; }

  /// Where the line is within `radius` of the ball's centre.
  bool span(const Node& node, double radius, UnionSpan& out) const {
    const double h2 = radius * radius - dot(node.p, node.p);
    if (!(h2 > 0)) return false;
    const double h = std::sqrt(h2) * e.radius[node.generation];
    out = {to_t(node.s - h), to_t(node.s + h), 0};
    return true;
  }
  /// What rounding leaves no length of is not met.
  bool solid(const Node& node, UnionSpan& out) const { return span(node, 1, out) && out.near < out.far; }

  int children(const Node& node, UnionSpan* out) const {
    const double away = 1 + e.ratio, size = e.radius[node.generation];
    const double reach = e.ratio * e.reach[node.generation + 1], pp = dot(node.p, node.p);
    int n = 0;
    for (int k = 0; k < kChildren; ++k) {
      const Vec3d& y = kFrames[k].y;
      const double yp = dot(y, node.p), yu = dot(y, node.u);
      const double off = pp - 2 * away * yp + away * away * (1 - yu * yu), h2 = reach * reach - off;
      if (!(h2 > 0)) continue;
      const double h = std::sqrt(h2), along = away * yu;
      out[n++] = {to_t(node.s + (along - h) * size), to_t(node.s + (along + h) * size), k};
    }
    return n;
  }

  Node child(const Node& node, int k) const {
    const Frame& f = kFrames[k];
    const Vec3d q = f.inwards(node.p - f.y * (1 + e.ratio)) / e.ratio, u = f.inwards(node.u);
    const double along = dot(q, u);
    return {q - u * along, u, node.s - along * e.radius[node.generation + 1], node.generation + 1};
  }
};

using Walk = UnionWalk<FlakeTree, kMaxSphereflakeDepth>;

void grow_support(const SphereflakeElement& e, int generation, double from, const Vec3d& w, double& best) {
  const double size = e.radius[generation];
  best = std::max(best, from + size);
  if (generation == e.depth) return;
  std::array<std::pair<double, int>, kChildren> order;
  for (int k = 0; k < kChildren; ++k) order[k] = {-dot(kFrames[k].y, w), k};
  std::sort(order.begin(), order.end());
  const double reach = e.radius[generation + 1] * e.reach[generation + 1];
  for (const auto& [down, k] : order) {
    const double at = from - down * (1 + e.ratio) * size;
    if (at + reach <= best + 0x1p-11) return;
    grow_support(e, generation + 1, at, kFrames[k].inwards(w), best);
  }
}

/// How far it reaches along `direction`, from its centre in lengths of the direction: no less, and more by
/// no more than 1/1000.
double support(const SphereflakeElement& e, const Vec3d& direction) {
  const double l = length(direction);
  if (!(l > 0)) return 0;
  double best = 0;
  grow_support(e, 0, 0, direction / l, best);
  return best + 0x1p-11 + 0x1p-40;
}

bool holds(const SphereflakeElement& e, int generation, const Vec3d& p) {
  const double d2 = dot(p, p);
  if (d2 < 1) return true;
  if (generation == e.depth || d2 > e.reach[generation] * e.reach[generation]) return false;
  for (const Frame& f : kFrames)
    if (holds(e, generation + 1, f.inwards(p - f.y * (1 + e.ratio)) / e.ratio)) return true;
  return false;
}

}  // namespace

void Sphereflake::add(Pool& pool, const SphereflakeShape& s, const ExactPlace& place) {
  if (!(s.ratio > 0 && s.ratio <= 0.5) || s.depth > kMaxSphereflakeDepth) return;
  Element e{};
  e.ratio = s.ratio, e.radius[0] = 1;
  for (; e.depth < static_cast<int>(s.depth); ++e.depth) {
    const double next = e.radius[e.depth] * e.ratio;
    if (next < kLeastRadius) break;
    e.radius[e.depth + 1] = next;
  }
  e.reach[e.depth] = with_margin(1, e.radius[e.depth]);
  for (int g = e.depth; g-- > 0;)
    e.reach[g] = with_margin(1 + e.ratio + e.ratio * e.reach[g + 1], e.radius[g]);
  add_element(pool, e, place.to_world, place);
  const auto side = [&](const Vec3d& w) { return support(pool.elements.back(), w); };
  add_cell(pool, {-side({-1, 0, 0}), -side({0, -1, 0}), -side({0, 0, -1})},
           {side({1, 0, 0}), side({0, 1, 0}), side({0, 0, 1})});
}

int Sphereflake::find(const Element& e, const FractalQuery& query, FractalCrossing* out, int room) {
  const double dd = dot(query.d, query.d), scale = 1 / std::sqrt(dd), shift = -(dot(query.o, query.d) / dd);
  if (!(scale > 0 && std::isfinite(scale) && std::isfinite(shift))) return 0;
  const FlakeTree tree{e, shift, scale};
  const Vec3d u = query.d * scale, near = query.o + query.d * shift;
  const double along = dot(near, u);
  const FlakeNode root{near - u * along, u, -along, 0};
  UnionSpan bounds;
  if (!tree.span(root, e.reach[0], bounds)) return 0;
  Walk walk(tree, root, bounds, e.depth);
  return find_in_union(walk, query, out, room, [&](const Walk::Place& place, FractalCrossing& c) {
    const double h = std::sqrt(1 - dot(place.node.p, place.node.p));
    Vec3d n = place.node.p + place.node.u * (h * c.turn);
    const double across = std::sqrt(n.x * n.x + n.z * n.z);
    c.u = turn_of(n.z, n.x);
    c.v = 0.5 + portable::atan2(n.y, across) / std::numbers::pi;
    Vec3d east{-n.z, 0, n.x}, at{0, 0, 0};
    for (int g = place.level; g-- > 0;) {
      const Frame& f = kFrames[place.path[g]];
      n = f.outwards(n), east = f.outwards(east);
      at = f.y * (1 + e.ratio) + f.outwards(at) * e.ratio;
    }
    c.normal = n, c.point = at + n * e.radius[place.level];
    c.tangent = east * (2 * std::numbers::pi * e.radius[place.level]);
  });
}

bool Sphereflake::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  return holds(pool.elements[i], 0, p);
}

Box Sphereflake::world_bounds(const Pool& pool, std::size_t i) {
  return bounds_by_support(pool.frames[i].to_world, 0x1p-45, 1,
                           [&](const Vec3d& w) { return support(pool.elements[i], w) * length(w); });
}

}  // namespace oktett
