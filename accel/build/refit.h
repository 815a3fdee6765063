#pragma once
/// \file Trees whose vertices move and whose links stay.

#include "accel/accel_data.h"

namespace oktett {

/// Which vertices the corners of a tree's blocks are, so that a refit finds them without the triangles.
class RefitPlan {
 public:
  /// Of a structure that holds one mesh, which no transform moves, with the indices of `mesh`. Neither is
  /// kept.
  RefitPlan(const Accel& accel, const TriangleMesh& mesh, bool parallel);

  /// Whether the tree can be refitted: all triangles of the mesh stand in it, each once.
  bool is_possible() const { return is_possible_; }
  /// The vertices of the TriangleBlock::kCorners corners of a block; null if some corner is several vertices,
  /// which lay at one place when the block was made.
  const std::uint32_t* vertices(std::uint32_t block) const {
    const std::uint32_t* const all = &vertices_[std::size_t{TriangleBlock::kCorners} * block];
    return all[0] != kNoId ? all : nullptr;
  }

 private:
  Column<std::uint32_t> vertices_;  ///< of each block; the first one is kNoId where vertices() is null
  bool is_possible_ = false;
};

/// Fits the tree to the positions that the mesh has now: corners of triangles, boxes, bounds and the stats.
/// `plan` is that of this tree, or of one that it was cloned from, and possible; blocks whose corners a refit
/// numbers anew have none. Returns false, and then the
/// structure must not be used any more, if the tree cannot hold these triangles: one is not finite, or
/// corners of a block that lay at one place are too many apart.
bool refit(Accel& accel, const RefitPlan& plan, bool parallel);

/// Whether build_accel puts an instance in the place of the geometry, since its transform distorts it.
bool is_wrapped(const Geometry& geometry);

/// A transform and its inverse; null: none.
struct Placement {
  const Affine* to_world = nullptr;
  const Affine* inverse = nullptr;
};

/// Moves instances of a structure: geometry g, which is an instance, to places[g], unless that is null.
/// Boxes, bounds and the stats follow; links stay. Returns false, and then the structure must not be used any
/// more, if one of them is not in the tree, or cannot be.
bool move_instances(Accel& accel, const std::vector<Placement>& places, bool parallel);

/// The same tree of one mesh in memory of its own.
std::shared_ptr<Accel> clone_tree(const Accel& accel);

}  // namespace oktett
