#pragma once
/// \file How a surface scatters light, as seen from one direction: Phong's model and one principled material.
///
/// Directions have unit length and lie in the local frame: z is the shading normal on the viewer's side, `wo`
/// leads to the viewer (wo.z > 0), `wi` to the light (wi.z < 0: the light comes through the surface).
/// Radiance is not scaled by the square of the index of refraction where light passes into a medium: along a
/// path from a camera to a light in the same medium these factors cancel. So what a white, lossless surface
/// scatters adds up to 1 on both sides together.
///
/// Parameters outside their ranges are clamped. All results are finite, for any finite parameters.

#include <optional>
#include <variant>

#include "core/vec3.h"
#include "render/bsdf/phong_lobes.h"
#include "render/bsdf/principled_lobes.h"
#include "render/sampling/warp.h"

namespace oktett {

/// The sample of a single lane, if there is one.
std::optional<BsdfSample> only_sample(const BsdfSamples<Simd<double, 1, ScalarIsa>>& s);

/// One surface seen from one direction: the lobes of the materials with a single lane.
class Bsdf {
 public:
  using D = Simd<double, 1, ScalarIsa>;

  Bsdf(const PhongSurface& surface, const Vec3f& wo) : lobes_(Phong(surface, wo)) {}
  Bsdf(const PrincipledSurface& surface, const Vec3f& wo) : lobes_(Principled(surface, wo)) {}

  /// Value and density of the lobes that are not delta, for light from `wi`.
  BsdfValue evaluate(const Vec3f& wi) const;
  /// A direction from which light may come. `lobe` in [0, 1) chooses the lobe, `u` the direction. Nothing if
  /// the light of that sample is absorbed.
  std::optional<BsdfSample> sample(float lobe, const SquareSample& u) const {
    return only_sample(samples(lobe, u));
  }
  /// The same as a lane.
  BsdfSamples<D> samples(float lobe, const SquareSample& u) const;
  /// Whether `sample` chooses a lobe that is diffuse: neither facets nor a highlight.
  bool chooses_diffuse(float lobe) const;
  /// Whether `evaluate` is black everywhere.
  bool only_delta() const;
  /// Whether light may pass to the other side.
  bool transmits() const;

 private:
  /// Lobes with the surface that they refer to.
  template <class Lobes>
  struct Kept {
    using Surface = typename Lobes::Surface;
    Kept(const Surface& s, const Vec3f& wo);
    Kept(const Kept& other) : surface(other.surface), lobes(other.lobes) { lobes.rebind(surface); }
    Kept& operator=(const Kept& other) {
      surface = other.surface, lobes = other.lobes;
      lobes.rebind(surface);
      return *this;
    }
    ~Kept() = default;
    Surface surface;
    Lobes lobes;
  };
  using Phong = Kept<PhongLobes<D>>;
  using Principled = Kept<PrincipledLobes<D>>;

  std::variant<Phong, Principled> lobes_;
};

/// `front`: the viewer is outside, where the geometric normal points to.
Bsdf phong_bsdf(const PhongParameters& parameters, const Vec3f& wo, bool front);
Bsdf principled_bsdf(const PrincipledParameters& parameters, const Vec3f& wo, bool front);

}  // namespace oktett
