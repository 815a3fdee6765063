#pragma once
/// \file Random shapes from what they say of their parameters.

#include <type_traits>

#include "core/description.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

/// Fills the numbers, vectors and flags of a shape from `Source`, which has `bool flag()` and
/// `double number(const Range&)`. Leaves everything else as it is.
template <class Source>
class DrawnParameters : public ParameterVisitor<DrawnParameters<Source>> {
 public:
  explicit DrawnParameters(Source source) : source_(source) {}

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    if constexpr (std::is_same_v<T, bool>)
      value = source_.flag();
    else if constexpr (std::is_same_v<T, double>)
      value = source_.number(parameter.range);
    else if constexpr (std::is_same_v<T, Vec3d>)
      for (int k = 0; k < 3; ++k) value[k] = source_.number(parameter.range);
    return false;
  }
  void normals() {}

 private:
  Source source_;
};

/// Random numbers: between the ends of their range where it has two, lengths from a twentieth to 2,
/// coordinates in [-1, 1].
struct RandomSource {
  CaseRandom& random;

  bool flag() { return random.unit() < 0.5; }
  double number(const Range& range) {
    if (range.hi < kMaxCoordinate) return range.lo + (range.hi - range.lo) * random.unit();
    return range.lo == 0 ? random.magnitude(-1.3, 0.3) : random.sign();
  }
};

/// A shape with random parameters.
template <class T>
T draw_shape(CaseRandom& random) {
  T shape;
  DrawnParameters parameters(RandomSource{random});
  shape.describe(parameters);
  return shape;
}

}  // namespace oktett
