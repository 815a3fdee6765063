#pragma once
/// \file Infinity and NaN under short names, for inputs and expected values; kInfinity of core/math.h is a
/// double.

#include <limits>

namespace oktett {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr double kNanDouble = std::numeric_limits<double>::quiet_NaN();

}  // namespace oktett
