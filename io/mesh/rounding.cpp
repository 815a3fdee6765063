#include "io/mesh/rounding.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/mesh_geometry.h"

namespace oktett {
namespace {

constexpr std::size_t kMostCompared = 1024;
/// One in so many triangles is many.
constexpr std::size_t kMany = 8;
/// What part of the longest edge rounding may move an edge by.
constexpr double kLeastMove = 1.0 / 64;

using TriangleEdges = std::array<Vec3d, 3>;

TriangleEdges edges_of(const TriangleMesh& mesh, std::size_t triangle) {
  const Vec3d a = corner(mesh, triangle, 0), b = corner(mesh, triangle, 1), c = corner(mesh, triangle, 2);
  return {b - a, c - b, a - c};
}

double longest_edge(const TriangleEdges& edges) {
  double most = 0;
  for (const Vec3d& edge : edges) most = std::max(most, max_component(abs(edge)));
  return most;
}

/// What rounding to floats may move a corner of the triangle by.
double rounding_of(const TriangleMesh& mesh, std::size_t triangle) {
  return max_component(abs(corner(mesh, triangle, 0))) * 0x1p-24;
}

}  // namespace

std::string find_rounding(TriangleMesh& mesh, const std::function<void(const Vec3d&)>& read_from) {
  const std::size_t compared = std::min(mesh.triangle_count(), kMostCompared);
  std::vector<std::size_t> small;
  for (std::size_t i = 0; i < compared; ++i) {
    const std::size_t triangle = i * mesh.triangle_count() / compared;
    if (longest_edge(edges_of(mesh, triangle)) * kLeastMove < 2 * rounding_of(mesh, triangle))
      small.push_back(triangle);
  }
  if (small.empty() || small.size() * kMany < compared) return {};
  std::vector<TriangleEdges> rounded;
  for (const std::size_t triangle : small) rounded.push_back(edges_of(mesh, triangle));
  const std::size_t middle = small[small.size() / 2];
  const double rounding = rounding_of(mesh, middle);

  Column<Vec3f> kept = mesh.positions;
  read_from(mesh.origin + Vec3d(mesh.positions[mesh.indices[3 * middle]]));
  std::size_t moved = 0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const TriangleEdges edges = edges_of(mesh, small[i]);
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, max_component(abs(edges[k] - rounded[i][k])));
    if (most > longest_edge(edges) * kLeastMove) ++moved;
  }
  mesh.positions = std::move(kept);
  if (moved * kMany < compared) return {};
  return fmt::format(
      "parts of the mesh lie so far apart that floats round positions by up to {:.2g}, which changes the "
      "shape of triangles; files of their own keep the digits of each part",
      rounding);
}

void note_rounding(ParsedMesh& parsed, const std::function<void(const Vec3d&)>& read_from) {
  std::string words = find_rounding(parsed.mesh, read_from);
  if (!words.empty()) parsed.notices.push_back({0, std::move(words), {}});
}

}  // namespace oktett
