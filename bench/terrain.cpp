#include "bench/terrain.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.h"

namespace oktett::bench {

namespace {

constexpr std::uint32_t kOctaves = 11;
constexpr std::uint32_t kCoarsest = 3;  // cells along a side

/// Random numbers at the corners of a lattice, smoothly joined.
struct Octave {
  std::uint32_t side;  ///< of corners
  std::vector<float> corner;

  explicit Octave(std::uint32_t octave) : side((kCoarsest << octave) + 1), corner(std::size_t{side} * side) {
    for (std::size_t i = 0; i < corner.size(); ++i)
      corner[i] = random_float(17, octave, static_cast<std::uint32_t>(i));
  }
  float at(double x, double y) const {
    const auto place = [&](double p, std::uint32_t& cell) {
      const double q = p * (side - 1);
      cell = std::min(static_cast<std::uint32_t>(q), side - 2);
      const double u = q - cell;
      return static_cast<float>(u * u * (3 - 2 * u));
    };
    std::uint32_t i, j;
    const float u = place(x, i), v = place(y, j);
    const float* c = &corner[i + std::size_t{j} * side];
    const float low = c[0] + u * (c[1] - c[0]), high = c[side] + u * (c[side + 1] - c[side]);
    return low + v * (high - low);
  }
};

}  // namespace

Column<std::uint16_t> terrain(std::uint32_t n) {
  std::vector<Octave> octaves;
  for (std::uint32_t k = 0; k < kOctaves; ++k) octaves.emplace_back(k);
  Column<std::uint16_t> heights(std::size_t{n} * n);
  tbb::parallel_for(std::uint32_t{0}, n, [&](std::uint32_t row) {
    for (std::uint32_t column = 0; column < n; ++column) {
      const double x = column / (n - 1.0), y = row / (n - 1.0);
      float sum = 0, weight = 0.5f;
      for (const Octave& octave : octaves) sum += weight * octave.at(x, y), weight *= 0.48f;
      // Valleys are wide, ridges are not.
      const float h = std::clamp((sum - 0.2f) * 1.6f, 0.0f, 1.0f);
      heights[column + std::size_t{row} * n] = static_cast<std::uint16_t>(h * h * 65535 + 0.5f);
    }
  });
  return heights;
}

TriangleMesh terrain_mesh(const Column<std::uint16_t>& heights, std::uint32_t n, double height) {
  TriangleMesh mesh;
  mesh.positions.resize_uninitialized(heights.size());
  mesh.indices.resize_uninitialized(6 * std::size_t{n - 1} * (n - 1));
  std::size_t at = 0;
  for (std::uint32_t row = 0; row < n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t i = column + row * n;
      mesh.positions[i] =
          Vec3f(Vec3d{2 * column / (n - 1.0) - 1, height * heights[i] / 65535.0, 2 * row / (n - 1.0) - 1});
      if (row + 1 == n || column + 1 == n) continue;
      for (const std::uint32_t k : {i, i + n, i + 1, i + 1, i + n, i + n + 1}) mesh.indices[at++] = k;
    }
  return mesh;
}

}  // namespace oktett::bench
