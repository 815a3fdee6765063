#pragma once
/// \file Four floats side by side for code that is compiled once, for the baseline.
///
/// Made from the compiler's vectors, which exist on all targets and give the same bits as floats alone. They
/// have the operators of floats; `mask ? a : b` chooses by lane. Code per instruction set uses core/simd.h.

#include <cmath>

namespace oktett {

using Four = float __attribute__((vector_size(16)));

inline Four four(float x) { return Four{x, x, x, x}; }
inline Four four(const float (&x)[4]) { return Four{x[0], x[1], x[2], x[3]}; }

/// The lesser and the greater lane by lane; the second where either is NaN.
inline Four min(Four a, Four b) { return a < b ? a : b; }
inline Four max(Four a, Four b) { return a > b ? a : b; }
inline Four min(Four a, float b) { return min(a, four(b)); }
inline Four max(Four a, float b) { return max(a, four(b)); }

inline Four magnitude(Four a) { return a < 0 ? -a : a; }
/// Correctly rounded.
inline Four square_root(Four a) {
#if defined(__SSE__)
  return __builtin_ia32_sqrtps(a);
#else
  return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}

}  // namespace oktett
