#include <algorithm>
#include <cmath>
#include <memory>

#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

/// Balls by the cells of a grid that they reach into, so that a thousand can be added up.
class BallGrid {
 public:
  BallGrid(const MetaballsShape& shape, const Vec3d& lo, const Vec3d& hi)
      : shape_(shape), lo_(lo), step_((hi - lo) / kCells) {
    for (std::uint32_t i = 0; i < shape.balls.size(); ++i) {
      const MetaBall& b = shape.balls[i];
      int from[3], to[3];
      for (int k = 0; k < 3; ++k)
        from[k] = cell(k, b.center[k] - b.radius * 1.001L), to[k] = cell(k, b.center[k] + b.radius * 1.001L);
      for (int x = from[0]; x <= to[0]; ++x)
        for (int y = from[1]; y <= to[1]; ++y)
          for (int z = from[2]; z <= to[2]; ++z) lists_[(x * kCells + y) * kCells + z].push_back(i);
    }
  }
  Real operator()(const Vec3l& p) const {
    Real f = shape_.iso;
    for (const std::uint32_t i : lists_[(cell(0, p.x) * kCells + cell(1, p.y)) * kCells + cell(2, p.z)]) {
      const MetaBall& b = shape_.balls[i];
      const Vec3l d = p - Vec3l(b.center);
      const Real q = 1 - dot(d, d) / (static_cast<Real>(b.radius) * b.radius);
      if (q > 0) f -= b.strength * q * q;
    }
    return f;
  }

 private:
  static constexpr int kCells = 12;
  int cell(int axis, Real x) const {
    return static_cast<int>(std::clamp(std::floor((x - lo_[axis]) / step_[axis]), 0.0L, kCells - 1.0L));
  }
  MetaballsShape shape_;
  Vec3d lo_, step_;
  std::vector<std::uint32_t> lists_[kCells * kCells * kCells];
};

/// Balls that `change`, which is also told those before, has changed.
template <class F>
ExactOracle draw_balls(CaseRandom& random, double iso, int count, const F& change) {
  MetaballsShape shape{iso, {}};
  for (int i = 0; i < count; ++i) {
    MetaBall ball{random.vector(), 0.3 + random.unit(), 0.6 + random.unit()};
    change(ball, shape.balls);
    shape.balls.push_back(ball);
  }
  return oracle_of(shape);
}

/// From one ball to a dozen; some negative, some at the same place, some touching from outside.
ExactOracle metaballs(CaseRandom& random) {
  const double iso = 0.2 + 0.6 * random.unit();
  const int count = 1 + static_cast<int>(random.unit() * random.unit() * 12);
  return draw_balls(random, iso, count, [&](MetaBall& ball, const std::vector<MetaBall>& others) {
    if (others.empty()) return;
    const auto& other = others[static_cast<std::size_t>(random.unit() * static_cast<double>(others.size()))];
    const double dice = random.unit();
    if (dice < 0.1) ball.center = other.center;
    if (dice < 0.05) ball.radius = other.radius;
    if (dice > 0.9) ball.center = other.center + normalize(random.vector()) * (other.radius + ball.radius);
    if (random.unit() < 0.25) ball.strength = -ball.strength;
  });
}

ExactOracle thousand_metaballs(CaseRandom& random) {
  return draw_balls(random, MetaballsShape{}.iso, 1000, [&](MetaBall& ball, const auto&) {
    ball.radius *= 0.3;
    if (random.unit() < 0.2) ball.strength = -ball.strength;
  });
}

/// So many at one place that no division parts them.
ExactOracle coincident_metaballs(CaseRandom& random) {
  return draw_balls(random, MetaballsShape{}.iso, 40, [&](MetaBall& ball, const auto& others) {
    if (!others.empty()) ball.center = others[0].center;
    ball.strength *= 0.1;
  });
}

}  // namespace

ExactOracle oracle_of(const MetaballsShape& shape) {
  ExactOracle oracle{{shape}, {}};
  for (const MetaBall& b : shape.balls)
    if (b.strength > 0) oracle.grow(b.center, b.radius);
  const auto grid = std::make_shared<BallGrid>(shape, oracle.lo, oracle.hi);
  oracle.f = [grid](const Vec3l& p) { return (*grid)(p); };
  return oracle;
}

std::vector<ExactCase> metaball_cases() {
  return {{"metaballs", metaballs},
          {"metaballs_1000", thousand_metaballs},
          {"metaballs_coincident", coincident_metaballs}};
}

}  // namespace oktett
