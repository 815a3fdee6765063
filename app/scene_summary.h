#pragma once
/// \file Counting what a scene holds.

#include <cstdint>

#include "core/box.h"
#include "render/scene.h"

namespace oktett {

/// Things that instances show several times count once, unless stated otherwise.
struct SceneSummary {
  std::uint64_t meshes = 0;
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t mesh_bytes = 0;
  std::uint64_t other_shapes =
      0;  ///< objects that are neither mesh nor instance; a list of spheres counts each
  std::uint64_t instances = 0;
  double triangles_shown = 0;    ///< counting every instance
  std::uint64_t unbounded = 0;   ///< infinite planes
  Box bounds;                    ///< of all that is shown and bounded; empty if nothing is
  std::uint64_t open_edges = 0;  ///< summed over meshes; see find_open_edges
};

SceneSummary summarize(const Scene& scene);

}  // namespace oktett
