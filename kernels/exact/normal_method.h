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

/// The parameter of the surfaces that have a choice.
void describe_normals(auto& p, NormalMethod& method) {
  p.choice("normals", method,
           {{"gradient", NormalMethod::gradient},
            {"forward", NormalMethod::forward},
            {"central", NormalMethod::central}},
           "from the gradient of the function, or from its differences");
}

}  // namespace oktett
