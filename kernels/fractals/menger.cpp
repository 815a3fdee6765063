#include "kernels/fractals/menger.h"

#include <algorithm>
#include <array>

namespace oktett {
namespace {

using Gate = GridLine::Gate;

struct Cell {
  Vec3d low;
  Gate exit;
};

constexpr auto kPowersOf3 = [] {
  std::array<double, kMaxMengerDepth + 1> at{1};
  for (int k = 1; k <= kMaxMengerDepth; ++k) at[k] = 3 * at[k - 1];
  return at;
}();

class MengerWalk {
 public:
  MengerWalk(const MengerElement& e, const FractalQuery& query)
      : e_(e), query_(query), line_(query, {1, 1, 1}, Vec3d{0.5, 0.5, 0.5} * e.side) {}

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
    path_[0] = {};
    return line_.clip({0, 0, 0}, Vec3d{1, 1, 1} * e_.side, in, path_[0].exit) && query_.a < path_[0].exit.t;
  }

  void set_exit(Cell& cell, double size) const {
    cell.exit = {};
    for (int k = 0; k < 3; ++k) {
      const int way = line_.way[k];
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
        // Which of the three slabs of this width the line is in.
        const double low = path_[level].low[k], first = low + size;
        const int slab = line_.is_beyond(k, first, t) + line_.is_beyond(k, first + size, t);
        middles += slab == 1;
        cell.low[k] = low + slab * size;
      }
      set_exit(cell, size);
      if (middles >= 2) return false;
      path_[++level] = cell;
    }
  }

  double size_of(int level) const { return kPowersOf3[e_.depth - level]; }

  FractalCrossing turn_at(const Gate& gate, double turn) const {
    return wall_crossing(query_, gate, gate.plane * (2 / e_.side) - 1, line_.way[gate.axis] * turn, turn);
  }

  const MengerElement& e_;
  const FractalQuery& query_;
  const GridLine line_;
  Cell path_[kMaxMengerDepth + 1];
};

}  // namespace

void Menger::add(Pool& pool, const MengerShape& s, const ExactPlace& place) {
  if (s.depth > kMaxMengerDepth) return;
  const Element e{static_cast<int>(s.depth), kPowersOf3[s.depth]};
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
