#pragma once
/// \file Glass that bends red, green and blue differently. A path or photon that meets it goes on with one of
/// them, chosen at random by what it carries and weighted such that the mean is right.

#include "render/shading_point.h"

namespace oktett {

/// Whether glass of these parameters bends colours differently.
inline bool disperses(const PrincipledParameters& p) {
  return p.dispersion > 0 && p.transmission > 0 && p.metallic < 1 && !p.thin;
}

inline bool disperses(const ShadingPoint& p) { return p.principled && disperses(*p.principled); }

/// The index of refraction of channel 0, 1 or 2, whose light counts as that of 630, 532 and 467 nm as for
/// metals. `ior` holds at 587.56 nm. Cauchy's formula A + B / wavelength^2 with the Abbe number
/// 20 / dispersion (KHR_materials_dispersion). On the side of 1 on which `ior` is.
float dispersed_ior(float ior, float dispersion, int channel);

/// Gives `p`, which disperses light, the index of refraction of one channel. Returns the factors for
/// what the path carries, `carried`; 0 for the other channels. `u` in [0, 1) chooses.
Color disperse(ShadingPoint& p, const Color& carried, float u);

}  // namespace oktett
