#pragma once
/// \file Numbers of meshes in text. Within io/ only.

#include <cmath>
#include <limits>
#include <string>

#include "io/mesh/failure.h"
#include "io/text/number.h"

namespace oktett {

/// Beyond it, products of coordinates overflow in the tests of boxes (docs/numerics.md, Domain).
inline constexpr float kMostCoordinate = 1e30f;

/// False for NaN, too.
inline bool is_coordinate(float x) { return std::abs(x) <= kMostCoordinate; }

/// Throws the failure of the number at `p`.
[[noreturn]] void stop_at_number(const char* p, NumberProblem problem);
/// Throws the failure of the coordinate `x` at `p`.
[[noreturn]] void stop_at_coordinate(const char* p, float x);

/// The greatest magnitude of a texture coordinate: any finite number will do.
inline constexpr float kMostUv = std::numeric_limits<float>::max();

/// What is wrong with the coordinate `x`, which stands in no text.
std::string bad_coordinate(float x);

/// Reads the number at `p` and returns its end. Throws MeshFailure if there is none.
inline const char* read_number(const char* p, float& x) {
  NumberProblem problem = NumberProblem::none;
  const char* end = scan_float(p, x, problem);
  if (end == nullptr) stop_at_number(p, problem);
  return end;
}

/// The same; throws also if is_coordinate does not hold.
inline const char* read_coordinate(const char* p, float& x) {
  const char* end = read_number(p, x);
  if (!is_coordinate(x)) stop_at_coordinate(p, x);
  return end;
}

/// Like read_number; throws also if the number is not finite.
inline const char* read_uv_coordinate(const char* p, float& x) {
  const char* end = read_number(p, x);
  if (!std::isfinite(x)) stop_at_coordinate(p, x);
  return end;
}

}  // namespace oktett
