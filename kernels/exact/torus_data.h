#pragma once
/// \file What describes a torus.

namespace oktett {

/// (major - sqrt(x^2 + y^2))^2 + z^2 = minor^2 (slides). With minor > major the surface meets itself on the
/// axis.
struct TorusShape {
  double major = 0.7;  ///< >= 0
  double minor = 0.3;  ///< > 0
};

}  // namespace oktett
