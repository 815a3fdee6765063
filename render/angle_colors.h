#pragma once
/// \file Colours of mirrored light that change with the angle, in Whitted's model.

#include "core/vec3.h"

namespace oktett {

/// How far the colour of a metal has turned white, in [0, 1], for light whose direction has this cosine to
/// the normal: 0.06 at 60 degrees, 0.26 at 80, 1 at 90. The curve is that of POV-Ray's keyword `metallic`.
double metal_fade(double cosine);

/// A colour that is white where `part` is 1.
inline Color faded(const Color& color, double part) {
  return color + (Color{1, 1, 1} - color) * static_cast<float>(part);
}

/// By what a thin film on a surface multiplies light, as POV-Ray's `irid` does: 1 + weight * cos(2 pi *
/// thickness * cosines / wavelength) or 0, with wavelengths of 700, 520 and 480 nanometres, in which the
/// thickness is given. `cosines` is the sum of those between the normal and both directions of the light.
Color film_color(double weight, double thickness, double cosines);

}  // namespace oktett
