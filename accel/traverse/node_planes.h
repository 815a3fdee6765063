#pragma once
/// \file Planes of eight children in lanes, for nodes of either layout.

#include "accel/accel_data.h"
#include "core/simd_bytes.h"

namespace oktett {

/// Row 2 * axis + side of the planes of `node`.
template <class A>
OKTETT_INLINE Simd<float, BvhNode::kWidth, A> node_planes(const BvhNode& node, int row) {
  return Simd<float, BvhNode::kWidth, A>::load(node.plane[row]);
}
template <class A>
OKTETT_INLINE Simd<float, BvhNode::kWidth, A> node_planes(const CompactNode& node, int row) {
  using F = Simd<float, BvhNode::kWidth, A>;
  return load_bytes<A>(node.plane[row]) * F(node.scale(row / 2)) + F(node.origin[row / 2]);
}

}  // namespace oktett
