#pragma once
/// \file Writing OBJ meshes and the MTL files beside them; and whether a file that was written says the
/// materials that it should. Within io/ only.

#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"
#include "render/material.h"

namespace oktett {

/// Writes the mesh to `path`, and its materials, if there are some, to an MTL file of that name beside it.
/// Images that are in no file of their own become files beside it, too. Returns what the files cannot say.
/// Throws Error of kind io if that fails.
MeshLosses write_obj(const std::string& path, const MeshFile& file);

/// Whether two materials scatter light alike, their names and textures aside.
inline bool is_same_material(Material a, Material b) {
  for (Material* m : {&a, &b}) {
    m->name.clear(), m->interior = kNoId;
    for_each_texture(*m, [](std::uint32_t& index) { index = kNoId; });
    if (!m->principled) continue;
    m->principled->resembled = false;
    PrincipledParameters& p = m->principled->parameters;
    p.base_color = m->color;
    // How thick it is shows only through glass.
    if (p.transmission == 0) p.thin = false;
  }
  return a == b;
}

/// Instead, where files that were written may not be read.
inline constexpr const char* kNotCompared =
    "changed: perhaps materials, which are not compared because --root keeps what was written from being "
    "read";

/// Adds the loss that `format` cannot say the materials of these names as they are, if there are any.
inline void note_changed(const std::vector<std::string>& names, const char* format, MeshLosses& losses) {
  if (names.empty()) return;
  losses.push_back("changed: " + count_of(names.size(), "material") + ", which " + format +
                   " says only nearly ('" + names.front() + (names.size() > 1 ? "' and others)" : "')"));
}

}  // namespace oktett
