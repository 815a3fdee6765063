#pragma once
/// \file Hits of one mesh in columns, and their surfaces: what the code of each instruction set works on.

#include <cstddef>

#include "accel/interaction_block.h"
#include "accel/surface/mesh_surface.h"

namespace oktett {

/// `count` hits of one triangle mesh. Lanes work on groups of eight, so the last hit is repeated to the end
/// of its group.
struct MeshHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  MeshFrame frame;
  float corner[3][3][kMost];  ///< [corner][axis], in the mesh's own space
  float normal[3][3][kMost];  ///< normals at the corners, if frame.smooth; see MeshSurface
  float u[kMost], v[kMost];
  std::uint32_t entry[kMost];  ///< index of each hit in `out`
  InteractionBlock* out;       ///< receives the columns of MeshSurface
};

}  // namespace oktett
