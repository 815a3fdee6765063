#pragma once
/// \file What half-spaces have in common.

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/exact/polyhedron_data.h"

namespace oktett {

struct ConvexSolid {
  enum class Kind {
    solid,
    empty,      ///< nothing inside, or less than 1e-11 of its length thick
    unbounded,  ///< or a billion times longer than wide; also where what is unbounded may be empty
  };
  Kind kind = Kind::empty;
  /// Corners, each at least once, off by no more than 2^-40 of the size.
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> faces;  ///< the half-spaces that bound it, ascending
};

/// Clips a large square in each plane by all others. Normals must not be zero.
ConvexSolid intersect(std::span<const HalfSpace> half_spaces);

}  // namespace oktett
