#pragma once
/// \file Sheen: light scattered by short fibres upon a surface, after Zeltner 2022. The lobe is a clamped
/// cosine under a linear map that depends on the viewer, so it is not reciprocal. The coefficients are the
/// rational fits of the MaterialX library to the paper's tables.

#include "core/vec3.h"
#include "render/sampling/square_sample.h"

namespace oktett {

class SheenLobe {
 public:
  SheenLobe() = default;
  /// `wo`: the unit direction to the viewer, wo.z > 0. `roughness`: [0, 1]; small values show at grazing
  /// angles only.
  SheenLobe(const Vec3d& wo, double roughness);

  /// The fraction of light from the viewer's direction that the fibres scatter; the rest passes below.
  double albedo() const { return albedo_; }
  /// f cos / albedo: the density per solid angle of the directions that `sample` gives; its integral is 1.
  double density(const Vec3d& wi) const;
  Vec3d sample(const SquareSample& u) const;

 private:
  double albedo_ = 0;
  double a_ = 1, b_ = 0;          ///< of the map to a cosine: x' = a x + b z, y' = a y, z' = z
  double cosine_ = 1, sine_ = 0;  ///< of the viewer's azimuth
};

}  // namespace oktett
