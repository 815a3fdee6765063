#pragma once
/// \file The functions of functions.inc that are noise, and sums of its octaves. Within io/ only.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace oktett::pov {

/// The numbers of f_noise3d and of f_noise_generator.
inline constexpr std::uint32_t kNoiseFunction = 76, kNoiseGeneratorFunction = 78;

/// As internal_text. Nothing for functions of other kinds, and where a number that shapes the octaves is none
/// here.
std::optional<std::string> noise_text(std::uint32_t number, const std::vector<std::string>& operands);

}  // namespace oktett::pov
