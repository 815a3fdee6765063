#pragma once
/// \file OBJ files before and after the MTL files that they name are read. Within io/ only.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/mesh/parsed_mesh.h"
#include "io/obj/chunk.h"

namespace oktett {

/// Reads `path` but no MTL files. The result has the positions of all statements. Throws Error as load_obj
/// does.
ParsedMesh parse_obj(const std::string& path);

/// Reads the MTL files of what was parsed from `path`; a mesh of another format names none.
MeshFile finish_obj(const std::string& path, ParsedMesh parsed);

/// The same, where `position` finds the lines of statements. It is called in the order of the text.
MeshFile finish_obj(const std::string& path, ParsedMesh parsed,
                    const std::function<TextPosition(std::uint64_t)>& position);

/// Gives all triangles of `mesh` their slots and lists the statements about materials; `text` begins the
/// file. More materials than slots can tell apart are noted as the failure of their chunk.
void assign_slots(std::vector<ObjChunk>& chunks, const char* text, ParsedMesh& parsed);

/// Loads the MTL files and sets materials and textures of `obj`. Appends warnings about the OBJ file to
/// `notices`, those about the MTL files to obj.warnings.
void resolve_materials(const std::vector<MeshStatement>& libraries,
                       const std::vector<MeshStatement>& materials, const std::string& obj_path, ObjFile& obj,
                       std::vector<MeshStatement>& notices);

}  // namespace oktett
