#pragma once
/// \file Wavefront OBJ meshes and their MTL materials.

#include <string>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "render/material.h"

namespace oktett {

/// Everything an OBJ file holds that can be rendered.
struct ObjFile {
  /// Polygons are triangulated; mesh.material_slots indexes `materials`.
  TriangleMesh mesh;
  /// One per slot, in order of first use; empty if no face names a material.
  std::vector<Material> materials;
  /// What the materials' texture indices refer to.
  std::vector<Texture> textures;
  std::vector<Warning> warnings;
};

/// Reads `path`, and the MTL files it names from the same directory. Throws Error with file and line for what
/// the format does not allow, with ErrorKind::io if the file cannot be read.
ObjFile load_obj(const std::string& path);

/// Reads an MTL file. Texture paths are made relative to its directory.
void load_mtl(const std::string& path, std::vector<Material>& materials, std::vector<Texture>& textures,
              std::vector<Warning>& warnings);

}  // namespace oktett
