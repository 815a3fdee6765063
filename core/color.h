#pragma once
/// \file Colours by the primaries of Rec. 709 and white D65.

#include "core/vec3.h"

namespace oktett {

/// The luminance of a colour.
inline float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// The colour that the CIE observer of 1931 sees as `xyz`. Channels are negative where the primaries cannot
/// show it.
inline Vec3d rec709_of(const Vec3d& xyz) {
  return {3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
          -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
          0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z};
}

}  // namespace oktett
