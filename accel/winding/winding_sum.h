#pragma once
/// \file What the sum over a tree of surfaces takes and gives; its code is compiled for each instruction set.

#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace oktett {

/// A winding number, in turns, and a bound on how far it is off.
struct WindingSum {
  double value = 0, error = 0;
};

/// A linear map that is no similarity, in which a tree is seen.
struct WindingMap {
  double linear[3][3];
  double cofactor[3][3];   ///< how area vectors turn
  double stretch, turned;  ///< bound how much the two lengthen vectors
  double side;             ///< -1 for a mirror, else 1
  double unit;             ///< roundings of what is mapped, relative to its size
};

/// The parts of a tree that are too near to be seen as a whole. Its code is compiled for the baseline.
class OpenParts {
 public:
  void push(std::uint32_t part);
  std::vector<std::uint32_t> list;
};

/// Coefficients of the arc tangent in float, from the highest power down.
extern const float kWindingAtan[8];

}  // namespace oktett
