#include "render/look/mesh_explorer.h"

#include <utility>

#include "core/mesh_geometry.h"

namespace oktett {

MeshExplorer::MeshExplorer(const TriangleMesh& mesh) : mesh_(mesh) {
  std::vector<Geometry> geometries(1);
  geometries[0].shape = MeshGeometry{&mesh, false, TriangleTest::watertight};
  BuildOptions options;
  options.quality = BuildQuality::fast;
  accel_ = build_accel(std::move(geometries), options);
  box_ = bounds(*accel_);
  size_ = length(Vec3d(box_.extent()));
}

std::vector<Hit> MeshExplorer::hits(const std::vector<Ray>& rays) const {
  std::vector<Hit> hits(rays.size());
  closest_hit(*accel_, rays, hits);
  return hits;
}

std::vector<float> MeshExplorer::distances(const std::vector<Ray>& rays) const {
  std::vector<float> t;
  for (const Hit& hit : hits(rays)) t.push_back(hit.t);
  return t;
}

std::vector<std::uint8_t> MeshExplorer::occluded(const std::vector<Ray>& rays) const {
  std::vector<std::uint8_t> occluded(rays.size());
  any_hit(*accel_, rays, occluded);
  return occluded;
}

std::vector<std::uint32_t> MeshExplorer::triangles_by_area(std::uint32_t count) const {
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangle_count());
  double total = 0;
  for (std::uint32_t i = 0; i < triangles; ++i) total += length(area_normal(mesh_, i));
  std::vector<std::uint32_t> chosen;
  double sum = 0;
  for (std::uint32_t i = 0; i < triangles && chosen.size() < count; ++i) {
    sum += length(area_normal(mesh_, i));
    while (chosen.size() < count && sum > (static_cast<double>(chosen.size()) + 0.5) * total / count)
      chosen.push_back(i);
  }
  return chosen;
}

}  // namespace oktett
