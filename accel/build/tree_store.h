#pragma once
/// \file Trees that are kept from one run of the program to the next.

#include <cstddef>
#include <cstdint>
#include <string>

#include "accel/accel_data.h"
#include "accel/build/wide_tree.h"

namespace oktett {

/// Keeps what build_tree makes: nodes, blocks, leaves, root, bounds and the order of the items in the pools.
/// A key stands for all that these depend on.
class TreeStore {
 public:
  virtual ~TreeStore() = default;
  /// Structures of fewer triangles are built again each time.
  virtual std::size_t least_triangles() const = 0;
  /// Sets nodes, blocks, leaves, root, bounds, pieces and the numbers of nodes and bytes in the stats of
  /// `accel`, and `order`. Returns false if there is no tree of this key; then these may have any value.
  /// Numbers in the tree need not be right.
  virtual bool load(std::uint64_t key, Accel& accel, ItemOrder& order) = 0;
  /// The tree that was loaded last cannot be one of this structure.
  virtual void refuse(std::uint64_t key, const std::string& why) = 0;
  /// Keeps a tree that was just built.
  virtual void keep(std::uint64_t key, const Accel& accel, const ItemOrder& order) = 0;
};

/// From here on build_accel uses this store; null: none. It must stay alive until it is replaced.
void set_tree_store(TreeStore* store);
TreeStore* tree_store();

/// A hash of all that the tree of `accel` depends on: its meshes, their transforms, and `others`, the
/// references to all that is no triangle. It does not depend on the instruction set, nor does the tree.
std::uint64_t tree_key(const Accel& accel, const Column<PrimRef>& others, const BuildOptions& options);

/// Number of blocks of triangles in the tree.
std::size_t block_count(const Accel& accel);

/// Sets the counts and bytes of the tree in accel.stats, but not its depth.
void count_tree(Accel& accel, std::size_t nodes, std::size_t blocks);

/// Takes the tree of `key` from the store, if it has one that belongs to the geometries of `accel`. Whatever
/// the store contains, a tree that was taken can be traversed safely. `order` holds the unbounded items and
/// is completed; `others` are the references to all that is no triangle. Else nothing changes.
bool load_kept_tree(Accel& accel, ItemOrder& order, const Column<PrimRef>& others, std::uint64_t key,
                    TreeStore& store);

}  // namespace oktett
