#pragma once
/// \file The tree builder proper: primitive references in, nodes and leaves out.

#include <string>
#include <vector>

#include "accel/accel_data.h"
#include "accel/build/build_arrays.h"
#include "accel/build/spatial.h"

namespace oktett {

/// A binary tree whose leaves are blocks, and the items in the order of the leaves, in the arrays of a build.
/// The root is node 0.
struct BinaryTree {
  const BinaryNode* nodes;
  const std::uint32_t* items;
  const std::uint16_t* corners;  ///< of items that are triangles: TriangleBlock::Lists::corners
  bool pieces;                   ///< triangles were split, so an item may stand in several leaves
};

/// The parameters of a quality.
Effort effort_of(BuildQuality quality);

/// A tree that becomes a part of another.
struct TreePart {
  int depth = 1;               ///< of its root, at most
  std::string name;            ///< for whoever watches the build
  bool reuses_arrays = false;  ///< the arrays of the build are for the next part, too
};

/// Builds the binary tree over the references, at least one, and uses them up; `bounds` are theirs. The
/// same tree for any number of threads.
BinaryTree build_binary(const BuildArrays& arrays, const TriangleSource& triangles, const Box& bounds,
                        const BuildOptions& options, const BuildKernels& kernels, const TreePart& part = {});

/// The power of two by which a scene with these bounds is of size 1, so that areas neither overflow nor
/// vanish.
float scene_unit(const Box& bounds);

/// order[k] collects the items of kind k in leaf order: for exact kinds their cells, for combinations and
/// listed instances their places in the structure.
using ItemOrder = std::vector<std::uint32_t>[kKinds];

/// Builds the tree over the references, which it uses up, into accel.nodes, accel.blocks,
/// accel.leaves, accel.root, accel.bounds and accel.stats. Leaves of closed-form shapes and instances are
/// given as ranges of `order`: the caller lays out the pools so that element i of kind k is item order[k][i].
void build_tree(Accel& accel, const BuildArrays& arrays, const TriangleSource& triangles, ItemOrder& order,
                const BuildOptions& options, const BuildKernels& kernels, const TreePart& part = {});

}  // namespace oktett
