#pragma once
/// \file Which binary nodes become wide ones: the choice of least surface-area cost, by dynamic programming
/// (Ylitie, Karras and Laine 2017, section 3). Leaves are whole blocks already, so only the places in wide
/// nodes are distributed. Costs are computed bottom-up while the binary tree is built; a node keeps only its
/// choices.

#include "accel/build/sah.h"
#include "core/platform.h"

namespace oktett {

/// Cost of a leaf: it takes one place, however many there are.
OKTETT_INLINE SubtreeCost leaf_cost(float area) {
  SubtreeCost c;
  for (float& p : c.places) p = area;
  return c;
}

/// Cost of an inner node of surface `area`, from the costs of its children. Returns BinaryNode::info.
OKTETT_INLINE std::uint32_t collapse(const SubtreeCost& l, const SubtreeCost& r, float area,
                                     SubtreeCost& out) {
  constexpr int W = BvhNode::kWidth;
  float shared[W + 1];
  std::uint32_t left[W + 1];
  for (int slots = 2; slots <= W; ++slots) {
    float best = l.places[0] + r.places[slots - 2];
    std::uint32_t best_left = 1;
    for (int k = 2; k < slots; ++k) {
      const float c = l.places[k - 1] + r.places[slots - k - 1];
      best_left = c < best ? static_cast<std::uint32_t>(k) : best_left;
      best = c < best ? c : best;
    }
    shared[slots] = best, left[slots] = best_left;
  }
  std::uint32_t info = BinaryNode::kInner | left[W] << 3 * (W - 2);
  out.places[0] = area + shared[W];
  for (int slots = 2; slots < W; ++slots) {
    const bool share = shared[slots] < out.places[slots - 2];
    out.places[slots - 1] = share ? shared[slots] : out.places[slots - 2];
    info |= (share ? left[slots] : 0) << 3 * (slots - 2);
  }
  return info;
}

}  // namespace oktett
