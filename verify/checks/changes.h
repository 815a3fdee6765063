#pragma once
/// \file Structures that change against structures made afresh.

#include <cstdint>
#include <string>
#include <vector>

#include "core/isa.h"

namespace oktett {

struct ChangesTally {
  std::uint64_t sequences = 0, changes = 0, rays = 0, hits = 0;
  std::uint64_t builds = 0, refits = 0;  ///< of trees of meshes after the first
  std::uint64_t differing = 0;           ///< rays with other bits than in a structure made afresh
  std::uint64_t altered = 0;             ///< rays with other hits than before in a structure that was kept
  std::string failure;                   ///< the first one
  std::uint64_t sequence = 0;            ///< its number

  std::uint64_t wrong() const { return differing + altered; }
};

/// `count` sequences of random changes to a DynamicAccel of meshes, spheres, exact surfaces, other shapes and
/// instances: added, removed, hidden, shown, masked, moved, bent, crumpled, torn apart, set to NaN and back.
/// After some of them, rays are traced through it, through one made afresh of the same geometries, and
/// through a structure that was taken earlier. Sequences are numbered from `first`. A function of its
/// arguments alone.
ChangesTally verify_changes(std::uint64_t count, const std::vector<Isa>& isas, std::uint64_t first = 0);

}  // namespace oktett
