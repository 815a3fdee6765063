#pragma once
/// \file Materials as path tracing needs them.

#include <optional>
#include <vector>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/lobe_lanes.h"
#include "render/bsdf/phong_lobes.h"
#include "render/bsdf/principled_lobes.h"
#include "render/geometry.h"
#include "render/shading_point.h"

namespace oktett {

// ---- The scattering of a shading point, with directions in world space.

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
  bool chooses_diffuse(float lobe) const { return bsdf_.chooses_diffuse(lobe); }

 private:
  ShadingFrame<Bsdf::D> frame_;
  Bsdf bsdf_;
  bool transmits_;
};

// ---- Surfaces.

/// One side of a material, prepared for path tracing. Entry 2 m is the front of World::materials[m], entry
/// 2 m + 1 its back.
struct PathSurface {
  bool alone = false;       ///< textures: each hit has a surface of its own
  bool principled = false;  ///< which of the following holds
  bool transmits = false;   ///< light may pass to the other side
  bool only_delta = false;  ///< no light can be sampled
  bool glows = false;       ///< the material emits light on one side at least
  Color emission{0, 0, 0};
  PhongSurface phong;
  PrincipledSurface layers;
};

/// Two entries for each material of `world`.
std::vector<PathSurface> path_surfaces(const World& world);
/// What a hit shows that has a surface of its own, because of textures or of the solids around it.
PathSurface path_surface(const ShadingPoint& p);

/// The parameters of Phong's model, without textures.
PhongParameters phong_parameters(const Material& material);
/// The same with textures.
PhongParameters phong_parameters(const ShadingPoint& p);

}  // namespace oktett
