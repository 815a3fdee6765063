#pragma once
/// \file Which noise there is to choose from.

#include <cstdint>

namespace oktett {

/// Which noise patterns are made of: Perlin's of 2002, or that of one of the numbers of POV-Ray's
/// `noise_generator`.
enum class NoiseGenerator : std::uint8_t { own, povray_1, povray_2, povray_3 };

}  // namespace oktett
