#pragma once
/// \file The triangles of meshes, moved to the structure's space: as references for the builder, and as
/// blocks.

#include <vector>

#include "accel/build/wide_tree.h"

namespace oktett {

class MeshSource final : public TriangleSource {
 public:
  explicit MeshSource(const Accel& accel);

  /// Appends references to all triangles of mesh geometry `geometry`; those that are degenerate or not finite
  /// are left out. Returns their bounds.
  Box add_references(std::uint32_t geometry, Column<PrimRef>& refs, bool parallel) const;

  void fill(const std::uint32_t* items, int count, TriangleBlock& block) const override;
  void prefetch(const std::uint32_t* items, int count) const override;
  void corners(std::uint32_t item, Vec3f (&v)[3]) const override;

 private:
  /// A mesh geometry, ready to be read; others have no mesh.
  struct Mesh {
    const Vec3f* positions = nullptr;
    const std::uint32_t* indices = nullptr;
    std::uint32_t first_item = 0;
    const Affine* transform = nullptr;  ///< null: identity
  };
  void corners(const Mesh& mesh, std::uint32_t item, Vec3f (&v)[3]) const;
  const Mesh& mesh_of(std::uint32_t item) const;

  const Accel& accel_;
  std::vector<Mesh> meshes_;  ///< per geometry
};

}  // namespace oktett
