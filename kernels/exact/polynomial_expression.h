#pragma once
/// \file Equations in x, y and z that are polynomials, multiplied out.

#include <string_view>
#include <vector>

#include "kernels/exact/polynomial_data.h"

namespace oktett {

/// Most products of two terms on the way, so that no short text takes long.
inline constexpr std::size_t kMaxTermProducts = 1'000'000;

/// The terms of left - right of the equation "left = right", or of the text if it has no `=`, sorted, none
/// of them 0; no more than roots::kMaxDegree in all. Numbers, + - * /, `^`, the constants and functions of
/// parse_expression are allowed as long as the result is a polynomial: divisors and arguments of functions
/// must be free of x, y and z, exponents whole. Sums and products are computed in double-double arithmetic
/// and rounded at the end.
///
/// Throws Error as parse_expression does: `where().column` counts bytes in `equation` from 1.
std::vector<Monomial> expand_polynomial(std::string_view equation);

}  // namespace oktett
