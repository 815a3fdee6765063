#pragma once
/// \file What describes a lathe: a surface of revolution whose profile is any curve.

#include <vector>

#include "kernels/exact/revolution_data.h"

namespace oktett {

/// As RevolutionShape for any plane curve of cubic Bezier pieces, which need not ascend.
struct LatheShape {
  std::vector<ProfilePoint> points;  ///< 3 n + 1 control points; pieces share their ends
  bool open = false;                 ///< without the disks at the curve's ends
};

}  // namespace oktett
