#pragma once
/// \file Measured metals: complex indices of refraction at 630, 532 and 467 nm, for red, green and blue.
///
/// Interpolated linearly by wavelength in the tables of Johnson and Christy 1972 (gold, silver, copper) and
/// 1974 (iron, nickel, chromium, titanium) and of Rakic 1995 (aluminium). They are for clean, polished metal
/// at room temperature.

#include "core/description.h"
#include "render/bsdf/optics.h"
#include "render/bsdf/principled_parameters.h"

namespace oktett {

/// The metals by their names.
inline constexpr Choice<Conductor> kMetals[] = {
    {"gold", {{0.188f, 0.544f, 1.325f}, {3.403f, 2.231f, 1.863f}}},
    {"silver", {{0.057f, 0.054f, 0.048f}, {4.254f, 3.429f, 2.823f}}},
    {"copper", {{0.275f, 1.116f, 1.248f}, {3.373f, 2.596f, 2.465f}}},
    {"aluminium", {{1.430f, 0.939f, 0.693f}, {7.508f, 6.420f, 5.659f}}},
    {"iron", {{2.892f, 2.895f, 2.654f}, {3.065f, 2.918f, 2.810f}}},
    {"nickel", {{1.990f, 1.877f, 1.770f}, {4.094f, 3.495f, 3.062f}}},
    {"chromium", {{3.145f, 3.034f, 2.474f}, {3.312f, 3.330f, 3.220f}}},
    {"titanium", {{2.698f, 2.479f, 2.310f}, {3.757f, 3.351f, 3.088f}}}};

/// What a metal reflects of light that meets it head-on, from air.
OKTETT_INLINE Color head_on_color(const Conductor& metal) {
  Color color;
  for (int k = 0; k < 3; ++k)
    color[k] = static_cast<float>(conductor_fresnel(1, double{metal.eta[k]}, double{metal.k[k]}));
  return color;
}

}  // namespace oktett
