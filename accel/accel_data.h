#pragma once
/// \file The acceleration structure. Data only; accel/build makes it, accel/traverse traces rays through it.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "accel/node.h"
#include "core/pages.h"
#include "core/platform.h"
#include "kernels/closed_forms.h"
#include "kernels/exact/exact_pool.h"
#include "kernels/triangle/triangle_block.h"

namespace oktett {

// ---- A Boolean combination as it stands in the tree. Data only; accel/csg makes it and evaluates it.

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

/// A primitive outside of which there is nothing of a combination.
struct CsgProbe {
  LeafEntry leaf;  ///< holds it alone
  std::uint32_t geometry;
  bool unbounded;
};

/// A combination in the tree. A *solid* of it is either one primitive of a shape, or a whole mesh, instance
/// or combination. A ray may be inside a solid of the second kind several times.
struct CsgItem {
  std::shared_ptr<const Accel> solids;    ///< a structure over all solids
  std::vector<std::uint32_t> operand_of;  ///< node of each geometry of `solids`
  /// Number of each geometry's first solid, and the number of solids at the end.
  std::vector<std::uint32_t> first_solid;
  bool has_meshes = false;     ///< among the solids and in instances of them
  bool has_surfaces = false;   ///< some nodes are CsgOp::surfaces
  std::vector<CsgNode> nodes;  ///< the root first
  std::vector<std::uint32_t>
      unbounded;                     ///< geometries of `solids` that a ray may be inside without a crossing
  std::vector<std::uint8_t> needed;  ///< per geometry: 1 if no point outside of it is in the combination
  std::vector<std::uint8_t> unseen;  ///< per geometry: 1 if it only cuts; empty if none does
  /// The crossings of all solids can be listed for several rays at once (accel/traverse/csg_lanes.h).
  bool in_lanes = false;
  /// All solids are shapes: crossings with several rays at once can be listed, but are swept one by one.
  bool listed = false;
  std::vector<std::uint32_t> leaf_order;  ///< leaves of `solids`, those with needed geometries first
  /// The needed geometries that are quickly asked, if others are not. A ray that goes one by one asks them
  /// first.
  std::vector<CsgProbe> probes;
  std::vector<CsgStep> steps;                         ///< of all nodes, if there are at most kMaxCsgSteps
  std::vector<std::shared_ptr<const Accel>> windows;  ///< of CsgExpression::windows, one each
  std::uint32_t item = 0;  ///< item of the combination in the structure that holds it
  /// Number of the first path through the combination, see csg_path().
  std::uint32_t first_path = 0;
};

/// The path of a hit with path `inner` inside the solids; `flipped` if its normal is turned round.
inline std::uint32_t csg_path(const CsgItem& csg, std::uint32_t inner, bool flipped) {
  return csg.first_path + 2 * (inner + 1) + static_cast<std::uint32_t>(flipped);
}

// ---- The acceleration structure.

/// An instance in the tree: its map into the child, the child, its item number, and the first of its instance
/// paths.
struct InstanceItem {
  double to_child[12];  ///< row-major 3x4
  const Accel* child;
  std::uint32_t item;
  std::uint32_t first_path;  ///< paths through this instance are first_path + (path inside the child + 1)
};

/// An instance of a list. Its map is exactly that of its floats.
struct ListedInstance {
  float to_child[12];              ///< row-major 3x4
  std::uint32_t child;             ///< index into Accel::listed_children
  std::uint32_t item, first_path;  ///< as in InstanceItem
  std::uint32_t user;              ///< InstancePlace::user
};
static_assert(sizeof(ListedInstance) == 64);

/// The first of the paths through an instance, a combination or a list of instances.
struct PathStep {
  std::uint32_t first_path, item;
  const Accel* child;    ///< null for a list
  std::uint32_t stride;  ///< in a list: paths from one instance to the next
  bool is_combination;
};

/// A geometry's transform as shading needs it, computed once.
struct GeometryFrame {
  Affine inverse;
  bool identity = true;
  bool mirrored = false;
};

class WindingField;

/// How a ray that crosses a mesh tells where it is inside, see accel/winding/mesh_sense.h.
enum class MeshSense : std::uint8_t { closed, even, open, inverted };

/// What questions about points need of meshes, made when it is first asked for: winding_field(accel) and,
/// per geometry, mesh_sense(accel, geometry).
struct PointAnswers {
  std::once_flag winding_once, senses_once;
  std::unique_ptr<const WindingField> winding;
  std::vector<MeshSense> senses;

  PointAnswers();
  ~PointAnswers();
};

/// The tree over `geometries` and the pools that its leaves point to.
///
/// Instance paths: within one structure, "no instance" is path kNoId, and a hit below instance item k with
/// path p inside the child (kNoId or a number) has path first_path + (p + 1) mod 2^32. Thus every chain of
/// instances has one number, chains order as their items do, and no hit stores more than 32 bits however deep
/// the nesting.
class Accel {
 public:
  Accel();
  ~Accel();

  std::vector<Geometry> geometries;
  std::vector<std::uint32_t> first_item;  ///< per geometry, plus the total at the end
  bool one_item_each = false;             ///< item k is geometry k

  NodeRef root = NodeRef::none();
  Box bounds;
  VirtualArray<BvhNode> nodes;
  VirtualArray<TriangleBlock> blocks;
  std::vector<LeafEntry> leaves;
  ShapePools pools;
  std::unique_ptr<ExactPoolBase> exact[kKinds];  ///< by kind; null if there are none of it
  bool has_exact = false;
  std::vector<InstanceItem> instances;
  std::vector<ListedInstance> listed_instances;
  std::vector<const Accel*> listed_children;
  bool pieces = false;                ///< triangles were split, so one may stand in more than one block
  std::vector<LeafEntry> unbounded;   ///< tested against every ray
  std::uint32_t path_count = 0;       ///< number of instance paths in here
  std::vector<GeometryFrame> frames;  ///< per geometry
  bool has_mirrors = false;           ///< the transform of a geometry mirrors it
  std::vector<std::uint8_t> kinds;    ///< Kind of each geometry
  std::vector<std::uint32_t> users;   ///< Geometry::user of each
  /// What index_in_pool() looks up: one number per shape of a pool, and where those of each geometry begin.
  /// Both are empty if there are no such shapes.
  std::vector<std::uint32_t> pool_index, first_pool_index;
  std::vector<CsgItem> combinations;
  std::vector<PathStep> path_steps;  ///< ordered by first_path
  AccelStats stats;
  /// What is shown that closest_point does not answer for, in words; empty if there is nothing of the kind.
  /// [1]: if an instance shows this structure distorted.
  std::string no_closest_point[2];
  std::unique_ptr<PointAnswers> answers;  ///< not null

  /// Leaf `number` of the blocks.
  OKTETT_INLINE TriangleLeaf triangles(std::uint32_t number) const { return {blocks.data(), number}; }

  OKTETT_INLINE const ExactPoolBase& exact_pool(Kind kind) const { return *exact[static_cast<int>(kind)]; }

  /// Index in its pool of a primitive of geometry g, which is a closed-form or exact shape or a list of
  /// instances.
  OKTETT_INLINE std::uint32_t index_in_pool(std::uint32_t g, std::uint32_t primitive) const {
    return pool_index[first_pool_index[g] + primitive];
  }

  /// The item of element k of the pool of a closed-form or exact kind.
  OKTETT_INLINE std::uint32_t item_in_pool(Kind kind, std::uint32_t k) const {
    if (is_exact(kind)) return exact_pool(kind).frames[k].item;
    std::uint32_t item = kNoId;
    visit_pool(kind, pools, [&](auto, const auto& pool) { item = pool.item[k]; });
    return item;
  }

  /// Index of the geometry that item belongs to.
  std::uint32_t geometry_of(std::uint32_t item) const {
    if (one_item_each) return item;
    return static_cast<std::uint32_t>(std::upper_bound(first_item.begin(), first_item.end(), item) -
                                      first_item.begin() - 1);
  }
};

}  // namespace oktett
