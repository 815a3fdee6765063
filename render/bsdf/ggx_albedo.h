#pragma once
/// \file Directional albedos of single scattering by GGX facets. What they leave of 1 is the light that
/// facets send to other facets; the lobes of render/bsdf/principled_lobes.h give it back.
///
/// The albedos come from tables that are computed when they are first needed, by numerical integration in a
/// fixed order: 10 to 20 ms for each table. They are raised by a bound of their error, 0.1 to 0.5 %, so that
/// what is given back is never too much.

#include "render/bsdf/albedo_table.h"

namespace oktett {

/// Facets that reflect all light.
class MirrorAlbedo {
 public:
  explicit MirrorAlbedo(double alpha) : alpha_(alpha) {}
  /// `mu`: cosine of the direction with the normal, in (0, 1].
  double operator()(double mu) const;
  /// 1 - the albedo for diffuse light.
  double mean_loss() const;

 private:
  double alpha_;
};

/// Two tables between which an albedo is interpolated, for indices of refraction.
template <class Tables>
struct TablePair {
  const Tables *first, *second;
  double place;  ///< 0: the first, 1: the second
};

/// The interface of a dielectric, reflected light only. `alpha` 0: the smooth interface.
class ReflectedAlbedo {
 public:
  struct Tables;
  /// `eta`: index of refraction, in [1, kMostIor].
  ReflectedAlbedo(double eta, double alpha);
  double operator()(double mu) const;
  double mean_loss() const { return mean_loss_; }

 private:
  double eta_, alpha_, mean_loss_;
  TablePair<Tables> tables_;
};

/// The interface of a dielectric, reflected and transmitted light together.
class GlassAlbedo {
 public:
  struct Tables;
  /// `eta`: index of refraction behind the interface relative to that before it, in [1 / kMostIor, kMostIor].
  GlassAlbedo(double eta, double alpha);
  double operator()(double mu) const;
  double mean_loss() const;

 private:
  double alpha_;
  TablePair<Tables> tables_;
};

inline constexpr double kMostIor = 4;

/// The fraction of diffuse light that a smooth dielectric reflects, within 0.001 for `eta` in [1, 4]
/// (Kulla 2017). From inside it is 1 - (1 - that) / eta^2.
double mean_fresnel(double eta);

}  // namespace oktett
