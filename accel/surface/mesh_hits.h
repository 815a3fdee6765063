#pragma once
/// \file Hits of one mesh in columns, and their surfaces: what the code of each instruction set works on.

#include <cstddef>

#include "accel/surface/mesh_surface.h"

namespace oktett {

/// `count` hits of one triangle mesh. Lanes read and write whole groups of eight, so the entries between the
/// last hit and the end of its group must hold numbers, whatever their values.
struct MeshHits {
  static constexpr std::size_t kMost = 64;

  std::size_t count = 0;
  MeshFrame frame;
  float corner[3][3][kMost];  ///< [corner][axis], in the mesh's own space
  float normal[3][3][kMost];  ///< normals at the corners, if frame.smooth; see MeshSurface
  float u[kMost], v[kMost];

  /// The results: columns of MeshSurface.
  float position[3][kMost], position_error[3][kMost], geometric_normal[3][kMost], shading_normal[3][kMost];
};

}  // namespace oktett
