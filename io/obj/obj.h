#pragma once
/// \file Wavefront OBJ meshes and their MTL materials.

#include <string>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "render/material.h"

namespace oktett {

/// Everything in an OBJ file that can be rendered.
struct ObjFile {
  TriangleMesh mesh;                ///< polygons are triangulated; mesh.material_slots indexes `materials`
  std::vector<Material> materials;  ///< in order of first use; empty if no face names a material
  std::vector<Texture> textures;    ///< what the materials' texture indices refer to
  std::vector<Location> texture_places;  ///< where each texture is named first
  std::vector<Warning> warnings;         ///< what was skipped
};

/// Reads `path` and the MTL files that it names, which are looked for in the same directory. Throws Error
/// with file and line for what the format does not allow, with ErrorKind::io if the file cannot be read.
ObjFile load_obj(const std::string& path);

/// Reads the MTL file `path` and appends what is in it. Texture paths, which the file states relative to
/// itself, are joined to its directory. `texture_places`, if given, gets the place of each texture's
/// statement. Throws Error as load_obj does.
void load_mtl(const std::string& path, std::vector<Material>& materials, std::vector<Texture>& textures,
              std::vector<Warning>& warnings, std::vector<Location>* texture_places = nullptr);

}  // namespace oktett
