#pragma once
/// \file Boolean combinations of solids (slides: intervals along the ray, combined up the tree). The solids
/// of one combination stand in a structure of their own; a ray's crossings with all of them are gathered
/// there, sorted, and swept once.
///
/// Departs from the slides in that no intervals are built: each crossing turns the state of one operand, and
/// only the nodes above it whose state turns with it are looked at, so that k crossings among any number of
/// operands cost about k log k.

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "accel/hit_list.h"
#include "core/box.h"

namespace oktett {

/// A node of a Boolean expression in its flat form. Leaves stand for operands.
struct CsgNode {
  CsgOp op;
  bool is_first = false;         ///< among its siblings: what the others are subtracted from
  std::uint32_t parent = kNoId;  ///< kNoId: the root
  std::uint32_t children = 0;
};

/// One step of evaluating an expression for many rays, a bit each. A node begins with `initial`; from the
/// last node to the first, its value is its state ^ flip, which is and-ed into the state of its parent. (A
/// union keeps the complement of its value.)
struct CsgStep {
  std::uint32_t parent;
  std::uint32_t flip;
  std::uint32_t initial;
};

/// A combination in the tree. A *solid* of it is a primitive of a shape, or a mesh, instance or combination
/// as a whole: of these, a ray may be inside several times.
struct CsgItem {
  std::shared_ptr<const Accel> solids;
  std::vector<std::uint32_t> operand_of;  ///< node of each geometry of `solids`
  std::vector<std::uint32_t>
      first_solid;                     ///< number of each geometry's first solid, plus the total at the end
  std::vector<std::uint8_t> inverted;  ///< per geometry: a mesh wound inside out
  /// Such meshes inside of instances: structure and geometry, in order.
  std::vector<std::pair<const Accel*, std::uint32_t>> inverted_inside;
  std::vector<CsgNode> nodes;            ///< the root first
  std::vector<std::uint32_t> unbounded;  ///< geometries of `solids` that no crossing need tell of
  std::vector<std::uint8_t> needed;      ///< per geometry: whoever is outside of it is outside of all
  /// Every solid lists its crossings with many rays at once (accel/csg/csg_lanes.h).
  bool in_lanes = false;
  std::vector<std::uint32_t> leaf_order;  ///< leaves of `solids`, those with what is needed first
  std::vector<CsgStep> steps;             ///< of all nodes, if there are at most kMaxCsgSteps
  std::uint32_t item = 0;
  /// A hit with path p inside `solids` has path first_path + 2 (p + 1) + (1 if its normal is turned round).
  std::uint32_t first_path = 0;
};

inline std::uint32_t csg_path(const CsgItem& csg, std::uint32_t inner, bool flipped) {
  return csg.first_path + 2 * (inner + 1) + static_cast<std::uint32_t>(flipped);
}

/// The expression with all its solids moved.
CsgExpression moved(CsgExpression e, const Affine& m);

/// The combination's nodes, and the structure over its solids.
CsgItem build_csg(const CsgExpression& expression, const BuildOptions& options);

/// A box that holds the solid: intersections and differences are smaller than their operands. Empty if there
/// is nothing, infinite if it is unbounded.
Box csg_bounds(const CsgItem& csg);

/// Distances by which crossings count as coincident: what rounding t to float, and the surfaces themselves,
/// leave open.
inline float coincidence(float t, float slack) { return t * 0x1p-21f + slack; }

/// The slack for a ray: a few roundings of the coordinates in `accel`, in units of t.
float coincidence_slack(const Accel& accel, const Ray& ray);

/// Expressions of at most this many nodes are evaluated as a whole; of larger ones, what a ray meets.
inline constexpr std::size_t kMaxCsgSteps = 32;

/// The steps for the operands `operands` (nodes, `count` of them) and all nodes above them; each operand is
/// replaced by its place among the steps. The root comes first. Valid until the next call on this thread.
std::vector<CsgStep>& csg_steps(const CsgItem& csg, std::uint32_t* operands, int count);

/// One ray's way through a combination. Crossings that coincide are applied together, so that spans without
/// length vanish; of those that turn the whole, the one of the same turn with the least item counts.
class CsgSweep {
 public:
  CsgSweep();
  ~CsgSweep();
  CsgSweep(const CsgSweep&) = delete;
  CsgSweep& operator=(const CsgSweep&) = delete;

  /// To be filled with the crossings of the ray, from its beginning to infinity, with csg.solids, in any
  /// order.
  HitList& solids() { return list_; }
  /// The first crossing of the combination; its path in `csg` says which surface is seen, and from what side.
  bool first(const CsgItem& csg, const Ray& ray, Crossing& found);
  /// Appends all crossings within the ray's range.
  void all(const CsgItem& csg, const Ray& ray, HitList& out);

 private:
  HitList list_;
};

}  // namespace oktett
