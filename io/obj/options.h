#pragma once
/// \file How an OBJ file is taken apart. The result does not depend on it; tests use it to reach corner
/// cases.

#include <cstddef>
#include <string>

#include "io/obj/obj.h"

namespace oktett {

struct ObjOptions {
  /// Bytes that one task reads at a time, rounded up to whole lines.
  std::size_t chunk_bytes = std::size_t{1} << 20;
  /// The most positions, normals, uvs or triangles there may be: what 32-bit indices reach beside kNoId.
  std::size_t max_elements = 0xfffffffeu;
};

/// As load_obj(path).
ObjFile load_obj(const std::string& path, const ObjOptions& options);

}  // namespace oktett
