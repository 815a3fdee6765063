#pragma once
/// \file What describes an exact surface: one that is found by solving an equation along the ray. Each in its
/// own space; any affine transform may follow.

#include <cstdint>
#include <variant>

#include "core/vec3.h"

namespace oktett {

/// How the normal of an exact surface is computed.
enum class NormalMethod : std::uint8_t {
  gradient,  ///< exact
  forward,   ///< forward differences of the function
  central,   ///< central differences
};

/// (major - sqrt(x^2 + y^2))^2 + z^2 = minor^2 (slides). With minor > major the surface meets itself on the
/// axis.
struct TorusShape {
  double major = 0.7;  ///< >= 0
  double minor = 0.3;  ///< > 0
};

/// One of them, in the order of ExactShapes in kernels/primitives.h.
using ExactForm = std::variant<TorusShape>;

struct ExactShape {
  ExactForm form;
  NormalMethod normals = NormalMethod::gradient;
};

}  // namespace oktett
