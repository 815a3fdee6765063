#pragma once
/// \file Trees whose vertices move and whose links stay.

#include <atomic>
#include <memory>

#include "accel/accel_data.h"

namespace oktett {

/// Which vertices the corners of a tree's blocks are, so that a refit finds them without the triangles.
class RefitPlan {
 public:
  /// Of a structure that holds one mesh, which no transform moves, with the indices of `mesh`. Neither is
  /// kept.
  RefitPlan(const Accel& accel, const TriangleMesh& mesh, bool parallel);

  /// Whether the tree can be refitted: all triangles of the mesh stand in it, each once, in blocks of floats.
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

/// A tree of one mesh that follows its vertices: it is refitted until the cost of a ray has grown by more
/// than DynamicAccel::kMostGrowth since it was built.
class FollowingTree {
 public:
  /// Null: there is none.
  const std::shared_ptr<Accel>& tree() const { return tree_; }
  /// Begins anew with a tree that was built.
  void set(std::shared_ptr<Accel> tree);
  /// Refits the tree to `mesh`, which has the triangles of the one that it was built of and must outlive it.
  /// A tree that somebody else holds is copied before. Returns false if the tree has to be built.
  bool follow(const TriangleMesh& mesh, bool parallel);

 private:
  std::shared_ptr<Accel> tree_;
  std::shared_ptr<const RefitPlan> plan_;  ///< made for the first refit
  double built_cost_ = 0;
};

/// Whether nobody but so many owners holds what `pointer` points to, nor still reads it in another thread.
template <class T>
bool is_unshared(const std::shared_ptr<T>& pointer, long owners = 1) {
  if (pointer.use_count() > owners) return false;
  std::atomic_thread_fence(std::memory_order_acquire);
  return true;
}

}  // namespace oktett
