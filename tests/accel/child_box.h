#pragma once
/// \file The boxes of a node, for tests that walk trees.

#include "accel/node.h"
#include "core/box.h"

namespace oktett {

/// The box of child `i`.
inline Box child_box(const BvhNode& node, int i) {
  return {{node.plane[0][i], node.plane[2][i], node.plane[4][i]},
          {node.plane[1][i], node.plane[3][i], node.plane[5][i]}};
}

}  // namespace oktett
