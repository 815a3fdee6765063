#pragma once
/// \file How the normals of exact surfaces are computed.

#include <cstdint>

namespace oktett {

/// How the normal of an exact surface is computed.
enum class NormalMethod : std::uint8_t {
  gradient,  ///< the gradient of the function
  forward,   ///< forward differences of the function
  central,   ///< central differences
};

}  // namespace oktett
