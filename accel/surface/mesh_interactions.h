#pragma once
/// \file Hits of one mesh on their way to surfaces: columns that the code of each instruction set works on.

#include <cstddef>

#include "core/transform.h"

namespace oktett {

/// `count` hits of one triangle mesh. Columns are read in groups of eight; what follows the last hit must be
/// numbers, any numbers.
struct MeshInteractions {
  static constexpr std::size_t kMost = 64;

  std::size_t count = 0;
  float corner[3][3][kMost];  ///< [corner][axis], as the mesh has them
  float normal[3][3][kMost];  ///< zero where a corner has none
  float u[kMost], v[kMost];
  bool smooth = false;               ///< `normal` holds something
  const Affine* to_world = nullptr;  ///< null where the mesh stays in its place
  const Affine* inverse = nullptr;
  bool mirrored = false;

  /// What SurfaceInteraction has of these names.
  float position[3][kMost], position_error[3][kMost], geometric_normal[3][kMost], shading_normal[3][kMost];
};

}  // namespace oktett
