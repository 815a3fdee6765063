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

/// Which primitives of a mesh.
struct GltfChoice {
  bool strokes = false;            ///< points and lines (MeshFile::strokes), not triangles
  std::uint32_t material = kNoId;  ///< of points and lines: those with it

  auto operator<=>(const GltfChoice&) const = default;
};

/// How a mesh is bent.
struct GltfBending {
  std::vector<double> weights;  ///< of morph targets; may be shorter than their lists
  std::vector<Affine> joints;   ///< from the mesh as it is stored to where it is shown; empty: not skinned

  bool operator==(const GltfBending&) const = default;
};

/// Makes meshes of a file, as long as they take no more memory than the file justifies.
class GltfMeshBuilder {
 public:
  explicit GltfMeshBuilder(GltfAccessors& accessors) : accessors_(accessors) {}

  /// What the mesh with this number has of the choice, bent if `bending` is not null. Throws Error. What is
  /// left out is added to `warnings`.
  GltfBuiltMesh build(std::uint32_t number, const GltfChoice& choice, const GltfBending* bending,
                      std::vector<std::string>& warnings);

 private:
  GltfAccessors& accessors_;
};

}  // namespace oktett
