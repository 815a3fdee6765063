#pragma once
/// \file Random shapes from what they say of their parameters.

#include <type_traits>

#include "core/description.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

/// Draws the numbers, vectors and flags of a shape: between the ends of their range where it has two, lengths
/// from a twentieth to 2, coordinates in [-1, 1]. Leaves everything else as it is.
class RandomParameters : public ParameterVisitor<RandomParameters> {
 public:
  explicit RandomParameters(CaseRandom& random) : random_(random) {}

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    if constexpr (std::is_same_v<T, bool>)
      value = random_.unit() < 0.5;
    else if constexpr (std::is_same_v<T, double>)
      value = number(parameter.range);
    else if constexpr (std::is_same_v<T, Vec3d>)
      for (int k = 0; k < 3; ++k) value[k] = number(parameter.range);
    return false;
  }
  void normals() {}

 private:
  double number(const Range& range) {
    if (range.hi < kMaxCoordinate) return range.lo + (range.hi - range.lo) * random_.unit();
    return range.lo == 0 ? random_.magnitude(-1.3, 0.3) : random_.sign();
  }

  CaseRandom& random_;
};

/// A shape with random parameters.
template <class T>
T draw_shape(CaseRandom& random) {
  T shape;
  RandomParameters parameters(random);
  shape.describe(parameters);
  return shape;
}

}  // namespace oktett
