#pragma once
/// \file Meshes of glTF files. Within io/ only.

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "io/gltf/accessor.h"

namespace oktett {

struct GltfBuiltMesh {
  TriangleMesh mesh;
  /// Material of the file per slot of the mesh; kNoId: none.
  std::vector<std::uint32_t> slots;
};

/// The set of texture coordinates that the textures of a primitive's material show; the first such set if
/// they show several.
std::size_t gltf_uv_set(const GltfModel& model, const GltfPrimitive& primitive);

/// Makes meshes of a file, as long as they take no more memory than the file justifies.
class GltfMeshBuilder {
 public:
  explicit GltfMeshBuilder(GltfAccessors& accessors) : accessors_(accessors) {}

  /// All triangles of the mesh with this number. Throws Error. What is left out is added to `warnings`.
  GltfBuiltMesh build(std::uint32_t number, std::vector<std::string>& warnings);

 private:
  void spend(std::uint64_t bytes);

  GltfAccessors& accessors_;
  std::uint64_t spent_ = 0;
};

}  // namespace oktett
