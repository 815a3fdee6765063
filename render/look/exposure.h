#pragma once
/// \file How much of a mesh is seen from outside, and what it hides.

#include "render/look/mesh_explorer.h"

namespace oktett {

/// Shares of the surface of a mesh, by samples.
struct Exposure {
  double front = 0;   ///< that who stands outside sees from the front
  double back = 0;    ///< that he sees from the back only
  double hidden = 0;  ///< that he does not see
  /// Of what is hidden, the part from whose front, and from whose back, straight ways lead to the front of a
  /// wall behind which there is nothing. In a furnished room the first is greater. In a mesh that is turned
  /// inside out, with something in it, the second is.
  double facing = 0, averted = 0;
  double square = 0;  ///< that is level or upright
};

/// `up` is a unit vector.
Exposure exposure_of(const MeshExplorer& mesh, const Vec3d& up);

}  // namespace oktett
