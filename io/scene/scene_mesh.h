#pragma once
/// \file One triangle mesh of a whole scene, exact shapes included.

#include <cstdint>
#include <string>

#include "core/description.h"
#include "io/mesh/mesh_file.h"
#include "render/scene.h"

namespace oktett {

/// Most cells along an edge of the grids that sample exact shapes.
inline constexpr std::uint32_t kMostMeshCells = 8192;

struct SceneMeshOptions {
  /// Cells of the grid along the longest edge of each exact shape, in [1, kMostMeshCells].
  std::uint32_t resolution = 64;
  /// If not 0, grids are refined instead until triangles are off the surface by no more than this, in units
  /// of the scene, where their grids were sampled; at most to kMostMeshCells.
  double tolerance = 0;
  /// If not empty: only objects of this name, those of instances included, and prototypes of it.
  std::string select{};
};

/// All objects of a scene at time 0, in its coordinates. Meshes and triangles are as they are; boxes, disks
/// and polygons without holes become triangles, all other shapes contours (io/mesh/contour/contour.h), of
/// fractals without what is smaller than a cell. Instances are flattened. What has no end, what is no surface
/// (Material::surface), and points and lines are left out with a warning that names them. Materials are those
/// of the scene; textures that are not laid over uv do not fit. Throws Error if no object has the selected
/// name, or if there is no room for all.
MeshFile mesh_of_scene(const Scene& scene, const SceneMeshOptions& options = {});

}  // namespace oktett
