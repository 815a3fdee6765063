#pragma once
/// \file Mesh files of all formats, told apart by the ends of their names.

#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace oktett {

struct MeshOptions {
  bool weld = false;  ///< make one of all vertices at the same place, -0 as 0
};

/// Reads the mesh file `path`: .obj with the MTL files that it names, .ply, .stl, .off, .3mf, .gltf or .glb,
/// in upper or lower case, and the same with .gz behind it, packed by gzip. Of 3MF it reads what the build
/// places, of glTF what the default scene shows, as one mesh in world space. Throws Error with the file, and
/// the line or byte, for what the format does not allow, with ErrorKind::io if the file cannot be read, and
/// for names of other formats.
MeshFile load_mesh(const std::string& path, const MeshOptions& options = {});

/// All that is wrong in a file for which load_mesh threw an Error: all lines of an OBJ file, else nothing.
std::vector<Error> find_mesh_errors(const std::string& path);

/// Whether in files of the format of `path` (STL) each triangle has vertices of its own, so that no triangles
/// share a normal unless the mesh is welded.
bool repeats_vertices(const std::string& path);

/// Whether `path` ends like a mesh file that load_mesh can read.
bool is_mesh_file(const std::string& path);

/// The ends of the names of all formats, for messages.
std::string mesh_extensions();

}  // namespace oktett
