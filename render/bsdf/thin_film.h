#pragma once
/// \file Reflection by a thin transparent film on a surface: Airy's formula (Born 1999, section 7.6), summed
/// over the wavelengths that red, green and blue of Rec.709 see (Wyman 2013). So thick films show no colours.
/// The thin-film layer of Belcour 2017 has the same integral in closed form for narrow bands.

#include "core/lanes.h"
#include "core/vec3.h"

namespace oktett {

/// A film with vacuum or air before it.
class ThinFilm {
 public:
  ThinFilm() = default;
  /// `ior` >= 1: of the film; `thickness` in nanometres. `eta` > 0 and `k`: the index of refraction eta + i k
  /// of what lies below for the light of each channel.
  ThinFilm(double ior, double thickness, const Vec3d& eta, const Vec3d& k = {});

  /// The part of unpolarised light that is reflected, within [0, 1]: of a white of equal power at all
  /// wavelengths. `cosine` in [0, 1]: of the angle of incidence.
  Vec3d reflectance(double cosine) const;
  template <class D>
  OKTETT_INLINE Vec3<D> reflectance(const D& cosine) const {
    double lanes[D::kWidth], r[3][D::kWidth];
    cosine.store(lanes);
    for (int i = 0; i < D::kWidth; ++i) {
      const Vec3d color = reflectance(lanes[i]);
      for (int k = 0; k < 3; ++k) r[k][i] = color[k];
    }
    return {D::load(r[0]), D::load(r[1]), D::load(r[2])};
  }

 private:
  double ior_ = 1, thickness_ = 0;  ///< micrometres
  Vec3d eta_{1, 1, 1}, k_{0, 0, 0};
  int indices_ = 1;  ///< 1: all channels have the same index of refraction below; else 3
};

/// The index of refraction of a dielectric that reflects the part `head_on` of light that meets it head-on
/// from air; of nearly all light, that of 0.9999 of it.
double ior_of_head_on(double head_on);

}  // namespace oktett
