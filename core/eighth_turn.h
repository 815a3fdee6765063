#pragma once
/// \file Sine and cosine of angles from -pi/4 to pi/4, in lanes: what portable::sin and portable::cos compute
/// after they have reduced the angle.

#include "core/lane_math.h"

namespace oktett {

/// The sine of an angle of up to an eighth of a turn, by Taylor's series.
template <class D>
OKTETT_INLINE D sin_of_eighth(const D& angle) {
  constexpr double kTaylor[] = {
      1 / 355687428096000.0, -1 / 1307674368000.0, 1 / 6227020800.0, -1 / 39916800.0,
      1 / 362880.0,          -1 / 5040.0,          1 / 120.0,        -1 / 6.0};
  const D square = angle * angle;
  return angle + angle * (square * polynomial_lanes(kTaylor, square));
}

/// The cosine of such an angle.
template <class D>
OKTETT_INLINE D cos_of_eighth(const D& angle) {
  constexpr double kTaylor[] = {-1 / 6402373705728000.0,
                                1 / 20922789888000.0,
                                -1 / 87178291200.0,
                                1 / 479001600.0,
                                -1 / 3628800.0,
                                1 / 40320.0,
                                -1 / 720.0,
                                1 / 24.0,
                                -1 / 2.0,
                                1};
  return polynomial_lanes(kTaylor, angle * angle);
}

}  // namespace oktett
