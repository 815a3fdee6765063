#pragma once
/// \file Any-hit rays that end in one point, sorted so that neighbours seen from there stand together: then
/// their tiles are as narrow as those of a camera.

#include "accel/traverse_tile.h"

namespace oktett {

/// Most rays that are sorted at once.
inline constexpr std::size_t kSortedRays = 4096;

/// Bits of a cell index, spread so that every second bit is free.
OKTETT_INLINE std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 4) & 0x0f0f;
  x = (x | x << 2) & 0x3333;
  return (x | x << 1) & 0x5555;
}

/// Where rays come from, seen from their common end: the direction in octahedral coordinates (Meyer et al.,
/// "On Floating-Point Normal Vectors", 2010), in which all directions are one square.
template <class F>
OKTETT_INLINE void octahedral(const Vec3<F>& d, F& u, F& v) {
  const F zero(0.0f), one(1.0f), scale = one / norm1(d);
  const F x = d.x * scale, y = d.y * scale;
  const auto below = d.z < zero;
  u = select(below, flip_sign(one - abs(y), x), x);
  v = select(below, flip_sign(one - abs(x), y), y);
}

/// The order in which `rays` stand in a Morton curve over a grid around them. rays.size <= kSortedRays.
template <class A>
OKTETT_NOINLINE void sort_by_end(const RaySpan& rays, std::uint16_t* order) {
  constexpr int W = 16, kBits = 6, kSide = 1 << kBits;
  using F = Simd<float, W, A>;
  alignas(64) float u[kSortedRays + W], v[kSortedRays + W];
  F u_lo(2.0f), u_hi(-2.0f), v_lo = u_lo, v_hi = u_hi;
  for (std::size_t i = 0; i < rays.size; i += W) {
    F x, y;
    octahedral(load_span<F>(rays, i).d, x, y);
    u_lo = min(x, u_lo), u_hi = max(x, u_hi), v_lo = min(y, v_lo), v_hi = max(y, v_hi);
    x.store(u + i), y.store(v + i);
  }
  const float u0 = horizontal_min(u_lo), v0 = horizontal_min(v_lo);
  const float extent = std::max({horizontal_max(u_hi) - u0, horizontal_max(v_hi) - v0, 1e-20f});
  const float scale = (static_cast<float>(kSide) - 0.01f) / extent;
  std::uint16_t count[kSide * kSide + 1] = {}, key[kSortedRays];
  for (std::size_t i = 0; i < rays.size; ++i) {
    // Rays that are no rays (NaN) go to the first cell.
    const float x = (u[i] - u0) * scale, y = (v[i] - v0) * scale;
    const bool regular = x >= 0 && y >= 0 && x < kSide && y < kSide;
    key[i] = static_cast<std::uint16_t>(
        regular ? spread_bits(static_cast<std::uint32_t>(x)) | spread_bits(static_cast<std::uint32_t>(y)) << 1 : 0u);
    ++count[key[i] + 1];
  }
  for (int c = 0; c < kSide * kSide; ++c) count[c + 1] = static_cast<std::uint16_t>(count[c + 1] + count[c]);
  for (std::size_t i = 0; i < rays.size; ++i) order[count[key[i]]++] = static_cast<std::uint16_t>(i);
}

/// Columns of kSortedRays rays.
struct SortedRays {
  alignas(64) float column[8][kSortedRays];

  void gather(const RaySpan& rays, const std::uint16_t* order) {
    const float* from[8] = {rays.origin[0],    rays.origin[1],    rays.origin[2], rays.direction[0],
                            rays.direction[1], rays.direction[2], rays.tmin,      rays.tmax};
    for (int c = 0; c < 8; ++c)
      for (std::size_t i = 0; i < rays.size; ++i) column[c][i] = from[c][order[i]];
  }
  RaySpan span(std::size_t size) const {
    return {{column[0], column[1], column[2]}, {column[3], column[4], column[5]}, column[6], column[7], size};
  }
};

/// True if the rays seem to end in one point, which is then the apex.
OKTETT_INLINE bool common_end(const RaySpan& rays, Apex& apex) {
  const auto end = [&](std::size_t i) {
    const Ray r = rays[i];
    return Vec3d(r.origin) + Vec3d(r.direction) * static_cast<double>(r.tmax);
  };
  const Vec3d first = end(0), middle = end(rays.size / 2), last = end(rays.size - 1);
  const double scale = max_component(abs(middle)) + max_component(abs(Vec3d(rays[0].origin)));
  apex = {Vec3f(middle), true};
  return max_component(abs(first - middle)) <= scale * 0x1p-20 && max_component(abs(last - middle)) <= scale * 0x1p-20;
}

}  // namespace oktett
