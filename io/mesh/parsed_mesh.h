#pragma once
/// \file What a mesh file says before the files that it names are read. Within io/ only.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "io/text/scan.h"

namespace oktett {

/// How a mesh file is taken apart. The result does not depend on it; tests use it to reach corner cases.
struct MeshReadOptions {
  /// Bytes that one task reads at a time, rounded up to whole lines or records.
  std::size_t chunk_bytes = std::size_t{1} << 20;
  /// The most positions, normals, uvs or triangles there may be: what 32-bit indices reach beside kNoId.
  std::size_t max_elements = 0xfffffffeu;
};

/// Words at a place in the text.
struct MeshStatement {
  /// Of what no statement says.
  static constexpr std::uint64_t kNowhere = UINT64_MAX;

  std::uint64_t at = kNowhere;  ///< bytes from the start of the text
  std::string words;
  TextPosition position;  ///< of `at`; not filled in by all readers
};

/// Depends on the content of the mesh file alone.
struct ParsedMesh {
  TriangleMesh mesh;
  std::vector<MeshStatement> libraries;  ///< what follows `mtllib` in an OBJ file
  std::vector<MeshStatement> materials;  ///< names of the material slots of the mesh
  std::vector<MeshStatement> notices;    ///< warnings
  bool has_faces = true;
};

}  // namespace oktett
