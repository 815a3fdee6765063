#pragma once
/// \file A Boolean combination as it stands in the tree. Data only; accel/csg makes it and evaluates it.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "accel/accel.h"

namespace oktett {

/// A node of a Boolean expression. Nodes stand in one list, parents before their children; those without
/// children are operands.
struct CsgNode {
  CsgOp op;
  bool is_first = false;         ///< the first of its siblings; a difference subtracts the others from it
  std::uint32_t parent = kNoId;  ///< kNoId: the root
  std::uint32_t children = 0;
};

/// One step of evaluating an expression for up to 32 rays at once, a bit each. The state of a node starts as
/// `initial`. From the last node to the first, each node's value, which is its state ^ flip, is and-ed into
/// the state of its parent. Unions hold complements, so that `and` serves them too (De Morgan).
struct CsgStep {
  std::uint32_t parent;
  std::uint32_t flip;
  std::uint32_t initial;
};

/// Expressions of at most this many nodes are evaluated as a whole, larger ones only for the operands that a
/// ray meets.
inline constexpr std::size_t kMaxCsgSteps = 32;

/// A combination in the tree. A *solid* of it is either one primitive of a shape, or a whole mesh, instance
/// or combination. A ray may be inside a solid of the second kind several times.
struct CsgItem {
  std::shared_ptr<const Accel> solids;    ///< a structure over all solids
  std::vector<std::uint32_t> operand_of;  ///< node of each geometry of `solids`
  /// Number of each geometry's first solid, and the number of solids at the end.
  std::vector<std::uint32_t> first_solid;
  std::vector<std::uint8_t> inverted;  ///< per geometry: 1 for a mesh that is wound inside out
  /// Such meshes inside instances: structure and geometry, sorted.
  std::vector<std::pair<const Accel*, std::uint32_t>> inverted_inside;
  std::vector<CsgNode> nodes;  ///< the root first
  std::vector<std::uint32_t>
      unbounded;                     ///< geometries of `solids` that a ray may be inside without a crossing
  std::vector<std::uint8_t> needed;  ///< per geometry: 1 if no point outside of it is in the combination
  /// The crossings of all solids can be listed for several rays at once (accel/traverse/csg_lanes.h).
  bool in_lanes = false;
  std::vector<std::uint32_t> leaf_order;  ///< leaves of `solids`, those with needed geometries first
  std::vector<CsgStep> steps;             ///< of all nodes, if there are at most kMaxCsgSteps
  std::uint32_t item = 0;                 ///< item of the combination in the structure that holds it
  /// Number of the first path through the combination, see csg_path().
  std::uint32_t first_path = 0;
};

/// The path of a hit with path `inner` inside the solids; `flipped` if its normal is turned round.
inline std::uint32_t csg_path(const CsgItem& csg, std::uint32_t inner, bool flipped) {
  return csg.first_path + 2 * (inner + 1) + static_cast<std::uint32_t>(flipped);
}

}  // namespace oktett
