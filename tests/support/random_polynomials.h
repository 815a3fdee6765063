#pragma once
/// \file Polynomials that root finders find hard, and some that they do not, at random.

#include <cstdint>

#include "core/random.h"
#include "kernels/roots/roots.h"

namespace oktett::test {

/// Random numbers one after another, from a key.
class Sequence {
 public:
  explicit Sequence(std::uint64_t key) : state_(mix_bits(key + 0x9e3779b97f4a7c15ull)) {}
  std::uint64_t bits() { return mix_bits(state_ += 0x9e3779b97f4a7c15ull); }
  /// In [0, 1), 53 bits.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// In 0 ... n-1.
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }

 private:
  std::uint64_t state_;
};

/// How the roots lie, or the coefficients.
enum class RootClass {
  spread,         ///< real roots and complex pairs all over
  coefficients,   ///< random coefficients
  clustered,      ///< groups within 1e-2 to 1e-12
  near_multiple,  ///< double and triple roots, moved by the rounding of the coefficients
  multiple,       ///< double and triple roots, exactly
  tangent,        ///< pairs with imaginary parts from 1e-3 to 1e-14
  scaled,         ///< as `spread`, with variable and values at sizes from 2^-200 to 2^200
  sparse,         ///< zero coefficients, also first and last
  at_ends,        ///< roots at the ends of the interval, most of them exactly
  wild,           ///< coefficients and ends of very different sizes
  torus,          ///< degree 4 only: rays that graze or cross a torus; else as `spread`
};
inline constexpr int kRootClasses = 11;
const char* to_string(RootClass c);

/// A polynomial and where its roots are asked for.
struct RootProblem {
  roots::Polynomial p;
  double a, b;
};

/// Problem number `index` of a class; the same everywhere.
RootProblem random_problem(RootClass c, int degree, std::uint64_t index);

}  // namespace oktett::test
