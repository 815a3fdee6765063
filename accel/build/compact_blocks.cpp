#include "accel/build/compact_blocks.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "accel/build/tree_store.h"
#include "core/parallel.h"

namespace oktett {
namespace {

/// Leaves that are packed by one task, with each other only. Neighbours in the tree are neighbours in memory.
constexpr std::size_t kTogether = 4096;
/// A leaf is packed with one of so many before it that stand alone.
constexpr std::size_t kOpen = 8;

/// The corners of a leaf as numbers of floats, and where they lie.
struct LeafCorners {
  int count = 0;
  std::int32_t number[3][TriangleBlock::kCorners];
  std::uint32_t mark[TriangleBlock::kCorners];  ///< equal for equal corners, seldom for others
  std::uint64_t marks;                          ///< a bit for each, by its mark
  std::int32_t lo[3], hi[3];

  void set(const TriangleBlock& block) {
    unsigned used = 0;
    for (const std::uint16_t corners : block.first.corners)
      used |= 1u << (corners & 15) | 1u << (corners >> 4 & 15) | 1u << (corners >> 8 & 15);
    count = std::bit_width(used);
    for (int axis = 0; axis < 3; ++axis) {
      // Unused corners repeat number 0.
      const float* const row = block.row(axis);
      std::int32_t least = float_number(row[0]), greatest = least;
      for (int n = 0; n < TriangleBlock::kCorners; ++n) {
        const std::int32_t x = number[axis][n] = float_number(row[n]);
        least = std::min(least, x), greatest = std::max(greatest, x);
      }
      lo[axis] = least, hi[axis] = greatest;
    }
    for (int n = 0; n < TriangleBlock::kCorners; ++n)
      mark[n] = static_cast<std::uint32_t>(number[0][n]) * 0x9e3779b1u +
                static_cast<std::uint32_t>(number[1][n]) * 0x85ebca77u +
                static_cast<std::uint32_t>(number[2][n]) * 0xc2b2ae3du;
    marks = 0;
    for (int n = 0; n < TriangleBlock::kCorners; ++n) marks |= std::uint64_t{1} << (mark[n] >> 26);
  }

  bool is_at(int n, const LeafCorners& other, int k) const {
    return number[0][n] == other.number[0][k] && number[1][n] == other.number[1][k] &&
           number[2][n] == other.number[2][k];
  }
};

/// Whether corners with these numbers, per axis, can be packed.
bool is_narrow(const LeafCorners& a, const LeafCorners& b) {
  bool narrow = true;
  for (int axis = 0; axis < 3; ++axis) {
    const auto lo = static_cast<std::uint32_t>(std::min(a.lo[axis], b.lo[axis]));
    const auto hi = static_cast<std::uint32_t>(std::max(a.hi[axis], b.hi[axis]));
    narrow &= hi - lo <= TriangleBlock::kMostDistance;
  }
  return narrow;
}

/// The corners of `a`, as bits, that seem to be corner `k` of `b`.
unsigned same_corners(const LeafCorners& a, const LeafCorners& b, int k) {
  unsigned same = 0;
  for (int n = 0; n < TriangleBlock::kCorners; ++n)
    same |= static_cast<unsigned>(a.mark[n] == b.mark[k]) << n;
  return same;
}

/// How many corners both have together, by their marks; more than there is room for if a quick count says so,
/// which may miss a corner that both have.
int all_corners(const LeafCorners& a, const LeafCorners& b) {
  if (a.count + b.count - std::popcount(a.marks & b.marks) > TriangleBlock::kCorners)
    return TriangleBlock::kCorners + 1;
  int count = a.count + b.count;
  for (int k = 0; k < b.count; ++k) count -= static_cast<int>(same_corners(a, b, k) != 0);
  return count;
}

bool pack(const TriangleBlock& a, const LeafCorners& ca, const TriangleBlock& b, const LeafCorners& cb,
          TriangleBlock& out) {
  if (!is_narrow(ca, cb)) return false;
  int place[TriangleBlock::kCorners];  // of corner k of b
  int count = ca.count;
  for (int k = 0; k < cb.count; ++k) {
    int n = TriangleBlock::kCorners;
    for (unsigned same = same_corners(ca, cb, k); same != 0; same &= same - 1)
      if (const int at = std::countr_zero(same); at < ca.count && ca.is_at(at, cb, k)) n = std::min(n, at);
    if (n == TriangleBlock::kCorners) n = count++;
    if (n >= TriangleBlock::kCorners) return false;
    place[k] = n;
  }
  out = {};
  const auto set = [&](int n, const LeafCorners& from, int k) {
    std::uint32_t distance[3];
    for (int axis = 0; axis < 3; ++axis)
      distance[axis] = static_cast<std::uint32_t>(from.number[axis][k]) -
                       static_cast<std::uint32_t>(out.second.base[axis]);
    out.low[n] = distance[0] | distance[2] << 24;
    out.high[n] = distance[1] | (distance[2] >> 8 & 0xffu) << 24;
    out.top[n] = static_cast<std::uint8_t>(distance[2] >> 16);
  };
  for (int axis = 0; axis < 3; ++axis) out.second.base[axis] = std::min(ca.lo[axis], cb.lo[axis]);
  for (int n = 0; n < TriangleBlock::kCorners; ++n) set(n, ca, n < ca.count ? n : 0);
  for (int k = 0; k < cb.count; ++k) set(place[k], cb, k);
  for (int lane = 0; lane < TriangleBlock::kSize; ++lane) {
    int second = 0;
    for (int k = 0; k < 3; ++k) second |= place[b.first.corners[lane] >> 4 * k & 15] << 4 * k;
    out.first.corners[lane] = static_cast<std::uint16_t>(a.first.corners[lane] | TriangleBlock::kPacked);
    out.second.lists.corners[lane] = static_cast<std::uint16_t>(second | TriangleBlock::kPacked);
    out.first.item[lane] = a.first.item[lane], out.second.lists.item[lane] = b.first.item[lane];
  }
  return true;
}

/// Packs the `count` leaves of `blocks` towards the front. leaf[i] becomes the number of the leaf that block
/// i had. Returns how many blocks are left.
std::size_t pack_together(TriangleBlock* blocks, std::size_t count, std::uint32_t* leaf) {
  struct Open {
    std::size_t at;
    LeafCorners corners;
  };
  std::vector<Open> open;
  open.reserve(kOpen + 1);
  std::size_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const TriangleBlock block = blocks[i];
    LeafCorners corners;
    corners.set(block);
    std::ptrdiff_t best = -1;
    int least = std::numeric_limits<int>::max();
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (!is_narrow(open[k].corners, corners)) continue;
      const int all = all_corners(open[k].corners, corners);
      if (all < least && all <= TriangleBlock::kCorners) best = static_cast<std::ptrdiff_t>(k), least = all;
    }
    TriangleBlock both;
    if (best >= 0) {
      const Open& other = open[static_cast<std::size_t>(best)];
      if (pack(blocks[other.at], other.corners, block, corners, both)) {
        leaf[i] = static_cast<std::uint32_t>(TriangleBlock::kLeaves * other.at + 1);
        blocks[other.at] = both;
        open.erase(open.begin() + best);
        continue;
      }
    }
    leaf[i] = static_cast<std::uint32_t>(TriangleBlock::kLeaves * size);
    if (open.size() == kOpen) open.erase(open.begin());
    open.push_back({size, corners});
    blocks[size++] = block;
  }
  return size;
}

}  // namespace

bool pack_leaves(const TriangleBlock& a, const TriangleBlock& b, TriangleBlock& out) {
  LeafCorners ca, cb;
  ca.set(a), cb.set(b);
  return pack(a, ca, b, cb, out);
}

void compact_blocks(Accel& accel, bool parallel) {
  const std::size_t before = block_count(accel);
  TriangleBlock* const blocks = accel.blocks.data();
  Column<std::uint32_t> leaf;
  leaf.resize_uninitialized(before);
  const Chunks chunks(before, kTogether);
  std::vector<std::size_t> size(chunks.count);
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    size[c] = pack_together(blocks + begin, end - begin, &leaf[begin]);
  });
  // Close the gaps.
  std::vector<std::uint32_t> first(chunks.count);
  std::size_t count = 0;
  for (std::size_t c = 0; c < chunks.count; ++c) {
    first[c] = static_cast<std::uint32_t>(TriangleBlock::kLeaves * count);
    const TriangleBlock* const from = blocks + c * chunks.size;
    if (from != blocks + count) std::memmove(blocks + count, from, size[c] * sizeof(TriangleBlock));
    count += size[c];
  }
  const auto moved = [&](std::uint32_t old) {
    const std::uint32_t block = old / TriangleBlock::kLeaves;
    return first[block / chunks.size] + leaf[block];
  };
  const auto follow = [&](NodeRef& ref) {
    if (ref.is_triangles()) ref = NodeRef::triangles(moved(ref.triangle_leaf()), ref.triangle_count());
  };
  follow(accel.root);
  Chunks(accel.stats.nodes, kTogether).each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      for (NodeRef& ref : accel.nodes[n].child) follow(ref);
  });
  for (LeafEntry& entry : accel.leaves)
    if (entry.kind == Kind::triangle) entry.begin = moved(entry.begin);
  discard_pages(blocks + count, (before - count) * sizeof(TriangleBlock));
  accel.stats.leaf_bytes -= (before - count) * sizeof(TriangleBlock);
}

}  // namespace oktett
