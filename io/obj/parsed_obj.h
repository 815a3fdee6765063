#pragma once
/// \file What an OBJ file says before the MTL files that it names are read. Within io/ only.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "io/obj/chunk.h"
#include "io/text/scan.h"

namespace oktett {

/// Words at a place in the text.
struct ObjStatement {
  /// Of what no statement says.
  static constexpr std::uint64_t kNowhere = UINT64_MAX;

  std::uint64_t at = kNowhere;  ///< bytes from the start of the text
  std::string words;
  TextPosition position;  ///< of `at`; only filled in by parse_obj
};

/// Depends on the content of the OBJ file alone.
struct ParsedObj {
  TriangleMesh mesh;
  std::vector<ObjStatement> libraries;  ///< what follows `mtllib`
  std::vector<ObjStatement> materials;  ///< names of the material slots of the mesh
  std::vector<ObjStatement> notices;    ///< warnings
  bool has_faces = true;
};

/// Reads `path` but no MTL files. Throws Error as load_obj does.
ParsedObj parse_obj(const std::string& path);

/// Reads the MTL files of what parse_obj returned for `path`.
ObjFile finish_obj(const std::string& path, ParsedObj parsed);

/// The same, where `position` finds the lines of statements. It is called in the order of the text.
ObjFile finish_obj(const std::string& path, ParsedObj parsed,
                   const std::function<TextPosition(std::uint64_t)>& position);

/// Gives all triangles of `mesh` their slots and lists the statements about materials; `text` begins the
/// file. More materials than slots can tell apart are noted as the failure of their chunk.
void assign_slots(std::vector<ObjChunk>& chunks, const char* text, ParsedObj& parsed);

/// Loads the MTL files and sets materials and textures of `obj`. Appends warnings about the OBJ file to
/// `notices`, those about the MTL files to obj.warnings.
void resolve_materials(const std::vector<ObjStatement>& libraries, const std::vector<ObjStatement>& materials,
                       const std::string& obj_path, ObjFile& obj, std::vector<ObjStatement>& notices);

}  // namespace oktett
