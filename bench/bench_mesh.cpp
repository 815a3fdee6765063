#include "bench/bench_mesh.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "io/mesh/load/load_mesh.h"

namespace oktett::bench {

/// Of 2 * n * n triangles.
static TriangleMesh wavy_sphere(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t row = 0; row <= n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const double theta = std::numbers::pi * row / n, phi = 2 * std::numbers::pi * column / n;
      const double r = 1 + 0.05 * std::sin(20 * theta) * std::sin(22 * phi);
      mesh.positions.push_back(Vec3f(
          Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)} * r));
    }
  for (std::uint32_t row = 0; row < n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t next = (column + 1) % n, a = row * n + column, b = row * n + next;
      for (std::uint32_t i : {a, b, a + n, b, b + n, a + n}) mesh.indices.push_back(i);
    }
  return mesh;
}

const TriangleMesh& bench_mesh() {
  static const TriangleMesh mesh = [] {
    const char* path = std::getenv("OKTETT_BENCH_MESH");
    return path != nullptr && *path != 0 ? load_mesh(path).mesh : wavy_sphere(224);
  }();
  return mesh;
}

}  // namespace oktett::bench
