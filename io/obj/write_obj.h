#pragma once
/// \file Writing OBJ meshes and the MTL files beside them. Within io/ only.

#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Writes the mesh to `path`, and its materials, if there are some, to an MTL file of that name beside it.
/// Images that are in no file of their own become files beside it, too. Returns what the files cannot say.
/// Throws Error of kind io if that fails.
MeshLosses write_obj(const std::string& path, const MeshFile& file);

/// Names for `newmtl` and `usemtl`: those of the materials without what would end them, none empty, none
/// twice.
std::vector<std::string> mtl_names(const std::vector<Material>& materials);

/// Writes the materials of `file` under `names` to `out`, whose path is `path`. Adds what MTL cannot say to
/// `losses`.
void write_mtl(MeshOutput& out, const std::string& path, const MeshFile& file,
               const std::vector<std::string>& names, MeshLosses& losses);

}  // namespace oktett
