#pragma once
/// \file The arithmetic between the corners of a cell of Perlin's noise, for numbers, ranges and lanes: the
/// same operations, so the same bits. For core/noise.cpp and core/noise_code.h.

#include "core/platform.h"

namespace oktett::noise_steps {

/// 0 at 0 and 1 at 1, with first and second derivatives of 0 there.
template <class T>
OKTETT_INLINE T fade(const T& t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

template <class T>
OKTETT_INLINE T mix(const T& a, const T& b, const T& t) {
  return a + (b - a) * t;
}

/// From the values at the corners, and the faded place between them.
template <class T>
OKTETT_INLINE T between(const T (&c)[8], const T (&t)[3]) {
  const T low = mix(mix(c[0], c[1], t[0]), mix(c[2], c[3], t[0]), t[1]);
  const T high = mix(mix(c[4], c[5], t[0]), mix(c[6], c[7], t[0]), t[1]);
  return mix(low, high, t[2]);
}

}  // namespace oktett::noise_steps
