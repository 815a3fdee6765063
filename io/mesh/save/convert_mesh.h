#pragma once
/// \file Mesh files in other formats.

#include <string>
#include <vector>

#include "core/error.h"
#include "io/gltf/gltf_options.h"
#include "io/mesh/mesh_file.h"

namespace oktett {

struct ConvertOptions {
  bool ascii = false;  ///< text instead of bytes, for .ply and .stl
  bool weld = false;   ///< make one of all vertices at the same place, -0 as 0
  GltfOptions gltf{};  ///< what of a glTF file is read; nothing may be asked of others
};

/// What became of a mesh.
struct Conversion {
  std::size_t triangles = 0, vertices = 0;
  std::vector<Warning> warnings;  ///< of reading
  /// What the written file does not say, "lost: ...", or says otherwise, "changed: ...".
  std::vector<std::string> losses;
};

/// The ends of the names of all formats that can be written, and of those that have files of text and of
/// bytes.
std::vector<std::string> written_mesh_extensions();
std::vector<std::string> text_mesh_extensions();

/// Throws Error unless `path` names a format that can be written, and, of kind io, unless there can be a
/// file.
void check_mesh_output(const std::string& path, const ConvertOptions& options);

/// Reads the mesh file `input` as load_mesh does and writes it to `output`: .obj, .ply, .stl or .glb, by its
/// end. It appears under its name only when it is complete. Throws Error, also if there are no triangles.
Conversion convert_mesh(const std::string& input, const std::string& output, const ConvertOptions& options);

/// Writes what was read or made of `input` in the same way. Throws Error, also if there are no triangles, or
/// if `output` is the input.
Conversion write_mesh(const std::string& input, MeshFile file, const std::string& output,
                      const ConvertOptions& options);

}  // namespace oktett
