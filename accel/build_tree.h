#pragma once
/// \file The tree builder proper: primitive references in, nodes and leaves out.

#include <vector>

#include "accel/accel_data.h"
#include "accel/build_sah.h"
#include "accel/isa/table.h"

namespace oktett {

/// Fills `block` lane `lane` with the triangle `item`; called from many threads.
class TriangleSource {
 public:
  virtual ~TriangleSource() = default;
  virtual void corners(std::uint32_t item, Vec3f (&v)[3]) const = 0;
};

/// Builds the tree over `refs` (which it reorders) into accel.nodes, accel.blocks, accel.leaves, accel.root
/// and accel.bounds. Leaves of closed-form shapes and instances are given as ranges of `order`: the caller
/// lays out the pools so that element i of kind k is item order[k][i].
void build_tree(Accel& accel, std::vector<PrimRef>& refs, const TriangleSource& triangles,
                std::vector<std::uint32_t> (&order)[8], const BuildOptions& options, const IsaTable& isa);

}  // namespace oktett
