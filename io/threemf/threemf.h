#pragma once
/// \file 3MF files (3D Manufacturing Format), read with lib3mf. Within io/ only.

#include <string>

#include "io/mesh/file_scene.h"

namespace oktett {

/// Reads what the build of a 3MF file places: meshes, also as components of others, in the unit of the file.
/// Base materials, colours and images of its triangles become materials; colours stand in kColorAttribute of
/// the corners. What is left out is a warning. Throws Error, of kind io if the file cannot be read.
FileScene load_threemf_scene(const std::string& path);

}  // namespace oktett
