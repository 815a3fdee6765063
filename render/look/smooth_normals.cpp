#include "render/look/smooth_normals.h"

#include <vector>

#include "core/math.h"
#include "core/mesh_geometry.h"

namespace oktett {

/// The triangles at each vertex, in the order of their numbers: those of vertex v are
/// triangles[first[v]] ... triangles[first[v + 1] - 1].
struct VertexTriangles {
  explicit VertexTriangles(const TriangleMesh& mesh)
      : first(mesh.positions.size() + 1), triangles(mesh.indices.size()) {
    for (const std::uint32_t v : mesh.indices) ++first[v + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
      triangles[next[mesh.indices[i]]++] = static_cast<std::uint32_t>(i / 3);
  }
  std::vector<std::uint32_t> first, triangles;
};

void add_smooth_normals(TriangleMesh& mesh, double crease) {
  const VertexTriangles around(mesh);
  const double least = portable::cos(crease * kDegree);
  std::vector<Vec3d> normals(mesh.triangle_count());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = area_normal(mesh, i);
  mesh.normals.resize_uninitialized(mesh.indices.size());
  mesh.normal_indices.resize_uninitialized(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const Vec3d& own = normals[i / 3];
    const double size = length(own);
    const std::uint32_t vertex = mesh.indices[i];
    Vec3d sum;
    for (std::uint32_t k = around.first[vertex]; k < around.first[vertex + 1]; ++k) {
      const Vec3d& other = normals[around.triangles[k]];
      if (dot(own, other) >= least * size * length(other)) sum += other;
    }
    const double longest = length(sum);
    mesh.normals[i] = longest > 0 ? Vec3f(sum / longest) : Vec3f{};
    mesh.normal_indices[i] = longest > 0 ? static_cast<std::uint32_t>(i) : kNoId;
  }
}

}  // namespace oktett
