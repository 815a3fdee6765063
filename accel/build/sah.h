#pragma once
/// \file The data of the builder: primitive references, bins, and the binary tree that becomes the wide one.

#include <cstddef>
#include <cstdint>
#include <limits>

#include "accel/node.h"
#include "core/isa.h"
#include "core/platform.h"
#include "kernels/triangle/triangle_block.h"

namespace oktett {

// ---- The data of the builder.

/// A primitive's box as {-lo, hi}, so that one maximum grows both corners at once (the layout is tinybvh's
/// idea), with its item number and kind in the gaps. 32 bytes.
struct alignas(32) PrimRef {
  float negative_lo[3];
  std::uint32_t item;
  float hi[3];
  std::uint32_t kind;  ///< Kind in bits 0-7, TriangleTest in bits 8-15
};
static_assert(sizeof(PrimRef) == 32);

/// A box in the same form and a count for every bin of one axis.
struct alignas(32) BinBox {
  float v[8];  ///< {-lo.xyz, any, hi.xyz, any}
};

inline constexpr int kMaxBins = 32;

struct Bins {
  BinBox box[3][kMaxBins];
  std::uint32_t count[3][kMaxBins];
};

/// Bounds of lo + hi, twice the centres of boxes; the fourth component is never read. Beyond 1.7e38 they are
/// infinite, and such an axis is not split.
struct alignas(16) Centers {
  static constexpr float kInf = std::numeric_limits<float>::infinity();
  float lo[4] = {kInf, kInf, kInf, kInf};
  float hi[4] = {-kInf, -kInf, -kInf, -kInf};

  void grow(const Centers& c) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = c.lo[k] < lo[k] ? c.lo[k] : lo[k];
      hi[k] = c.hi[k] > hi[k] ? c.hi[k] : hi[k];
    }
  }
};

/// Which bin a centre falls into: floor((centre - origin) * scale), clamped to [0, bins). The centre is
/// formed from halves, so that huge boxes do not overflow. Scale 0: all in bin 0.
struct Grid {
  float origin[4] = {}, scale[4] = {};
  int bins = 0;
};

/// Bins refs[0, count): of each `every` times kBinGroup references the first kBinGroup.
struct BinJob {
  const PrimRef* refs;
  std::size_t count;
  Grid grid;
  Bins* out;  ///< overwritten
  std::size_t every = 1;
};
inline constexpr std::size_t kBinGroup = 8;

/// A plane between bins `bin` and `bin` + 1 of an axis; axis < 0: none.
struct Split {
  int axis = -1, bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

/// Counts those of refs[0, count) that are left of the plane.
struct CountJob {
  const PrimRef* refs;
  std::size_t count;
  Grid grid;
  Split split;
};

/// Copies refs[0, count) to `left` upwards and to `right` downwards (the first goes to right[-1]), by the
/// side of the plane that their centres are on, and bounds the centres of each side.
struct PartitionJob {
  const PrimRef* refs;
  std::size_t count;
  PrimRef* left;
  PrimRef* right;
  Grid grid;
  Split split;
  Centers centers[2];     ///< grown
  std::size_t lefts = 0;  ///< out: how many went to the left
};

/// A node of the binary tree: a pair of children, or a leaf. 32 bytes.
struct alignas(32) BinaryNode {
  static constexpr std::uint32_t kInner = 1u << 31;

  float negative_lo[3];
  std::uint32_t link;  ///< the left child, the right one follows; in a leaf the place of the first item
  float hi[3];
  std::uint32_t info;  ///< see below

  bool is_leaf() const { return (info & kInner) == 0; }
  // Leaves: how many items, of which kind.
  static std::uint32_t leaf_info(std::uint32_t count, std::uint32_t kind) { return count | kind << 8; }
  int count() const { return static_cast<int>(info & 0xff); }
  Kind kind() const { return static_cast<Kind>(info >> 8 & 0xff); }
  TriangleTest test() const { return static_cast<TriangleTest>(info >> 16 & 0xff); }
  /// Inner nodes: of `slots` places (2 to 8) in a wide node, how many the left child's subtree gets for the
  /// least cost; 0: a place is better left empty. See collapse().
  int left_slots(int slots) const { return static_cast<int>(info >> 3 * (slots - 2) & 7); }
};
static_assert(sizeof(BinaryNode) == 32);

/// Cost of a subtree (the areas of its wide nodes and leaves) if it may fill 1 to 7 places of a wide node.
/// See collapse().
struct SubtreeCost {
  float places[7];
};

/// The largest range that may be built by sorting instead of binning.
inline constexpr std::uint32_t kMaxSweep = 256;

/// The parameters of a BuildQuality.
struct Effort {
  int bins;             ///< candidate intervals per axis, [2, kMaxBins]
  std::uint32_t sweep;  ///< ranges up to this size are swept, [8, kMaxSweep]
  std::uint32_t
      every_place;  ///< of these, ranges up to this size are tried at every place, others at full blocks
  bool cells;       ///< larger ranges are split along a space-filling curve
  double spatial;   ///< references that spatial splits may add, per reference
  /// A spatial split is tried if the children of the best object split overlap by at least this part of the
  /// surface of their parent.
  double overlap;
  bool every_axis;  ///< spatial splits are tried across every axis, not only across the longest
};

class TriangleSource;

/// TriangleSource::pack_corners. A function, so that code of an instruction set need not know the class.
bool pack_corners(const TriangleSource& triangles, const std::uint32_t* items, int count,
                  std::uint16_t* corners);

/// Numbers of the vertices of a triangle.
struct VertexNumbers {
  std::uint32_t of[3];
};

/// Builds the binary tree over refs[0, count), count in [1, kMaxSweep].
struct SweepJob {
  const PrimRef* refs;
  std::uint32_t count;
  const TriangleSource* triangles;
  const VertexNumbers* vertices;  ///< of the triangles among `refs`
  std::uint32_t first;            ///< place of the range among all items
  std::uint32_t* items;           ///< out: the items in the order of the leaves
  std::uint16_t* corners;         ///< out: of the triangles among them, TriangleBlock::Lists::corners
  int depth;                      ///< of the range; the tree stays below kMaxDepth
  float unit;                     ///< a power of two by which the scene is of size 1
  Effort effort;
  bool pieces;               ///< an item may occur more than once
  BinaryNode* nodes;         ///< out: up to 2 * count - 1, the root first; links to children count from here
  std::uint32_t node_count;  ///< out
  SubtreeCost cost;          ///< out
};

/// The parts of the builder that are compiled per instruction set. All sets build the same tree.
struct BuildKernels {
  void (*bin)(const BinJob&);
  std::size_t (*count_left)(const CountJob&);
  void (*bound)(const PrimRef*, std::size_t count, Centers&);  ///< grows bounds of centres
  void (*partition)(PartitionJob&);
  void (*sweep)(SweepJob&);
};

/// Blocks of eight that n primitives fill, which is what leaves cost.
constexpr std::uint32_t blocks_of(std::uint32_t n) {
  return (n + TriangleBlock::kSize - 1) / TriangleBlock::kSize;
}

/// Half of n, a multiple of eight if that is possible.
constexpr std::size_t balanced_half(std::size_t n) {
  constexpr std::size_t size = TriangleBlock::kSize;
  return n > 2 * size ? n / 2 / size * size : n > size ? size : n / 2;
}

template <class A>
const BuildKernels& build_kernels();

/// Throws Error if this build holds no code for the set.
const BuildKernels& build_kernels(Isa isa);

// ---- Which binary nodes become wide ones: the choice of least surface-area cost, by dynamic programming
// (Ylitie, Karras and Laine 2017, section 3). Leaves are whole blocks already, so only the places in wide
// nodes are distributed. Costs are computed bottom-up while the binary tree is built; a node keeps only its
// choices.

/// Cost of a leaf: it takes one place, however many there are.
OKTETT_INLINE SubtreeCost leaf_cost(float area) {
  SubtreeCost c;
  for (float& p : c.places) p = area;
  return c;
}

/// Cost of an inner node of surface `area`, from the costs of its children. Returns BinaryNode::info.
OKTETT_INLINE std::uint32_t collapse(const SubtreeCost& l, const SubtreeCost& r, float area,
                                     SubtreeCost& out) {
  constexpr int W = BvhNode::kWidth;
  float shared[W + 1];
  std::uint32_t left[W + 1];
  for (int slots = 2; slots <= W; ++slots) {
    float best = l.places[0] + r.places[slots - 2];
    std::uint32_t best_left = 1;
    for (int k = 2; k < slots; ++k) {
      const float c = l.places[k - 1] + r.places[slots - k - 1];
      best_left = c < best ? static_cast<std::uint32_t>(k) : best_left;
      best = c < best ? c : best;
    }
    shared[slots] = best, left[slots] = best_left;
  }
  std::uint32_t info = BinaryNode::kInner | left[W] << 3 * (W - 2);
  out.places[0] = area + shared[W];
  for (int slots = 2; slots < W; ++slots) {
    const bool share = shared[slots] < out.places[slots - 2];
    out.places[slots - 1] = share ? shared[slots] : out.places[slots - 2];
    info |= (share ? left[slots] : 0) << 3 * (slots - 2);
  }
  return info;
}

}  // namespace oktett
