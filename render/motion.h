#pragma once
/// \file Transforms that change with time.

#include <memory>
#include <vector>

#include "core/transform.h"

namespace oktett {

/// A transform at a time.
struct MotionKey {
  double time = 0;
  Affine transform;  ///< invertible

  static constexpr const char* kMap = "a key of a motion";
  void describe(auto& p) {
    p.required("time", time, "later than that of the key before");
    p.required("transform", transform,
               "the transform at that time; not singular, and no mirror image of others");
  }
};

/// A product of transforms, the outermost first, each of which is given by keys of ascending times. Between
/// two keys translation and stretch change linearly and rotation by the shortest arc at constant speed
/// (Shoemake 1985); they are the factors of the polar decomposition (Shoemake and Duff 1992). Before the
/// first key and after the last one nothing changes.
struct Motion {
  std::vector<std::vector<MotionKey>> factors;  ///< none is empty

  /// The product at a time. At the time of a key its factor is exactly the key's transform.
  Affine at(double time) const;
  /// True if any factor has several keys.
  bool moves() const;
};

/// What moves things; null for what stands still.
using MotionPointer = std::shared_ptr<const Motion>;

}  // namespace oktett
