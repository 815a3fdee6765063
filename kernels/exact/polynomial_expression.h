#pragma once
/// \file Polynomials in x, y and z from a text.

#include <string_view>
#include <vector>

#include "kernels/exact/polynomial_data.h"

namespace oktett {

/// Most products of two terms that expanding a text may take. It bounds the time that a short text can take.
inline constexpr std::size_t kMaxTermProducts = 1'000'000;

/// The terms of left - right of an equation "left = right", or of the whole text if it has no `=`; sorted,
/// none of them 0, of degree at most roots::kMaxDegree. The text may hold what compile_function reads as long
/// as it is a polynomial: divisors and arguments of functions must be free of x, y and z, exponents whole.
/// Sums and products are computed in double-double arithmetic and rounded at the end.
///
/// Throws Error if the text cannot be read, is no polynomial, or is of too high a degree.
/// Error::where().column counts bytes in `equation` from 1.
std::vector<Monomial> expand_polynomial(std::string_view equation);

}  // namespace oktett
