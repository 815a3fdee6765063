#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "kernels/fractals/terrain.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

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
  ExactOracle o{{s}, [balls](const Vec3l& p) {
                  Real least = HUGE_VALL;
                  nearest(*balls, p, least);
                  return least;
                }};
  o.grow({0, 0, 0}, static_cast<double>(balls->reach));
  return o;
}

/// The cube less an infinite cross of bars per level, each level repeated all over space.
ExactOracle menger(CaseRandom& random) {
  MengerShape s;
  s.depth = static_cast<std::uint32_t>(random.unit() * 5);
  return {{s},
          [s](const Vec3l& p) {
            Real f = outside({-1, -1, -1}, {1, 1, 1}, p), size = 2;
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
          {1, 1, 1}};
}

/// All pieces, by the maps' products.
ExactOracle ifs(CaseRandom& random) {
  IfsShape s;
  const int maps = 2 + static_cast<int>(random.unit() * 2);
  for (int k = 0; k < maps; ++k) {
    Vec3d size{0.3 + 0.3 * random.unit(), 0.3 + 0.3 * random.unit(), 0.3 + 0.3 * random.unit()};
    if (random.unit() < 0.1) size.x = 0.02;
    const Affine shift = Affine::translation(random.vector());
    s.maps.push_back(shift * Affine::rotation(random.vector() * 180.0) * Affine::scaling(size));
  }
  s.depth = static_cast<std::uint32_t>(random.unit() * 4);
  s.base = random.unit() < 0.5 ? IfsShape::Base::ball : IfsShape::Base::box;
  s.every_level = random.unit() < 0.3;
  const auto pieces = std::make_shared<std::vector<Affine>>(1, Affine{});
  std::size_t first = 0;
  for (std::uint32_t level = 0; level < s.depth; ++level) {
    const std::size_t end = pieces->size();
    for (std::size_t i = first; i < end; ++i)
      for (const Affine& map : s.maps) pieces->push_back((*pieces)[i] * map);
    first = end;
  }
  if (!s.every_level) pieces->erase(pieces->begin(), pieces->begin() + static_cast<std::ptrdiff_t>(first));
  Vec3d lo{1e9, 1e9, 1e9}, hi = -lo;
  for (Affine& piece : *pieces) {
    for (int k = 0; k < 3; ++k) {
      const double reach = std::abs(piece.m[k][0]) + std::abs(piece.m[k][1]) + std::abs(piece.m[k][2]);
      lo[k] = std::min(lo[k], piece.m[k][3] - reach), hi[k] = std::max(hi[k], piece.m[k][3] + reach);
    }
    piece = piece.inverse();
  }
  return {{s},
          [s, pieces](const Vec3l& p) {
            Real least = HUGE_VALL;
            for (const Affine& to_piece : *pieces) {
              const Vec3l q = mapped(to_piece, p);
              least = std::min(least, s.base == IfsShape::Base::ball ? std::sqrt(dot(q, q)) - 1
                                                                     : outside({-1, -1, -1}, {1, 1, 1}, q));
            }
            return least;
          },
          lo,
          hi};
}

/// A product by the table of units.
template <bool kHypercomplex, class R>
std::array<R, 4> times(const std::array<R, 4>& p, const std::array<R, 4>& q) {
  // Of i, j and k with each other: which unit, and its sign.
  struct Unit {
    std::size_t which;
    int sign;
  };
  constexpr Unit kQuaternion[3][3] = {
      {{0, -1}, {3, 1}, {2, -1}}, {{3, -1}, {0, -1}, {1, 1}}, {{2, 1}, {1, -1}, {0, -1}}};
  constexpr Unit kHyper[3][3] = {
      {{0, -1}, {3, 1}, {2, -1}}, {{3, 1}, {0, -1}, {1, -1}}, {{2, -1}, {1, -1}, {0, 1}}};
  std::array<R, 4> sum{p[0] * q[0], 0, 0, 0};
  for (std::size_t i = 1; i < 4; ++i) sum[i] = p[0] * q[i] + p[i] * q[0];
  for (std::size_t i = 1; i < 4; ++i)
    for (std::size_t k = 1; k < 4; ++k) {
      const Unit unit = kHypercomplex ? kHyper[i - 1][k - 1] : kQuaternion[i - 1][k - 1];
      sum[unit.which] += static_cast<R>(unit.sign) * p[i] * q[k];
    }
  return sum;
}

/// What z becomes in one step.
template <class R>
std::array<R, 4> iterated(const JuliaShape& s, const std::array<R, 4>& z) {
  std::array<R, 4> q = z;
  for (std::uint32_t k = 1; k < s.power; ++k)
    q = s.algebra == JuliaShape::Algebra::hypercomplex ? times<true>(q, z) : times<false>(q, z);
  for (std::size_t k = 0; k < 4; ++k) q[k] += s.c[k];
  return q;
}

/// Numbers of this size are not followed.
constexpr double kBeyond = 1e15;

/// Whether the last iterates of all numbers within `room` of z lie on one side of the sphere of radius r, by
/// how far they are from that of z at most.
bool stay_on_one_side(const JuliaShape& s, std::array<double, 4> z, double room, double r) {
  const auto length_of = [&z] { return std::sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + z[3] * z[3]); };
  // A product is as long as its factors, of hypercomplex numbers up to the root of 2 times.
  const double most = s.algebra == JuliaShape::Algebra::quaternion ? 1 : s.power == 2 ? std::sqrt(2.0) : 2;
  for (std::uint32_t n = 0; n < s.iterations; ++n) {
    const double size = length_of();
    if (size - room > kBeyond) return true;
    if (!(size + room < kBeyond)) return false;
    // (z + e)^p - z^p, multiplied out, and what is rounded.
    room =
        most * (s.power == 2 ? room * (2 * size + room) : room * (3 * size * (size + room) + room * room)) +
        1e-14 * (1 + size * size * (s.power == 2 ? 1 : size));
    z = iterated(s, z);
  }
  return std::abs(length_of() - r) > room;
}

ExactOracle julia(CaseRandom& random) {
  JuliaShape s;
  for (double& c : s.c) c = 0.6 * random.sign();
  s.slice = random.unit() < 0.5 ? 0 : 0.3 * random.sign();
  s.iterations = 1 + static_cast<std::uint32_t>(random.unit() * 6);
  if (random.unit() < 0.5) s.algebra = JuliaShape::Algebra::hypercomplex;
  if (random.unit() < 0.3) s.power = 3;
  if (const double which = random.unit(); which < 0.3) s.escape = which < 0.1 ? 4 : which < 0.2 ? 40 : 1000;
  Real size = 0;
  for (const double c : s.c) size += static_cast<Real>(c) * c;
  const Real r = std::max((1 + std::sqrt(1 + 4 * std::sqrt(size))) / 2, static_cast<Real>(s.escape));
  ExactOracle o{{s}, [s, r](const Vec3l& p) {
                  constexpr Real kFar = static_cast<Real>(kBeyond) * kBeyond;
                  std::array<Real, 4> z{p.x, p.y, p.z, s.slice};
                  const auto square = [&z] { return z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + z[3] * z[3]; };
                  for (std::uint32_t n = 0; n < s.iterations && square() < kFar; ++n) z = iterated(s, z);
                  return square() - r * r;
                }};
  o.clear = [s, r = static_cast<double>(r)](const Vec3d& a, const Vec3d& b) {
    const Vec3d middle = (a + b) * 0.5;
    return stay_on_one_side(s, {middle.x, middle.y, middle.z, s.slice}, 0.5 * length(b - a) + 1e-14, r);
  };
  // What stays within r came from nearer, by |z^p + c| >= |z|^p - |c|.
  Real reach = r;
  for (std::uint32_t n = 0; n < s.iterations; ++n)
    reach = std::min(reach, std::pow(reach + std::sqrt(size), Real(1) / s.power));
  o.grow({0, 0, 0}, static_cast<double>(reach));
  return o;
}

/// All heights, level by level.
ExactOracle terrain(CaseRandom& random) {
  TerrainShape s;
  s.depth = static_cast<std::uint32_t>(random.unit() * 6), s.seed = static_cast<std::uint32_t>(random.bits());
  s.height = 0.2 + random.unit(), s.roughness = 0.3 + 0.5 * random.unit(), s.base = -1.5 * random.unit();
  const std::size_t side = std::size_t{1} << s.depth, row = side + 1;
  const auto heights = std::make_shared<std::vector<Real>>(row * row);
  const auto at = [&](std::size_t i, std::size_t k) -> Real& { return (*heights)[k * row + i]; };
  Real step = s.height, top = -HUGE_VALL;
  for (const std::size_t i : {std::size_t{0}, side})
    for (const std::size_t k : {std::size_t{0}, side})
      at(i, k) = step * Terrain::displacement(s.seed, 0, i / side, k / side);
  for (std::size_t size = side, level = 1; size > 1; size /= 2, ++level) {
    step *= s.roughness;
    const std::size_t half = size / 2;
    const auto moved = [&](std::size_t i, std::size_t k) {
      return step * Terrain::displacement(s.seed, static_cast<int>(level), i / half, k / half);
    };
    for (std::size_t k = 0; k <= side; k += size)
      for (std::size_t i = half; i < side; i += size) {
        at(i, k) = (at(i - half, k) + at(i + half, k)) / 2 + moved(i, k);
        at(k, i) = (at(k, i - half) + at(k, i + half)) / 2 + moved(k, i);
      }
    for (std::size_t k = half; k < side; k += size)
      for (std::size_t i = half; i < side; i += size)
        at(i, k) = (at(i - half, k - half) + at(i + half, k - half) + at(i - half, k + half) +
                    at(i + half, k + half)) /
                       4 +
                   moved(i, k);
  }
  for (const Real h : *heights) top = std::max(top, h);
  s.base = std::min(s.base, static_cast<double>(top) - 0.1);
  return {{s},
          [s, heights, side, row](const Vec3l& p) {
            const auto place = [&](Real x) { return std::clamp((x + 1) / 2, 0.0L, 1.0L) * side; };
            const Real x = place(p.x), z = place(p.z);
            const std::size_t i = std::min(static_cast<std::size_t>(x), side - 1),
                              k = std::min(static_cast<std::size_t>(z), side - 1);
            const Real u = x - i, v = z - k, *h = &(*heights)[k * row + i];
            const Real height = u >= v ? h[0] * (1 - u) + h[1] * (u - v) + h[row + 1] * v
                                       : h[0] * (1 - v) + h[row] * (v - u) + h[row + 1] * u;
            return std::max({p.y - height, s.base - p.y, std::abs(p.x) - 1, std::abs(p.z) - 1});
          },
          {-1, s.base, -1},
          {1, static_cast<double>(top), 1}};
}

}  // namespace

std::vector<ExactCase> fractal_cases() {
  return {
      {"sphereflake", sphereflake}, {"menger", menger}, {"ifs", ifs}, {"julia", julia}, {"terrain", terrain}};
}

}  // namespace oktett
