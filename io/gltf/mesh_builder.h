#pragma once
/// \file Meshes of glTF files. Within io/gltf/ only.

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"
#include "io/gltf/accessor.h"

namespace oktett {

struct GltfBuiltMesh {
  TriangleMesh mesh;
  /// Material of the file per slot of the mesh; kNoId: none.
  std::vector<std::uint32_t> slots;
};

/// How a mesh is bent.
struct GltfBending {
  std::vector<double> weights;  ///< of morph targets; may be shorter than their lists
  std::vector<Affine> joints;   ///< from the mesh as it is stored to where it is shown; empty: not skinned
};

/// Makes meshes of a file, as long as they take no more memory than the file justifies.
class GltfMeshBuilder {
 public:
  explicit GltfMeshBuilder(GltfAccessors& accessors) : accessors_(accessors) {}

  /// All triangles of the mesh with this number, bent if `bending` is not null. Throws Error. What is left
  /// out is added to `warnings`.
  GltfBuiltMesh build(std::uint32_t number, const GltfBending* bending, std::vector<std::string>& warnings);

 private:
  GltfAccessors& accessors_;
};

}  // namespace oktett
