#pragma once
/// \file Whether a file that was written says the materials that it should. Within io/ only.

#include <string>
#include <vector>

#include "io/mesh/mesh_output.h"
#include "render/material.h"

namespace oktett {

/// Whether two materials scatter light alike, their names and textures aside.
inline bool is_same_material(Material a, Material b) {
  for (Material* m : {&a, &b}) {
    m->name.clear();
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
