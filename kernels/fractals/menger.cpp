#include "kernels/fractals/menger.h"

#include <algorithm>
#include <limits>

namespace oktett {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// A line through the grid; cells have size 1.
class GridLine {
 public:
  GridLine(const FractalQuery& query, double side) {
    for (int k = 0; k < 3; ++k) {
      o_[k] = (query.o[k] + 1) * (side * 0.5);
      const double d = query.d[k] * (side * 0.5);
      inverse_[k] = 1 / d;
      // What no double can tell from parallel is.
      way_[k] = !(std::abs(inverse_[k]) < kInf) || inverse_[k] == 0 ? 0 : d > 0 ? 1 : -1;
    }
  }
  int way(int axis) const { return way_[axis]; }
  /// Where the line meets a plane that it is not parallel to. Monotonous in the plane.
  double at(int axis, double plane) const { return (plane - o_[axis]) * inverse_[axis]; }
  /// Which of the three slabs of width `size` from `low` on the line is in right after t.
  int slab(int axis, double low, double size, double t) const {
    const double first = low + size, second = first + size;
    if (way_[axis] > 0) return (at(axis, first) <= t) + (at(axis, second) <= t);
    if (way_[axis] < 0) return 2 - (at(axis, second) <= t) - (at(axis, first) <= t);
    return (first <= o_[axis]) + (second <= o_[axis]);
  }
  bool is_between(int axis, double low, double high) const { return low <= o_[axis] && o_[axis] < high; }
  /// The part that looks against the line, or along it, on a plane across `axis`.
  double face(int axis, double turn) const { return 1 + 2 * axis + (way_[axis] * turn > 0); }

 private:
  Vec3d o_, inverse_;
  int way_[3];
};

/// Where the line leaves a cell, or enters it.
struct Gate {
  double t = kInf;
  int axis = 0;
  double plane = 0;
};

struct Cell {
  Vec3d low;
  Gate exit;
};

/// Powers of 3.
struct Powers {
  double at[kMaxMengerDepth + 1];
  constexpr Powers() : at{} {
    at[0] = 1;
    for (int k = 1; k <= kMaxMengerDepth; ++k) at[k] = 3 * at[k - 1];
  }
};
constexpr Powers kPowers;

class MengerWalk {
 public:
  MengerWalk(const MengerElement& e, const FractalQuery& query)
      : e_(e), query_(query), line_(query, e.side) {}

  int find(FractalCrossing* out, int room) {
    TurnList turns(out, room);
    Gate gate;  // how the current cell is entered
    if (!enter(gate)) return 0;
    bool known = query_.a < gate.t;  // begins outside
    if (!known) gate.t = query_.a;
    int level = 0;
    while (level >= 0 && gate.t <= query_.b && !turns.full()) {
      Cell cell;
      const bool solid = descend(gate.t, level, cell);
      if (!known)
        known = true, turns.begin(solid);
      else if (solid && !turns.inside())
        turns.enter(turn_at(gate, -1));
      else if (!solid && turns.inside())
        turns.leave(turn_at(gate, 1));
      gate = cell.exit;
      while (level >= 0 && !(gate.t < path_[level].exit.t)) --level;
      turns.pass(gate.t);
    }
    if (level < 0 && turns.inside() && gate.t <= query_.b) turns.leave(turn_at(gate, 1));
    turns.finish();
    return turns.count();
  }

 private:
  /// The way into the whole; false if there is none.
  bool enter(Gate& in) {
    in.t = -kInf;
    Cell& root = path_[0];
    root = {{0, 0, 0}, {}};
    for (int k = 0; k < 3; ++k) {
      const int way = line_.way(k);
      if (way == 0) {
        if (!line_.is_between(k, 0, e_.side)) return false;
        continue;
      }
      const double near = way > 0 ? 0 : e_.side, t = line_.at(k, near);
      if (!(t <= in.t)) in = {t, k, near};
    }
    set_exit(root, e_.side);
    return in.t < root.exit.t && root.exit.t < kInf && query_.a < root.exit.t;
  }

  void set_exit(Cell& cell, double size) const {
    cell.exit = {};
    for (int k = 0; k < 3; ++k) {
      const int way = line_.way(k);
      if (way == 0) continue;
      const double plane = way > 0 ? cell.low[k] + size : cell.low[k], t = line_.at(k, plane);
      if (t < cell.exit.t) cell.exit = {t, k, plane};
    }
  }

  /// The largest empty cell, or else the smallest cell, that the line is in right after t, from path_[level]
  /// downwards. Returns whether it is solid.
  bool descend(double t, int& level, Cell& cell) {
    for (;;) {
      if (level == e_.depth) {
        cell = path_[level];
        return true;
      }
      const double size = size_of(level + 1);
      int middles = 0;
      for (int k = 0; k < 3; ++k) {
        const int slab = line_.slab(k, path_[level].low[k], size, t);
        middles += slab == 1;
        cell.low[k] = path_[level].low[k] + slab * size;
      }
      set_exit(cell, size);
      if (middles >= 2) return false;
      path_[++level] = cell;
    }
  }

  double size_of(int level) const { return kPowers.at[e_.depth - level]; }

  FractalCrossing turn_at(const Gate& gate, double turn) const {
    FractalCrossing c;
    c.t = gate.t, c.turn = turn, c.part = line_.face(gate.axis, turn);
    if (!query_.with_surface) return c;
    c.point = query_.o + query_.d * gate.t;
    c.point[gate.axis] = gate.plane * (2 / e_.side) - 1;
    c.normal[gate.axis] = line_.way(gate.axis) * turn;
    const int u = (gate.axis + 1) % 3, v = (gate.axis + 2) % 3;
    c.u = 0.5 * (c.point[u] + 1), c.v = 0.5 * (c.point[v] + 1);
    c.tangent[u] = 2;
    return c;
  }

  const MengerElement& e_;
  const FractalQuery& query_;
  const GridLine line_;
  Cell path_[kMaxMengerDepth + 1];
};

}  // namespace

void Menger::add(Pool& pool, const MengerShape& s, const ExactPlace& place) {
  if (s.depth > kMaxMengerDepth) return;
  const Element e{static_cast<int>(s.depth), kPowers.at[s.depth]};
  add_element(pool, e, place.to_world, place);
  add_cell(pool, {-1, -1, -1}, {1, 1, 1});
}

int Menger::find(const Element& element, const FractalQuery& query, FractalCrossing* out, int room) {
  const Vec3d sum = query.o + query.d;
  if (!std::isfinite(sum.x + sum.y + sum.z) || query.d == Vec3d{}) return 0;
  return MengerWalk(element, query).find(out, room);
}

bool Menger::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const Element& e = pool.elements[i];
  Vec3d q;
  for (int k = 0; k < 3; ++k) {
    q[k] = (p[k] + 1) * (e.side * 0.5);
    if (!(0 <= q[k] && q[k] < e.side)) return false;
  }
  for (double size = e.side / 3; size >= 1; size /= 3) {
    int middles = 0;
    for (int k = 0; k < 3; ++k) {
      const double slab = std::floor(q[k] / size);
      middles += slab == 1;
      q[k] -= std::min(slab, 2.0) * size;
    }
    if (middles >= 2) return false;
  }
  return true;
}

}  // namespace oktett
