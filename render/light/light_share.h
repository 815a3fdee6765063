#pragma once
/// \file What distance and angle leave of light.

#include <algorithm>

#include "core/math.h"
#include "render/light/light_fade.h"

namespace oktett {

/// The part of the light that is left at the distance `r`.
inline float faded_share(const LightFade& fade, double r) {
  return fade.fades() ? static_cast<float>(2 / (1 + portable::pow(r / fade.distance, fade.power))) : 1;
}

/// What a spot of a tightness leaves of its light in a direction, by the cosine of its angle to the axis.
inline float tight_share(double cosine, double tightness) {
  return tightness == 0 ? 1 : static_cast<float>(portable::pow(std::max(cosine, 0.0), tightness));
}

/// The part of the light of a beam at the distance `r` from its line.
inline float beam_share(const LightBeam& beam, double r) {
  if (!(r < beam.outer_radius)) return 0;
  const double t =
      r <= beam.inner_radius ? 1 : (beam.outer_radius - r) / (beam.outer_radius - beam.inner_radius);
  return static_cast<float>(t * t * (3 - 2 * t)) * tight_share(1 - r / beam.outer_radius, beam.tightness);
}

}  // namespace oktett
