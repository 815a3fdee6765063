#pragma once
/// \file Root finders in lanes by themselves, for verification and benchmarks.

#include <cstddef>
#include <cstdint>

#include "core/isa.h"

namespace oktett {

/// The root finders in lanes: closed forms, and all or the first of the certified roots.
enum class RootsKernel : std::uint8_t { closed2, closed3, closed4, all2, all3, all4, all6, first4 };

/// `count` polynomials to be solved in lanes, for verification and benchmarks: coefficients by power, ends of
/// the interval (not used by closed forms), and the answers by rank.
struct RootsProbe {
  std::size_t count = 0;
  const double* c[7] = {};
  const double* a = nullptr;
  const double* b = nullptr;
  double* x[6] = {};
  double* error[6] = {};
  /// Where no certificate could be given.
  std::uint8_t* unsure = nullptr;
};

template <class A>
void run_roots(RootsKernel id, const RootsProbe& probe);

/// Eight polynomials at a time; one on the scalar path. Throws Error if this build holds no code for the set.
void probe_roots(Isa isa, RootsKernel id, const RootsProbe& probe);

}  // namespace oktett
