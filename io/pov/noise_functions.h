#pragma once
/// \file The functions of functions.inc that are noise, and sums of its octaves. Within io/ only.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/noise_generator.h"

namespace oktett::pov {

/// The numbers of f_noise3d and of f_noise_generator.
inline constexpr std::uint32_t kNoiseFunction = 76, kNoiseGeneratorFunction = 78;

/// The noise that a number behind `noise_generator` names: 1, 2 or 3, else the nearest of them.
inline NoiseGenerator noise_generator_named(double number) {
  return number < 2   ? NoiseGenerator::povray_1
         : number < 3 ? NoiseGenerator::povray_2
                      : NoiseGenerator::povray_3;
}

/// The noise of a generator at a place of three formulas, as a formula. Generator 3 has no tables here: it is
/// the noise of expressions, which has other values.
std::string noise_formula(NoiseGenerator generator, const std::string& x, const std::string& y,
                          const std::string& z);

/// As internal_text. Nothing for functions of other kinds, and where a number that shapes the octaves is none
/// here.
std::optional<std::string> noise_text(std::uint32_t number, const std::vector<std::string>& operands,
                                      NoiseGenerator generator);

}  // namespace oktett::pov
