#pragma once
/// \file A triangle mesh as rays see it, to find out what it is.

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "core/box.h"
#include "core/mesh.h"

namespace oktett {

class MeshExplorer {
 public:
  /// The mesh must outlive it.
  explicit MeshExplorer(const TriangleMesh& mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const Box& box() const { return box_; }
  /// The diagonal of the box; zero if there is nothing that a ray could hit.
  double size() const { return size_; }

  std::vector<Hit> hits(const std::vector<Ray>& rays) const;
  /// Distances along unit directions, infinite where nothing is hit.
  std::vector<float> distances(const std::vector<Ray>& rays) const;
  /// For each ray 1 if it hits something, else 0.
  std::vector<std::uint8_t> occluded(const std::vector<Ray>& rays) const;

  /// `count` triangles in equal steps of area; none if no triangle has an area.
  std::vector<std::uint32_t> triangles_by_area(std::uint32_t count) const;

 private:
  const TriangleMesh& mesh_;
  std::shared_ptr<const Accel> accel_;
  Box box_;
  double size_;
};

}  // namespace oktett
