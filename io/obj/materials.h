#pragma once
/// \file Materials of an OBJ file: the MTL files it names, and which triangle has which material.

#include <string>
#include <string_view>
#include <vector>

#include "io/obj/chunk.h"
#include "io/obj/obj.h"

namespace oktett {

/// A warning about a place in the text.
struct ObjNotice {
  const char* where;
  std::string message;
};

/// The files that the text behind `mtllib` names, relative to `directory`. Names may contain blanks: text
/// that names an existing file is one name, else a name ends at a word that ends in `.mtl`.
std::vector<std::string> split_library_names(std::string_view text, const std::string& directory);

/// Loads the MTL files and fills in material_slots, materials and textures of `obj`, whose triangles have
/// been counted. Appends warnings about the OBJ file to `notices`, those about the MTL files to obj.warnings.
/// More materials than slots can tell apart are noted as the failure of their chunk.
void assign_materials(std::vector<ObjChunk>& chunks, const std::string& obj_path, ObjFile& obj,
                      std::vector<ObjNotice>& notices);

}  // namespace oktett
