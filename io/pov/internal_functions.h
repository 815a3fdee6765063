#pragma once
/// \file The functions that functions.inc declares by a number, as formulas of their operands. Within io/
/// only.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/noise_generator.h"

namespace oktett::pov {

/// The function as an expression (kernels/functions/expression.h) of its operands, which are expressions,
/// too. Nothing if it has no formula here, or if the operands are too few. Functions with a field strength
/// have no bounds, which do not move surfaces. `generator` is that of f_noise3d.
std::optional<std::string> internal_text(std::uint32_t number, const std::vector<std::string>& operands,
                                         NoiseGenerator generator);

/// The value of the function, which those with a field strength keep between -10 and 10. Nothing as above.
std::optional<double> internal_value(std::uint32_t number, std::span<const double> operands);

}  // namespace oktett::pov
