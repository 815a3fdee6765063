#include "kernels/fractals/ifs.h"

#include <algorithm>
#include <numbers>

#include "kernels/exact/surface_uv.h"
#include "kernels/fractals/fractal_union.h"

namespace oktett {
namespace {

using IfsBall = IfsElement::Ball;

/// Pieces that rounding displaces a line by more than this part of are not divided.
constexpr double kMostMargin = 0x1p-8;
/// Parts looked at for bounds; those that are left count with their balls.
constexpr int kMostIfsSteps = 20000;

double base_radius(IfsShape::Base base) { return base == IfsShape::Base::ball ? 1 : std::sqrt(3.0); }

/// A ball about balls: its centre moves towards the farthest of them by ever smaller steps (M. Badoiu, K.
/// Clarkson: Smaller Core-Sets for Balls, 2003), and its radius holds them all wherever that ends.
IfsBall ball_about(const std::vector<IfsBall>& balls) {
  IfsBall all = balls[0];
  const auto far_side = [&](const IfsBall& b) { return length(b.center - all.center) + b.radius; };
  const auto farthest = [&] {
    return *std::max_element(balls.begin(), balls.end(),
                             [&](const IfsBall& a, const IfsBall& b) { return far_side(a) < far_side(b); });
  };
  for (int k = 1; k <= 200; ++k) {
    const IfsBall b = farthest();
    const double away = length(b.center - all.center);
    if (!(away > 0)) break;
    // The point of that ball farthest away.
    const Vec3d to = b.center + (b.center - all.center) * (b.radius / away);
    all.center = all.center + (to - all.center) / (k + 1);
  }
  all.radius = far_side(farthest()) * (1 + 0x1p-40);
  return all;
}

IfsBall image(const IfsElement::Map& map, const IfsBall& b) {
  return {map.to_parent.point(b.center), map.norm * b.radius};
}

/// Which piece it is does not matter for where it ends, but what the maps on the way to it are.
struct Depth {
  int level = 0;
  double size = 1;    ///< of the piece, at most
  double margin = 0;  ///< how far, in the piece's units, rounding may have displaced a line

  static Depth root(const IfsElement& e) { return {0, 1, e.rounding}; }
  Depth below(const IfsElement& e, const IfsElement::Map& map) const {
    return {level + 1, size * map.norm, margin * map.back + e.rounding};
  }
  bool is_leaf(const IfsElement& e) const {
    return level == e.depth() || size <= e.least || !(margin <= kMostMargin);
  }
};

/// The line in the space of one piece: the points o + (t - at) d, o nearest to the middle of the ball of its
/// level.
struct IfsNode {
  Vec3d o, d;
  double at, dd;
  Depth depth;
};

struct IfsTree {
  using Node = IfsNode;
  static constexpr int kMaxChildren = kMaxIfsMaps;
  const IfsElement& e;

  const IfsBall& ball(const Node& node) const { return e.balls[e.depth() - node.depth.level]; }
  bool is_leaf(const Node& node) const { return node.depth.is_leaf(e); }

  Node make(const Vec3d& o, const Vec3d& d, double at, const Depth& depth) const {
    Node node{o, d, at, dot(d, d), depth};
    const double along = dot(ball(node).center - o, d) / node.dd;
    node.o = o + d * along, node.at = at + along;
    return node;
  }
  bool bounds(const Node& node, UnionSpan& out) const {
    const Vec3d m = node.o - ball(node).center;
    const double radius = ball(node).radius + node.depth.margin, h2 = radius * radius - dot(m, m);
    if (!(h2 >= 0) || !(node.dd > 0)) return false;
    // With room for the rounding of t, which grows with where the line begins.
    const double h = std::sqrt(h2 / node.dd) + 0x1p-46 * std::abs(node.at);
    out = {node.at - h, node.at + h, 0};
    return true;
  }

  bool solid(const Node& node, UnionSpan& out) const {
    if (!e.every_level && !is_leaf(node)) return false;
    return e.base == IfsShape::Base::ball ? ball_span(node, out) : box_span(node, out);
  }
  static bool ball_span(const Node& node, UnionSpan& out) {
    const double along = -dot(node.o, node.d) / node.dd;
    const Vec3d p = node.o + node.d * along;
    const double h2 = (1 - dot(p, p)) / node.dd;
    if (!(h2 > 0)) return false;
    const double h = std::sqrt(h2);
    out = {node.at + (along - h), node.at + (along + h), 0};
    return out.near < out.far;
  }
  /// `child` becomes the faces of entry and exit, as parts: entry + 8 * exit.
  static bool box_span(const Node& node, UnionSpan& out) {
    double near = -HUGE_VAL, far = HUGE_VAL;
    int enter = 0, exit = 0;
    for (int k = 0; k < 3; ++k) {
      if (node.d[k] == 0) {
        if (!(-1 <= node.o[k] && node.o[k] < 1)) return false;
        continue;
      }
      const bool back = node.d[k] < 0;
      const double in = ((back ? 1 : -1) - node.o[k]) / node.d[k],
                   beyond = ((back ? -1 : 1) - node.o[k]) / node.d[k];
      if (in > near) near = in, enter = 1 + 2 * k + back;
      if (beyond < far) far = beyond, exit = 1 + 2 * k + !back;
    }
    if (!(near < far)) return false;
    out = {node.at + near, node.at + far, enter + 8 * exit};
    return out.near < out.far;
  }

  int children(const Node& node, UnionSpan* out) const {
    if (is_leaf(node)) return 0;
    int n = 0;
    for (int k = 0; k < static_cast<int>(e.maps.size()); ++k)
      if (bounds(child(node, k), out[n])) out[n++].child = k;
    return n;
  }
  Node child(const Node& node, int k) const {
    const IfsElement::Map& map = e.maps[k];
    return make(map.to_piece.point(node.o), map.to_piece.vector(node.d), node.at, node.depth.below(e, map));
  }
};

using IfsWalk = UnionWalk<IfsTree, kMaxIfsDepth>;

/// How far pieces reach along w, a unit vector, in the space of a node `level` levels down.
struct Support {
  const IfsElement& e;
  double slack, best;
  int steps = 0;

  void grow(double from, const Vec3d& w, const Depth& depth) {
    const bool leaf = depth.is_leaf(e);
    if (leaf || e.every_level) {
      const double base =
          e.base == IfsShape::Base::ball ? length(w) : std::abs(w.x) + std::abs(w.y) + std::abs(w.z);
      best = std::max(best, from + base);
    }
    if (leaf) return;
    std::pair<double, int> order[kMaxIfsMaps];
    const int n = static_cast<int>(e.maps.size());
    const IfsBall& below = e.balls[e.depth() - depth.level - 1];
    const auto turned = [&](int k) { return e.maps[k].to_parent.normal_by_inverse(w); };
    const auto start = [&](int k) {
      const auto& m = e.maps[k].to_parent.m;
      return from + (m[0][3] * w.x + m[1][3] * w.y + m[2][3] * w.z);
    };
    for (int k = 0; k < n; ++k) {
      const Vec3d v = turned(k);
      order[k] = {-(start(k) + dot(v, below.center) + length(v) * below.radius), k};
    }
    std::sort(order, order + n);
    for (int i = 0; i < n; ++i) {
      const auto& [down, k] = order[i];
      if (-down <= best + slack) return;
      if (++steps > kMostIfsSteps)
        best = std::max(best, -down);
      else
        grow(start(k), turned(k), depth.below(e, e.maps[k]));
    }
  }
};

double support(const IfsElement& e, const Vec3d& w) {
  const double l = length(w);
  if (!(l > 0)) return 0;
  Support s{e, e.balls.back().radius * 0x1p-11, -HUGE_VAL};
  s.grow(0, w / l, Depth::root(e));
  return (s.best + s.slack + e.balls.back().radius * 0x1p-40) * l;
}

/// Whether a piece holds p. After kMostUnionSteps `steps` none does.
bool holds(const IfsElement& e, const Vec3d& p, const Depth& depth, int& steps) {
  if (++steps > kMostUnionSteps) return false;
  const IfsBall& ball = e.balls[e.depth() - depth.level];
  const Vec3d m = p - ball.center;
  const double radius = ball.radius + depth.margin;
  if (dot(m, m) > radius * radius) return false;
  const bool leaf = depth.is_leaf(e);
  if (leaf || e.every_level) {
    const bool in_ball = dot(p, p) < 1;
    const bool in_box = -1 <= p.x && p.x < 1 && -1 <= p.y && p.y < 1 && -1 <= p.z && p.z < 1;
    if (e.base == IfsShape::Base::ball ? in_ball : in_box) return true;
  }
  if (leaf) return false;
  for (const IfsElement::Map& map : e.maps)
    if (holds(e, map.to_piece.point(p), depth.below(e, map), steps)) return true;
  return false;
}

/// `face` is 0 on a ball.
void tell_surface(const IfsElement& e, const FractalQuery& query, const IfsWalk::Place& place, int face,
                  FractalCrossing& c) {
  const IfsNode& node = place.node;
  const Vec3d p = node.o + node.d * (c.t - node.at);
  Vec3d n = p, tangent, bitangent;
  if (face == 0) {
    set_ball_uv(p, c, tangent, bitangent);
  } else {
    const int axis = (face - 1) / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    n = face_gradient(face);
    c.u = std::clamp(0.5 * (p[u] + 1), 0.0, 1.0), c.v = std::clamp(0.5 * (p[v] + 1), 0.0, 1.0);
    tangent[u] = 2, bitangent[v] = 2;
  }
  for (int k = place.level; k-- > 0;) {
    const IfsElement::Map& map = e.maps[place.path[k]];
    n = map.to_piece.normal_by_inverse(n);
    tangent = map.to_parent.vector(tangent), bitangent = map.to_parent.vector(bitangent);
    n = n / length(n);
  }
  c.normal = n, c.tangent = tangent, c.bitangent = bitangent, c.point = query.o + query.d * c.t;
}

}  // namespace

double Ifs::norm(const Affine& map) {
  // The norm of G = M^T M is that of G^(2^k) to the power of 2^-k, which any matrix norm bounds.
  double g[3][3], log_scale = 0, weight = 1;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      g[i][j] = map.m[0][i] * map.m[0][j] + map.m[1][i] * map.m[1][j] + map.m[2][i] * map.m[2][j];
  const auto rows = [&] {
    double most = 0;
    for (const auto& row : g) most = std::max(most, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
    return most;
  };
  for (int k = 0; k < 24; ++k) {
    const double most = rows();
    if (!(most > 0)) return 0;
    log_scale += weight * portable::log(most), weight *= 0.5;
    double next[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        next[i][j] = 0;
        for (int l = 0; l < 3; ++l) next[i][j] += (g[i][l] / most) * (g[l][j] / most);
      }
    std::copy(&next[0][0], &next[0][0] + 9, &g[0][0]);
  }
  log_scale += weight * portable::log(rows());
  return portable::exp(0.5 * log_scale) * (1 + 0x1p-40);
}

void Ifs::add(Pool& pool, const IfsShape& s, const ExactPlace& place) {
  if (s.maps.empty() || s.maps.size() > kMaxIfsMaps || s.depth > kMaxIfsDepth || !(s.least >= 0)) return;
  Element e{s.base, s.every_level, s.least, {}, {}, 0};
  for (const Affine& map : s.maps) {
    const double n = norm(map);
    if (!map.is_invertible() || !(n < 1)) return;
    const Affine inverse = map.inverse();
    e.maps.push_back({inverse, map, n, norm(inverse)});
  }
  const IfsBall base{{0, 0, 0}, base_radius(s.base)};
  e.balls.push_back(base);
  std::vector<IfsBall> parts;
  for (std::uint32_t k = 0; k < s.depth; ++k) {
    // With the base, as a piece may end at any level.
    parts.assign(1, base);
    for (const auto& map : e.maps) parts.push_back(image(map, e.balls.back()));
    e.balls.push_back(ball_about(parts));
  }
  // A few roundings in each level, of numbers as large as the ball and its distance.
  double size = 0;
  for (const IfsBall& b : e.balls) size = std::max(size, b.radius + length(b.center));
  e.rounding = 0x1p-49 * size;
  add_element(pool, e, place.to_world, place);
  const IfsBall& all = e.balls.back();
  const Vec3d r = Vec3d{1, 1, 1} * (all.radius + e.rounding);
  add_cell(pool, all.center - r, all.center + r);
}

int Ifs::find(const Element& e, const FractalQuery& query, FractalCrossing* out, int room) {
  const Vec3d sum = query.o + query.d;
  if (!std::isfinite(sum.x + sum.y + sum.z) || !(dot(query.d, query.d) > 0)) return 0;
  const IfsTree tree{e};
  const IfsNode root = tree.make(query.o, query.d, 0, Depth::root(e));
  UnionSpan bounds;
  if (!tree.bounds(root, bounds)) return 0;
  IfsWalk walk(tree, root, bounds, e.depth());
  return find_in_union(walk, query, out, room, [&](const IfsWalk::Place& place, FractalCrossing& c) {
    UnionSpan span{};
    tree.solid(place.node, span);
    tell_surface(e, query, place, c.turn < 0 ? span.child % 8 : span.child / 8, c);
  });
}

bool Ifs::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  int steps = 0;
  const bool held = holds(pool.elements[i], p, Depth::root(pool.elements[i]), steps);
  if (steps > kMostUnionSteps) interval::count_uncertified(1);
  return held;
}

Box Ifs::world_bounds(const Pool& pool, std::size_t i) {
  const Element& e = pool.elements[i];
  return bounds_by_support(pool.frames[i], 0x1p-44, e.balls.back().radius,
                           [&](const Vec3d& w) { return support(e, w); });
}

}  // namespace oktett
