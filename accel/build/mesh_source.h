#pragma once
/// \file The triangles of meshes, moved to the structure's space: as references for the builder, and as
/// blocks.

#include <vector>

#include "accel/build/wide_tree.h"

namespace oktett {

class MeshSource final : public TriangleSource {
 public:
  explicit MeshSource(const Accel& accel);

  /// Adds references to all triangles of mesh geometry `geometry` to arrays.refs; those that are not
  /// finite are left out. Returns their bounds.
  Box add_references(std::uint32_t geometry, BuildArrays& arrays, bool parallel) const;

  /// Writes references to the triangles [begin, end) of a mesh geometry, those that are finite, and grows
  /// `bounds` by them. Returns how many there are.
  std::size_t references(std::uint32_t geometry, std::size_t begin, std::size_t end, PrimRef* out,
                         Box& bounds) const;

  void note_vertices(const PrimRef* refs, std::uint32_t count, VertexNumbers* out) const override;
  bool pack_corners(const std::uint32_t* items, int count, std::uint16_t* corners) const override;
  void fill(const std::uint32_t* items, const std::uint16_t* corners, int count,
            TriangleBlock& block) const override;
  void prefetch(const std::uint32_t* items, int count) const override;
  void corners(std::uint32_t item, Vec3f (&v)[3]) const override;

 private:
  /// A mesh geometry, ready to be read; others have no mesh.
  struct Mesh {
    const Vec3f* positions = nullptr;
    const std::uint32_t* indices = nullptr;
    std::uint32_t first_item = 0;
    std::uint32_t first_vertex = 0;     ///< vertices of the meshes before
    const Affine* transform = nullptr;  ///< null: identity
  };
  void corners(const Mesh& mesh, std::uint32_t item, Vec3f (&v)[3]) const;
  const Mesh& mesh_of(std::uint32_t item) const;
  const std::uint32_t* indices(const Mesh& mesh, std::uint32_t item) const {
    return mesh.indices + 3 * std::size_t{item - mesh.first_item};
  }

  const Accel& accel_;
  std::vector<Mesh> meshes_;  ///< per geometry
};

}  // namespace oktett
