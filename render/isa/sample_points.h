#pragma once
/// \file Points of Sobol's sequence for consecutive samples, for one instruction set.

#include <algorithm>

#include "render/sampling/owen_sobol.h"

namespace oktett {

/// sobol_point for the samples [first, last) of one sequence. Plain loops of fixed length, which compilers
/// turn into vector code.
template <class A>
void sobol_points_code(std::uint32_t first, std::uint32_t last, std::uint64_t key, double* x, double* y) {
  constexpr std::uint32_t kGroup = 16;
  const auto seed_x = static_cast<std::uint32_t>(key), seed_y = static_cast<std::uint32_t>(key >> 32);
  for (std::uint32_t begin = first; begin < last; begin += kGroup) {
    std::uint32_t number[kGroup];
    double at[2][kGroup];
    for (std::uint32_t k = 0; k < kGroup; ++k) number[k] = shuffled_sample(begin + k, key);
    for (std::uint32_t k = 0; k < kGroup; ++k)
      at[0][k] = reversed_bits(scrambled_upwards(number[k], seed_x)) * 0x1p-32;
    for (std::uint32_t k = 0; k < kGroup; ++k)
      at[1][k] = reversed_bits(scrambled_upwards(pascal_product(number[k]), seed_y)) * 0x1p-32;
    const std::uint32_t count = std::min(kGroup, last - begin);
    for (std::uint32_t k = 0; k < count; ++k) x[begin - first + k] = at[0][k];
    for (std::uint32_t k = 0; k < count; ++k) y[begin - first + k] = at[1][k];
  }
}

}  // namespace oktett
