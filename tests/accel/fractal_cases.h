#pragma once
/// \file Fractals and rays for their tests, and the parts of small fractals.

#include <cmath>
#include <vector>

#include "core/random.h"
#include "core/ray.h"
#include "kernels/fractals/ifs.h"
#include "kernels/fractals/julia.h"
#include "kernels/fractals/menger.h"
#include "kernels/fractals/sphereflake.h"
#include "kernels/fractals/terrain.h"
#include "tests/support/convex_union.h"
#include "tests/support/limits.h"

namespace oktett {

using test::ConvexUnion;
using test::LineSpan;
using test::Vec3l;

inline SphereflakeShape flake(std::uint32_t depth, double ratio = 1.0 / 3) { return {depth, ratio}; }
inline MengerShape sponge(std::uint32_t depth) { return {depth}; }

inline Affine shrink(double by, const Vec3d& to) {
  return Affine::translation(to) * Affine::scaling({by, by, by});
}

/// Sierpinski's tetrahedron.
inline IfsShape tetrahedron(std::uint32_t depth, IfsShape::Base base = IfsShape::Base::ball) {
  IfsShape s;
  for (const Vec3d& to : {Vec3d{1, 1, 1}, Vec3d{1, -1, -1}, Vec3d{-1, 1, -1}, Vec3d{-1, -1, 1}})
    s.maps.push_back(shrink(0.5, to * 0.5));
  s.depth = depth, s.base = base;
  return s;
}
/// Menger's sponge as an iterated function system.
inline IfsShape sponge_by_maps(std::uint32_t depth) {
  IfsShape s;
  for (int i = 0; i < 27; ++i) {
    const Vec3d to{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
    if ((to.x == 0) + (to.y == 0) + (to.z == 0) < 2) s.maps.push_back(shrink(1.0 / 3, to * (2.0 / 3)));
  }
  s.depth = depth, s.base = IfsShape::Base::box;
  return s;
}
/// A plant of maps that turn, flatten and mirror.
inline IfsShape plant(std::uint32_t depth) {
  IfsShape s;
  s.maps = {
      Affine::translation({0, 0.5, 0}) * Affine::rotation({0, 40, 12}) * Affine::scaling({0.8, 0.8, 0.8}),
      Affine::translation({0.2, 0.1, 0}) * Affine::rotation({20, 0, -50}) * Affine::scaling({-0.4, 0.5, 0.4}),
      Affine::scaling({0.1, 0.4, 0.1})};
  s.depth = depth, s.every_level = true;
  return s;
}
inline JuliaShape julia(std::uint32_t iterations) {
  JuliaShape s;
  s.c[0] = -0.2, s.c[1] = 0.6, s.c[2] = 0.2, s.c[3] = 0.2;
  s.iterations = iterations;
  return s;
}
inline TerrainShape terrain(std::uint32_t depth, double roughness = 0.5) {
  TerrainShape s;
  s.depth = depth, s.roughness = roughness, s.seed = 3;
  return s;
}

/// Children in the order of angles, each found by turning the parent's own axes.
inline void grow(ConvexUnion& all, const Vec3l& c, long double r, const Vec3l& x, const Vec3l& y,
                 std::uint32_t depth, long double ratio) {
  all.balls.push_back({c, r});
  if (depth == 0) return;
  const Vec3l z = cross(x, y);
  const auto child = [&](long double longitude, long double high) {
    const long double pi = std::acos(-1.0L), a = longitude * pi / 180, across = std::sqrt(1 - high * high);
    const Vec3l level = x * std::cos(a) + z * std::sin(a), east = z * std::cos(a) - x * std::sin(a);
    const Vec3l out = level * across + y * high;
    grow(all, c + out * (r * (1 + ratio)), r * ratio, east, out, depth - 1, ratio);
  };
  for (int k = 0; k < 6; ++k) child(60 * k, 0);
  for (int k = 0; k < 3; ++k) child(30 + 120 * k, std::sqrt(2.0L / 3));
}

inline ConvexUnion explicit_balls(const SphereflakeShape& s) {
  ConvexUnion all;
  grow(all, {0, 0, 0}, 1, {1, 0, 0}, {0, 1, 0}, s.depth, s.ratio);
  return all;
}

/// All small cubes, by the ternary digits of their places.
inline ConvexUnion explicit_cubes(const MengerShape& s) {
  int side = 1;
  for (std::uint32_t k = 0; k < s.depth; ++k) side *= 3;
  ConvexUnion all;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (int k = 0; k < side; ++k) {
        bool solid = true;
        for (int p = 1; p < side; p *= 3) solid &= (i / p % 3 == 1) + (j / p % 3 == 1) + (k / p % 3 == 1) < 2;
        if (!solid) continue;
        const Vec3l lo{1.0L * i, 1.0L * j, 1.0L * k}, one{1, 1, 1};
        const long double size = 2.0L / side;
        all.boxes.push_back({lo * size - one, (lo + one) * size - one});
      }
  return all;
}

/// Numbers in [-1, 1] that depend on their position only.
struct Numbers {
  std::uint64_t key, at = 0;
  double next() { return static_cast<double>(mix_bits(key * 0x10001 + ++at) >> 11) * 0x1p-52 - 1; }
  Vec3d vector() {
    const double x = next(), y = next();
    return {x, y, next()};
  }
};

/// Rays from outside, from inside, along axes, along diagonals and on planes of the grid.
inline std::vector<Ray> rays_about(int count, double size) {
  Numbers random{7};
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Vec3d from = random.vector() * (3 * size), at = random.vector() * size;
    if (i % 5 == 1) from = random.vector() * (0.8 * size);
    Vec3d d = at - from;
    if (i % 7 == 2) d[i % 3] = 0;
    if (i % 7 == 3) d[i % 3] = d[(i + 1) % 3] = 0;
    if (i % 11 == 4) d = {1, i % 2 == 0 ? 1.0 : -1.0, 1}, from = at - d * 4.0;
    if (i % 13 == 5) from[i % 3] = 0;
    rays.push_back({Vec3f(from), 0, Vec3f(d), kInf});
  }
  return rays;
}

}  // namespace oktett
