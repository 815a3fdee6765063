#pragma once
/// \file The scattering of a shading point, with directions in world space.

#include <optional>

#include "render/bsdf/bsdf.h"
#include "render/shading_point.h"

namespace oktett {

/// The parameters of Phong's model, without textures.
PhongParameters phong_parameters(const Material& material);

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
  /// Whether light may pass to the other side.
  bool transmits() const { return transmits_; }

 private:
  /// An orthonormal frame about the shading normal.
  struct Frame {
    explicit Frame(const Vec3f& n);
    Vec3f to_local(const Vec3f& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3f to_world(const Vec3f& v) const { return normalize(x * v.x + y * v.y + z * v.z); }
    Vec3f x, y, z;
  };

  Frame frame_;
  Vec3f ng_;
  Bsdf bsdf_;
  bool transmits_;
};

}  // namespace oktett
