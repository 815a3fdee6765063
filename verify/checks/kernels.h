#pragma once
/// \file Single kernels and root finders against the oracle, and kernels against themselves in every width
/// and instruction set.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/isa.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

/// The failure with the least number; numbers below the greatest 64-bit one.
struct FirstFailure {
  std::uint64_t first_failure = ~std::uint64_t{0};
  std::string failure;

  void fail(std::uint64_t number, const std::string& text) {
    if (number < first_failure) first_failure = number, failure = text;
  }
};

/// Counts over pairs of one kernel and class.
struct KernelTally : FirstFailure {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t undecided = 0;  ///< within the tolerance: either answer is right
  std::uint64_t wrong = 0;      ///< the answer, t, u or v outside the tolerance
  std::uint64_t excess = 0;     ///< boxes met by the slab test that the ray misses: allowed, but costs time
  std::uint64_t differing = 0;  ///< a width or instruction set gave other bits
  double worst_ulps = 0;        ///< of t in float, where the problem itself is well-conditioned

  void add(const KernelTally& other);
};

/// True where an answer outside the tolerance is a failure: not for the textbook tests at scales at which
/// their floats overflow or underflow.
bool must_be_right(KernelId id, CaseClass c);

/// Pairs are numbered from `first`. A function of its arguments alone.
KernelTally verify_kernel(KernelId id, CaseClass c, std::uint64_t rays, const std::vector<Isa>& isas,
                          std::uint64_t first = 0);

/// A ray in hexadecimal floats, exactly.
std::string exact_text(const Ray& ray);
/// The first ray that stands in a text as exact_text writes it; nothing if there is none.
std::optional<Ray> ray_in_text(const std::string& text);

// ---- Root finders against polynomials whose roots are known exactly.

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
