#pragma once
/// \file Wavefront OBJ meshes and their MTL materials.

#include <string>
#include <vector>

#include "core/error.h"
#include "io/mesh/mesh_file.h"
#include "render/material.h"

namespace oktett {

using ObjFile = MeshFile;

/// Reads `path` and the MTL files that it names, which are looked for in the same directory. Throws Error
/// with file and line for what the format does not allow, with ErrorKind::io if the file cannot be read.
ObjFile load_obj(const std::string& path);

/// All lines of an OBJ file that are wrong, in order, as load_obj would report each if it were the first:
/// after about a thousand the rest is not looked at. Throws Error for what is wrong with the file as a whole.
std::vector<Error> find_obj_errors(const std::string& path);

/// Where MTL files define what is read from them.
struct MtlPlaces {
  std::vector<Location> materials, textures;
  /// Statements of materials that mean nothing here, the first of each keyword. They are no warnings of the
  /// reader, since exporters write many.
  std::vector<Warning> unused;
};

/// Reads the MTL file `path` and appends what is in it. Texture paths, which the file states relative to
/// itself, are joined to its directory. `places`, if given, gets the place of each material and of each
/// texture's statement, and what is not used. Throws Error as load_obj does.
void load_mtl(const std::string& path, std::vector<Material>& materials, std::vector<Texture>& textures,
              std::vector<Warning>& warnings, MtlPlaces* places = nullptr);

}  // namespace oktett
