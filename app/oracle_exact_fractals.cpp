#include <algorithm>
#include <cmath>
#include <memory>

#include "app/oracle_exact_families.h"

namespace oktett {

namespace {

using Real = long double;

Vec3l unit(const Vec3l& v) { return v / std::sqrt(dot(v, v)); }

/// A ball of a sphereflake with all balls that grow on it, written down in the space of the first one.
struct Balls {
  Vec3l center;
  Real radius, reach;
  std::vector<Balls> children;
};

/// By turning a hexagon and a triangle about the axis, from the parent's own directions.
Balls grow(const Vec3l& center, Real radius, Real ratio, const Vec3l& east, const Vec3l& up, unsigned depth) {
  Balls b{center, radius, radius, {}};
  if (depth == 0) return b;
  const Vec3l south = cross(east, up);
  for (int k = 0; k < 9; ++k) {
    const Real around = (k < 6 ? k * 60 : 30 + (k - 6) * 120) * std::acos(-1.0L) / 180;
    const Real high = k < 6 ? 0 : std::asin(std::sqrt(2.0L / 3));
    const Vec3l level = east * std::cos(around) + south * std::sin(around);
    const Vec3l out = unit(level * std::cos(high) + up * std::sin(high));
    const Vec3l left = south * std::cos(around) - east * std::sin(around);
    b.children.push_back(
        grow(center + out * (radius * (1 + ratio)), radius * ratio, ratio, left, out, depth - 1));
  }
  for (const Balls& c : b.children) b.reach = std::max(b.reach, radius * (1 + ratio) + c.reach);
  return b;
}

/// The distance from the nearest ball, negative inside.
void nearest(const Balls& b, const Vec3l& p, Real& least) {
  const Vec3l m = p - b.center;
  const Real away = std::sqrt(dot(m, m));
  if (away - b.reach >= least) return;
  least = std::min(least, away - b.radius);
  for (const Balls& c : b.children) nearest(c, p, least);
}

ExactOracle sphereflake(CaseRandom& random) {
  SphereflakeShape s;
  s.depth = static_cast<std::uint32_t>(random.unit() * 4);
  s.ratio = random.unit() < 0.5 ? 1.0 / 3 : 0.1 + 0.4 * random.unit();
  const auto balls =
      std::make_shared<const Balls>(grow({0, 0, 0}, 1, s.ratio, {1, 0, 0}, {0, 1, 0}, s.depth));
  const double r = static_cast<double>(balls->reach);
  return {"sphereflake",
          {s},
          [balls](const Vec3l& p) {
            Real least = HUGE_VALL;
            nearest(*balls, p, least);
            return least;
          },
          {-r, -r, -r},
          {r, r, r},
          {}};
}

/// The cube less an infinite cross of bars per level, each level repeated all over space.
ExactOracle menger(CaseRandom& random) {
  MengerShape s;
  s.depth = static_cast<std::uint32_t>(random.unit() * 5);
  return {"menger",
          {s},
          [s](const Vec3l& p) {
            Real f = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 1, size = 2;
            for (unsigned level = 0; level < s.depth; ++level, size /= 3) {
              // Distances from the middle of the bars along each axis.
              Real m[3];
              for (int k = 0; k < 3; ++k) {
                const Real at = p[k] + 1, whole = std::floor(at / size) * size;
                m[k] = std::abs(at - whole - size / 2);
              }
              const Real bars = std::min({std::max(m[0], m[1]), std::max(m[1], m[2]), std::max(m[2], m[0])});
              f = std::max(f, size / 6 - bars);
            }
            return f;
          },
          {-1, -1, -1},
          {1, 1, 1},
          {}};
}

}  // namespace

std::vector<DrawExact> fractal_oracles() { return {sphereflake, menger}; }

}  // namespace oktett
