#pragma once
/// \file The power of a cosine that shapes Phong's highlight.

#include "core/math.h"

namespace oktett {

/// Whole exponents up to 1024 are raised to by squaring; most materials have such exponents.
inline bool by_squaring(double exponent) {
  return exponent >= 0 && exponent <= 1024 &&
         static_cast<double>(static_cast<unsigned>(exponent)) == exponent;
}

/// `cosine`, in [0, 1] or NaN, to the power of a material's exponent.
inline double phong_power(double cosine, double exponent) {
  return by_squaring(exponent) ? portable::whole_power(cosine, static_cast<unsigned>(exponent))
                               : portable::pow(cosine, exponent);
}

}  // namespace oktett
