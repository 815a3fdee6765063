#pragma once
/// \file The scattering of a shading point, with directions in world space.

#include <optional>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/shading_frame.h"
#include "render/shading_point.h"

namespace oktett {

class SurfaceBsdf {
 public:
  explicit SurfaceBsdf(const ShadingPoint& p);

  /// Value and density for light from the unit vector `l`; black if the shading normal would let light leak
  /// through the true surface.
  BsdfValue evaluate(const Vec3f& l) const;
  /// A direction from which light may come, as Bsdf::sample. Nothing if it leads through a surface that does
  /// not transmit it.
  std::optional<BsdfSample> sample(float lobe, const SquareSample& u) const;
  bool only_delta() const { return bsdf_.only_delta(); }

 private:
  ShadingFrame<Bsdf::D> frame_;
  Bsdf bsdf_;
  bool transmits_;
};

}  // namespace oktett
