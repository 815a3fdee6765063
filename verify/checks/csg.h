#pragma once
/// \file Boolean combinations against sampling: random trees of random solids, whose inside is known
/// independently.

#include <cstdint>
#include <string>
#include <vector>

#include "core/isa.h"

namespace oktett {

/// Rays through one tree.
inline constexpr std::size_t kRaysPerTree = 256;

struct CsgTally {
  std::uint64_t rays = 0, crossings = 0, samples = 0;
  std::uint64_t wrong_spans = 0;  ///< samples on the wrong side, farther from any change than the error bound
  std::uint64_t wrong_first = 0;  ///< closest_hit is not the first crossing of all_hits, or any_hit disagrees
  std::uint64_t wrong_inside =
      0;  ///< inside() differs from the oracle, farther from any change than its error
  std::uint64_t wrong_normal = 0;  ///< the normal does not point out of the combination
  std::uint64_t differing = 0;     ///< a mode, width or instruction set gave other bits
  std::string failure;             ///< the first one
  std::uint64_t tree = 0;          ///< the number of its tree

  std::uint64_t wrong() const { return wrong_spans + wrong_first + wrong_inside + wrong_normal + differing; }
};

/// `rays` rays through random trees of up to 64 operands and depth 12: spheres, boxes, tori, planes, convex
/// meshes, instances, some of them coincident. Trees are numbered from `first`. A function of its arguments
/// alone.
CsgTally verify_csg(std::uint64_t rays, const std::vector<Isa>& isas, std::uint64_t first = 0);

}  // namespace oktett
