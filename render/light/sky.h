#pragma once
/// \file The clear sky by day and the sun in it.
///
/// Preetham, Shirley, Smits 1999, "A practical analytic model for daylight". Departs from it in these points:
/// the sun's light is weakened at one wavelength per channel, and below the horizon there is a diffuse
/// ground.
///
/// Units: luminance in kcd / m^2 and illuminance in klx, split into channels so that the luminance of Rec.709
/// is that of the model. Sky and sun have the same scale.

#include <cstdint>

#include "core/vec3.h"
#include "render/light/emitter.h"
#include "render/light/environment_map.h"

namespace oktett {

struct SkyParameters {
  /// Unit vector towards the sun; the horizon is y = 0. A sun below it is dark, and the sky that of a sun at
  /// it.
  Vec3f sun{0, 1, 0};
  double turbidity = 3;            ///< 2 is very clear, 10 hazy; clamped to this range
  Color ground{0.2f, 0.2f, 0.2f};  ///< albedo of what is below the horizon
};

/// Light of the sky, and below the horizon of the ground.
class Sky {
 public:
  explicit Sky(const SkyParameters& parameters);

  /// The radiance that arrives from the unit vector `direction`; without the sun. Never negative.
  Color radiance(const Vec3f& direction) const;

  /// The sun, as a disk of 0.53 degrees.
  DirectionalEmitter sun() const;

  /// The sky as an environment. Each pixel has the radiance at its centre.
  EnvironmentPicture picture(std::uint32_t width = 512, std::uint32_t height = 256) const;

 private:
  /// Perez's distribution of one quantity over the sky.
  struct Distribution {
    double zenith, a, b, c, d, e;
    double factor;  ///< zenith value over the distribution there

    double shape(double cos_zenith, double angle, double cos_angle) const;
    double at(double cos_zenith, double angle, double cos_angle) const;
  };

  Color sky_radiance(const Vec3d& direction) const;
  Color sun_irradiance() const;

  SkyParameters parameters_;
  Vec3d sun_;  ///< unit; not below the horizon
  double turbidity_;
  Distribution luminance_, x_, y_;
  Color ground_;  ///< radiance
};

}  // namespace oktett
