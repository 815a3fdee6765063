#pragma once
/// \file The tree builder proper: primitive references in, nodes and leaves out.

#include <vector>

#include "accel/accel_data.h"
#include "accel/build/sah.h"
#include "accel/build/triangle_source.h"
#include "core/soa.h"

namespace oktett {

/// A binary tree whose leaves are blocks, and the items in the order of the leaves. The root is node 0.
struct BinaryTree {
  VirtualArray<BinaryNode> nodes;
  Column<std::uint32_t> items;
  Column<std::uint16_t> corners;  ///< of items that are triangles: TriangleBlock::corners
  bool pieces = false;            ///< triangles were split, so an item may stand in several leaves
};

/// How many references `count` ones may become by spatial splits. build_binary does not copy those that
/// come in a column with such a capacity.
std::size_t reference_room(std::size_t count, const BuildOptions& options);

/// Builds the binary tree over `refs`, which it uses up; `bounds` are theirs. The same tree for any number of
/// threads.
BinaryTree build_binary(Column<PrimRef>& refs, const TriangleSource& triangles, const Box& bounds,
                        const BuildOptions& options, const BuildKernels& kernels);

/// The power of two by which a scene with these bounds is of size 1, so that areas neither overflow nor
/// vanish.
float scene_unit(const Box& bounds);

/// order[k] collects the items of kind k in leaf order: for exact kinds their cells, for combinations and
/// listed instances their places in the structure.
using ItemOrder = std::vector<std::uint32_t>[kKinds];

/// Builds the tree over `refs` (which it uses up) into accel.nodes, accel.blocks, accel.leaves, accel.root,
/// accel.bounds and accel.stats. Leaves of closed-form shapes and instances are given as ranges of `order`:
/// the caller lays out the pools so that element i of kind k is item order[k][i].
void build_tree(Accel& accel, Column<PrimRef>& refs, const TriangleSource& triangles, ItemOrder& order,
                const BuildOptions& options, const BuildKernels& kernels);

}  // namespace oktett
