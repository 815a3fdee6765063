#include "accel/compact_node.h"

#include <algorithm>
#include <cmath>

namespace oktett {
namespace {

constexpr int kSteps = 255;
/// Exponents of the least scale above 0, and of one whose 255 steps span all floats.
constexpr int kMinExponent = -126, kMaxExponent = 121;

/// Both planes of all children along one axis in steps of 2^exponent; false if the steps do not reach.
bool set_planes(CompactNode& node, const Box* boxes, int count, int axis, int exponent) {
  node.exponent[axis] = static_cast<std::uint8_t>(exponent + 127);
  const double origin = node.origin[axis], per_length = std::ldexp(1.0, -exponent);
  const int low = 2 * axis, high = low + 1;
  for (int i = 0; i < count; ++i) {
    const float lo = boxes[i].lo[axis], hi = boxes[i].hi[axis];
    const auto steps = [&](double place) {
      return static_cast<std::uint8_t>(std::clamp<double>((place - origin) * per_length, 0, kSteps));
    };
    node.plane[low][i] = steps(lo), node.plane[high][i] = steps(hi);
    // At 0 steps stands the origin, which is below all.
    while (node_plane(node, low, i) > lo) --node.plane[low][i];
    while (node_plane(node, high, i) < hi) {
      if (node.plane[high][i] == kSteps) return false;
      ++node.plane[high][i];
    }
  }
  return true;
}

}  // namespace

void set_boxes(CompactNode& node, const Box* boxes, int count) {
  Box all;
  for (int i = 0; i < count; ++i) all.grow(boxes[i]);
  node.present = static_cast<std::uint8_t>((1u << count) - 1);
  std::fill_n(&node.plane[0][0], sizeof node.plane, std::uint8_t{0});
  for (int axis = 0; axis < 3; ++axis) {
    node.origin[axis] = all.lo[axis];
    node.exponent[axis] = 0;
    const double extent = double(all.hi[axis]) - double(all.lo[axis]);
    if (!(extent > 0)) continue;
    int exponent = std::clamp(std::ilogb(extent / kSteps), kMinExponent, kMaxExponent);
    while (!set_planes(node, boxes, count, axis, exponent)) ++exponent;
  }
}

}  // namespace oktett
