#pragma once
/// \file Root finders against polynomials whose roots are known exactly.

#include <cstdint>
#include <string>

namespace oktett {

/// Degrees 1 to this one are checked.
inline constexpr int kKnownRootsDegree = 8;

struct RootsTally {
  std::uint64_t polynomials = 0;
  std::uint64_t roots = 0;      ///< that they have in their intervals, counted with multiplicity
  std::uint64_t uncertain = 0;  ///< answers without a certificate, of methods that need not give one
  std::uint64_t wrong = 0;      ///< answers that are not true
  std::string failure;          ///< the first one
  std::uint64_t first_failure = 0;
};

/// Solves the polynomials `first` to `first` + `count` - 1 of a degree with each method that gives
/// certificates. Roots lie on a grid of whole numbers over a power of two, some of them close together or
/// equal, and so do the real and imaginary parts of complex pairs; the grid is so coarse that the
/// coefficients are exact. Every root must lie in a reported interval, and each interval must hold as many
/// roots as it says, see roots::Root.
RootsTally verify_roots(int degree, std::uint64_t count, std::uint64_t first = 0);

}  // namespace oktett
