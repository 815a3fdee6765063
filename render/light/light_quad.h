#pragma once
/// \file A node of a LightTree: bounds of the emitters below each of up to four children, and the order in
/// which a choice among the children is made.

#include <cstdint>

namespace oktett {

/// The children stand in a row. A choice halves the row up to three times, each time at the boundary between
/// two neighbours, until one child is left. It uses one of two random numbers each time, so that points
/// spread evenly over a square are spread evenly over emitters that lie in a plane.
///
/// A child that is missing has power 0; those that are there come first.
struct alignas(64) LightQuad {
  static constexpr std::uint32_t kLanes = 4, kDecisions = 3;

  float center[3][kLanes];
  float radius[kLanes];
  float axis[3][kLanes];
  float cos_spread[kLanes];
  float sin_spread[kLanes];  ///< 1 beyond a right angle
  float cos_limit[kLanes];   ///< of the widest angle between axis and light
  float power[kLanes];       ///< of LightBounds, below 0 if that is true of `both_sides`
  /// Bit 0: kLeaf. Bits 1 to 27: the number of the quad or, of a leaf, of the emitter.
  /// Bits 28 and 29 of child k: the boundary of decision k, which is the number of the child behind it; 0 if
  /// there is no such decision. Bit 30: which random number decides.
  std::uint32_t child[kLanes];

  static constexpr std::uint32_t kLeaf = 1, kMostNumbers = 1u << 27;

  static constexpr std::uint32_t number(std::uint32_t child) { return child >> 1 & (kMostNumbers - 1); }
  std::uint32_t boundary(std::uint32_t decision) const { return child[decision] >> 28 & 3; }
  std::uint32_t dimension(std::uint32_t decision) const { return child[decision] >> 30 & 1; }
};
static_assert(sizeof(LightQuad) == 192);

}  // namespace oktett
