#include "kernels/fractals/terrain.h"

#include <algorithm>

#include "core/math.h"
#include "core/random.h"

namespace oktett {
namespace {

/// Cells looked at for bounds; those that are left count with what bounds them.
constexpr int kMostBoundSteps = 20000;

/// A cell by its corner with the least x and z, in units of the finest cells, and its heights: at (0, 0), (1,
/// 0), (0, 1) and (1, 1) in x and z.
struct TerrainCell {
  int level = 0;
  double x = 0, z = 0;
  double h[4];

  double lowest() const { return std::min({h[0], h[1], h[2], h[3]}); }
  double highest() const { return std::max({h[0], h[1], h[2], h[3]}); }
};

TerrainCell whole(const TerrainElement& e) {
  TerrainCell c;
  for (int k = 0; k < 4; ++k)
    c.h[k] = e.step[0] * Terrain::displacement(e.seed, 0, static_cast<std::uint64_t>(k & 1),
                                               static_cast<std::uint64_t>(k >> 1));
  return c;
}

/// One of the four parts of a cell, right and far being 0 or 1.
TerrainCell part(const TerrainElement& e, const TerrainCell& c, int right, int far) {
  TerrainCell p;
  p.level = c.level + 1;
  const double size = std::ldexp(e.side, -p.level), step = e.step[p.level];
  p.x = c.x + right * size, p.z = c.z + far * size;
  // The cell's corner in units of this level's cells.
  const auto i = static_cast<std::uint64_t>(c.x / size), k = static_cast<std::uint64_t>(c.z / size);
  const auto moved = [&](int di, int dk) {
    return step * Terrain::displacement(e.seed, p.level, i + static_cast<std::uint64_t>(di),
                                        k + static_cast<std::uint64_t>(dk));
  };
  const auto middle = [](double a, double b) { return (a + b) * 0.5; };
  const int corner = right + 2 * far, beside = corner ^ 1, across = corner ^ 2, opposite = corner ^ 3;
  p.h[corner] = c.h[corner];
  p.h[beside] = middle(c.h[corner], c.h[beside]) + moved(1, 2 * far);
  p.h[across] = middle(c.h[corner], c.h[across]) + moved(2 * right, 1);
  p.h[opposite] = middle(middle(c.h[0], c.h[1]), middle(c.h[2], c.h[3])) + moved(1, 1);
  return p;
}

/// An upper bound of all heights.
struct Highest {
  const TerrainElement& e;
  double slack, best = -kInfinity;
  int steps = 0;

  double bound(const TerrainCell& c) const { return c.highest() + e.rest[c.level]; }
  void look(const TerrainCell& c) {
    best = std::max(best, c.highest());
    if (c.level == e.depth) return;
    std::pair<double, int> order[4];
    for (int k = 0; k < 4; ++k) order[k] = {-bound(part(e, c, k & 1, k >> 1)), k};
    std::sort(order, order + 4);
    for (const auto& [down, k] : order) {
      if (-down <= best + slack) return;
      if (++steps > kMostBoundSteps)
        best = std::max(best, -down);
      else
        look(part(e, c, k & 1, k >> 1));
    }
  }
};

double highest(const TerrainElement& e) {
  const double all = e.step[0] + e.rest[0];
  Highest h{e, all * 0x1p-9};
  h.look(whole(e));
  return h.best + h.slack + all * 0x1p-40;
}

/// Heights in a finest cell: two triangles, which meet where x and z have grown by the same.
struct Triangles {
  const TerrainCell& c;

  static double between(double a, double b, double w) { return a + (b - a) * std::clamp(w, 0.0, 1.0); }
  bool is_right(double x, double z) const { return x - c.x >= z - c.z; }
  double slope_x(bool right) const { return right ? c.h[1] - c.h[0] : c.h[3] - c.h[2]; }
  double slope_z(bool right) const { return right ? c.h[3] - c.h[1] : c.h[2] - c.h[0]; }
  double height(double x, double z, bool right) const {
    return c.h[0] + slope_x(right) * (x - c.x) + slope_z(right) * (z - c.z);
  }
  /// On the edge where the cell begins (side 0) or ends (1) along an axis.
  double on_edge(int axis, int side, double x, double z) const {
    if (axis == 0) return between(c.h[side], c.h[side + 2], z - c.z);
    return between(c.h[2 * side], c.h[2 * side + 1], x - c.x);
  }
  double on_diagonal(double x) const { return between(c.h[0], c.h[3], x - c.x); }
};

using Gate = GridLine::Gate;

class TerrainWalk {
 public:
  TerrainWalk(const TerrainElement& e, const FractalQuery& query, FractalCrossing* out, int room)
      : e_(e), query_(query), line_(query, {1, 0, 1}, {e.side * 0.5, 1, e.side * 0.5}), turns_(out, room) {}

  int find() {
    if (!line_.clip({0, e_.base, 0}, {e_.side, e_.high, e_.side}, begin_, end_) || !(query_.a < end_.t))
      return 0;
    double t = std::max(query_.a, begin_.t);
    known_ = query_.a < begin_.t;
    path_[0] = whole(e_), exits_[0] = exit_of(path_[0]);
    for (int level = 0; level >= 0 && t < end_.t && t <= query_.b && !turns_.full();) {
      const int turn = descend(t, level);
      if (turn == 0)
        cross(path_[level], exits_[level]);
      else
        settle(turn < 0, t, path_[level]);
      t = exits_[level].t;
      turns_.pass(std::min(t, end_.t));
      while (level >= 0 && !(t < exits_[level].t)) --level;
    }
    if (turns_.inside() && end_.t <= query_.b && !(t < end_.t)) turns_.leave(wall(end_, 1));
    turns_.finish();
    return turns_.count();
  }

 private:
  Gate exit_of(const TerrainCell& c) const {
    const double size = std::ldexp(e_.side, -c.level);
    Gate out;
    for (const int k : {0, 2}) {
      const double low = k == 0 ? c.x : c.z;
      if (line_.way[k] == 0) continue;
      const double t = line_.at(k, line_.way[k] > 0 ? low + size : low);
      if (t < out.t) out = {t, k};
    }
    return out;
  }

  /// To the largest cell that the line, right after t, is surely above (1) or below (-1) of, or else to the
  /// finest one (0).
  int descend(double t, int& level) {
    for (;; ++level) {
      const TerrainCell& c = path_[level];
      const double u = line_.place(1, t), v = line_.place(1, std::min(exits_[level].t, end_.t));
      const double slack = 0x1p-44 * (std::abs(u) + std::abs(v) + e_.step[0] + e_.rest[0]);
      if (std::min(u, v) > c.highest() + e_.rest[level] + slack) return 1;
      if (std::max(u, v) < c.lowest() - e_.rest[level] - slack) return -1;
      if (level == e_.depth) return 0;
      const double half = std::ldexp(e_.side, -level - 1);
      path_[level + 1] = part(e_, c, line_.is_beyond(0, c.x + half, t), line_.is_beyond(2, c.z + half, t));
      exits_[level + 1] = exit_of(path_[level + 1]);
    }
  }

  /// From t on the line is inside or not: walls where the walk begins, else what two cells disagree about by
  /// rounding.
  void settle(bool inside, double t, const TerrainCell& c) {
    if (!known_) {
      known_ = true;
      return turns_.begin(inside);
    }
    if (inside == turns_.inside()) return;
    if (t == begin_.t)
      turns_.enter(wall(begin_, -1));
    else
      turn_at(t, c, true);
  }
  void turn_at(double t, const TerrainCell& c, bool right) {
    if (turns_.inside())
      turns_.leave(slope(c, right, t, 1));
    else
      turns_.enter(slope(c, right, t, -1));
  }

  /// The walk through one of the finest cells, over each of whose triangles the height along the line is
  /// linear. The ends of the pieces are on edges, where all who share them find the same.
  void cross(const TerrainCell& c, const Gate& exit) {
    const Triangles triangles{c};
    Gate near{-kInfinity};
    for (const int k : {0, 2}) {
      const double low = k == 0 ? c.x : c.z;
      if (line_.way[k] == 0) continue;
      const double t = line_.at(k, line_.way[k] > 0 ? low : low + 1);
      if (t > near.t) near = {t, k};
    }
    const double first = std::max(near.t, begin_.t), last = std::min(exit.t, end_.t);
    const auto is_right = [&](double t) { return triangles.is_right(line_.place(0, t), line_.place(2, t)); };
    const auto above = [&](double t, bool right) {
      return line_.place(1, t) - triangles.height(line_.place(0, t), line_.place(2, t), right);
    };
    const auto above_edge = [&](const Gate& gate, int side) {
      return line_.place(1, gate.t) -
             triangles.on_edge(gate.axis, side, line_.place(0, gate.t), line_.place(2, gate.t));
    };
    double t[3] = {first, last, last}, f[3];
    int pieces = 1;
    const double diagonal = ((c.x - c.z) - (line_.o.x - line_.o.z)) / (line_.d.x - line_.d.z);
    if (first < diagonal && diagonal < last) t[1] = diagonal, pieces = 2;
    const auto in_piece = [&](int k) { return is_right(t[k] + (t[k + 1] - t[k]) * 0.5); };
    f[0] = near.t == first ? above_edge(near, line_.way[near.axis] > 0 ? 0 : 1) : above(first, in_piece(0));
    if (pieces == 2) f[1] = line_.place(1, t[1]) - triangles.on_diagonal(line_.place(0, t[1]));
    f[pieces] = exit.t == last ? above_edge(exit, line_.way[exit.axis] > 0 ? 1 : 0)
                               : above(last, in_piece(pieces - 1));
    settle(f[0] < 0, first, c);
    for (int k = 0; k < pieces; ++k) {
      if ((f[k] < 0) == (f[k + 1] < 0)) continue;
      const double root = std::clamp(t[k] + (t[k + 1] - t[k]) * (f[k] / (f[k] - f[k + 1])), t[k], t[k + 1]);
      if (root <= query_.a)
        turns_.begin(f[k + 1] < 0);
      else if (root <= query_.b)
        turn_at(root, c, in_piece(k));
    }
  }

  FractalCrossing wall(const Gate& gate, double turn) const {
    const double out = line_.way[gate.axis] * turn;
    const double lo = gate.axis == 1 ? e_.base : -1, hi = gate.axis == 1 ? e_.high : 1;
    return wall_crossing(query_, gate, out > 0 ? hi : lo, out, turn);
  }

  FractalCrossing slope(const TerrainCell& c, bool right, double t, double turn) const {
    FractalCrossing found;
    found.t = t, found.turn = turn;
    if (!query_.with_surface) return found;
    const double dx = Triangles{c}.slope_x(right) * (e_.side * 0.5),
                 dz = Triangles{c}.slope_z(right) * (e_.side * 0.5);
    found.point = query_.o + query_.d * t, found.normal = {-dx, 1, -dz};
    found.u = 0.5 * (found.point.x + 1), found.v = 0.5 * (found.point.z + 1), found.tangent = {2, 2 * dx, 0},
    found.bitangent = {0, 2 * dz, 2};
    return found;
  }

  const TerrainElement& e_;
  const FractalQuery& query_;
  const GridLine line_;
  TurnList turns_;
  bool known_ = false;  // whether the list knows where it begins
  Gate begin_, end_;
  TerrainCell path_[kMaxTerrainDepth + 1];
  Gate exits_[kMaxTerrainDepth + 1];
};

}  // namespace

double Terrain::displacement(std::uint32_t seed, int level, std::uint64_t i, std::uint64_t k) {
  const std::uint64_t key = mix_bits(std::uint64_t{seed} << 8 | static_cast<std::uint64_t>(level));
  return static_cast<double>(mix_bits(mix_bits(key + i) + k) >> 11) * 0x1p-52 - 1;
}

void Terrain::add(Pool& pool, const TerrainShape& s, const ExactPlace& place) {
  if (s.depth > kMaxTerrainDepth || !(s.height >= 0 && s.roughness >= 0 && s.roughness < 1)) return;
  if (!std::isfinite(s.height) || !std::isfinite(s.base)) return;
  Element e{};
  e.depth = static_cast<int>(s.depth), e.seed = s.seed;
  e.side = std::ldexp(1.0, e.depth), e.base = s.base;
  e.step[0] = s.height;
  for (int k = 1; k <= e.depth; ++k) e.step[k] = e.step[k - 1] * s.roughness;
  for (int k = e.depth; k-- > 0;) e.rest[k] = e.rest[k + 1] + e.step[k + 1];
  e.high = highest(e);
  if (!(e.base < e.high)) return;
  add_element(pool, e, place.to_world, place);
  add_cell(pool, {-1, e.base, -1}, {1, e.high, 1});
}

int Terrain::find(const Element& element, const FractalQuery& query, FractalCrossing* out, int room) {
  const Vec3d sum = query.o + query.d;
  if (!std::isfinite(sum.x + sum.y + sum.z) || query.d == Vec3d{}) return 0;
  return TerrainWalk(element, query, out, room).find();
}

bool Terrain::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const Element& e = pool.elements[i];
  const double x = (p.x + 1) * (e.side * 0.5), z = (p.z + 1) * (e.side * 0.5);
  if (!(0 <= x && x < e.side && 0 <= z && z < e.side && e.base <= p.y)) return false;
  TerrainCell c = whole(e);
  while (c.level < e.depth) {
    const double half = std::ldexp(e.side, -c.level - 1);
    c = part(e, c, c.x + half <= x, c.z + half <= z);
  }
  const Triangles triangles{c};
  return p.y < triangles.height(x, z, triangles.is_right(x, z));
}

}  // namespace oktett
