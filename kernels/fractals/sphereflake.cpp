#include "kernels/fractals/sphereflake.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/four.h"
#include "kernels/exact/surface_uv.h"
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

/// The y axes of the children in columns, four to a group; the last group has empty lanes.
constexpr int kGroups = (kChildren + 3) / 4;
struct alignas(16) Axes {
  float x[4 * kGroups], y[4 * kGroups], z[4 * kGroups];
};
Axes make_axes() {
  Axes axes{};
  for (int k = 0; k < kChildren; ++k) {
    const Vec3f y(kFrames[k].y);
    axes.x[k] = y.x, axes.y[k] = y.y, axes.z[k] = y.z;
  }
  return axes;
}
const Axes kAxes = make_axes();

/// In units of a ball, by how much more than the rounding of floats its children's bounds are larger: all
/// lengths there are below 4.
constexpr float kFloatMargin = 0x1p-16f;

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

  /// A child and its descendants are in a ball about it, between two planes across its y axis. In floats,
  /// with room for their rounding: what a ray meets is decided by solid() alone.
  int children(const Node& node, UnionSpan* out) const {
    const int below = node.generation + 1;
    const double size = e.radius[node.generation];
    const auto away = static_cast<float>(1 + e.ratio), reach = static_cast<float>(e.ratio * e.reach[below]);
    const Vec3f p(node.p), u(node.u);
    const float rest = reach * reach - dot(p, p) - away * away + kFloatMargin;
    const Four low(away + static_cast<float>(e.ratio * e.low[below]) - kFloatMargin);
    const Four high(away + static_cast<float>(e.ratio * e.high[below]) + kFloatMargin);
    int n = 0;
    for (int group = 0; group < kGroups; ++group) {
      const int first = 4 * group;
      const Four x = Four::load(kAxes.x + first), y = Four::load(kAxes.y + first),
                 z = Four::load(kAxes.z + first);
      const Four yp = x * Four(p.x) + y * Four(p.y) + z * Four(p.z);
      const Four along = (x * Four(u.x) + y * Four(u.y) + z * Four(u.z)) * Four(away);
      const Four h2 = Four(rest) + Four(2 * away) * yp + along * along;
      if (!any(h2 > Four(0.0f))) continue;
      const Four h = sqrt(max(h2, Four(0.0f))) + Four(kFloatMargin), inverse = Four(away) / along;
      const Four a = (low - yp) * inverse, b = (high - yp) * inverse;
      // A line that lies in one of the planes divides 0 by 0. NaN leaves the range of the ball, or no range:
      // both are right, because the planes stand apart from what is between them.
      const Four near = max(min(a, b) - Four(kFloatMargin), along - h),
                 far = min(max(a, b) + Four(kFloatMargin), along + h);
      unsigned met = bits((h2 > Four(0.0f)) & (near <= far)) & ((1u << std::min(4, kChildren - first)) - 1);
      if (met == 0) continue;
      float from[4], to[4];
      near.store(from), far.store(to);
      for (; met != 0; met &= met - 1) {
        const int k = __builtin_ctz(met);
        out[n++] = {to_t(node.s + from[k] * size), to_t(node.s + to[k] * size), first + k};
      }
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

/// Raises `best` to how far a ball and its descendants reach along the unit vector `w`, from where `from` is
/// its centre: by no less than the truth minus `slack`. Lengths are those of the first ball.
void grow_support(const SphereflakeElement& e, int generation, double from, const Vec3d& w, double slack,
                  double& best) {
  const double size = e.radius[generation];
  best = std::max(best, from + size);
  if (generation == e.depth) return;
  std::array<std::pair<double, int>, kChildren> order;
  for (int k = 0; k < kChildren; ++k) order[k] = {-dot(kFrames[k].y, w), k};
  std::sort(order.begin(), order.end());
  const double reach = e.radius[generation + 1] * e.reach[generation + 1];
  for (const auto& [down, k] : order) {
    const double at = from - down * (1 + e.ratio) * size;
    if (at + reach <= best + slack) return;
    grow_support(e, generation + 1, at, kFrames[k].inwards(w), slack, best);
  }
}

/// How far a ball of a generation and its descendants reach along the unit vector `w`, from its centre in
/// units of its radius: no less, and more by no more than 1/1000.
double reach_along(const SphereflakeElement& e, int generation, const Vec3d& w) {
  const double size = e.radius[generation], slack = 0x1p-11;
  double best = 0;
  grow_support(e, generation, 0, w, slack * size, best);
  return best / size + slack + 0x1p-40;
}

/// How far it reaches along `direction`, from its centre in lengths of the direction: no less, and more by
/// no more than 1/1000.
double support(const SphereflakeElement& e, const Vec3d& direction) {
  const double l = length(direction);
  return l > 0 ? reach_along(e, 0, direction / l) : 0;
}

/// Raises `best` to the distance of the farthest point of a ball and its descendants from the origin, up to
/// 2^-11. `centre` is that of the ball, whose axes are those of `frame`.
void grow_reach(const SphereflakeElement& e, int generation, const Vec3d& centre, const Frame& frame,
                double size, double& best) {
  const double away = length(centre);
  best = std::max(best, away + size);
  if (generation == e.depth || away + size * e.reach[generation] <= best + 0x1p-11) return;
  for (const Frame& f : kFrames) {
    const Frame turned{frame.outwards(f.x), frame.outwards(f.y), frame.outwards(f.z)};
    grow_reach(e, generation + 1, centre + turned.y * ((1 + e.ratio) * size), turned, size * e.ratio, best);
  }
}

/// Sets the bounds of all generations. That of a generation helps to find that of the one before.
void set_bounds(SphereflakeElement& e) {
  for (int g = e.depth; g >= 0; --g) {
    const bool last = g == e.depth;
    e.reach[g] = with_margin(last ? 1 : 1 + e.ratio + e.ratio * e.reach[g + 1], e.radius[g]);
    if (!last) {
      double best = 1;
      grow_reach(e, g, {0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1, best);
      e.reach[g] = std::min(e.reach[g], with_margin(best + 0x1p-11 + 0x1p-40, e.radius[g]));
    }
    e.low[g] = -with_margin(reach_along(e, g, {0, -1, 0}), e.radius[g]);
    e.high[g] = with_margin(reach_along(e, g, {0, 1, 0}), e.radius[g]);
  }
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
  set_bounds(e);
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
    Vec3d east, north, at{0, 0, 0};
    set_ball_uv(n, c, east, north);
    for (int g = place.level; g-- > 0;) {
      const Frame& f = kFrames[place.path[g]];
      n = f.outwards(n), east = f.outwards(east), north = f.outwards(north);
      at = f.y * (1 + e.ratio) + f.outwards(at) * e.ratio;
    }
    c.normal = n, c.point = at + n * e.radius[place.level];
    c.tangent = east * e.radius[place.level], c.bitangent = north * e.radius[place.level];
  });
}

bool Sphereflake::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  return holds(pool.elements[i], 0, p);
}

Box Sphereflake::world_bounds(const Pool& pool, std::size_t i) {
  return bounds_by_support(pool.frames[i], 0x1p-45, 1,
                           [&](const Vec3d& w) { return support(pool.elements[i], w) * length(w); });
}

}  // namespace oktett
