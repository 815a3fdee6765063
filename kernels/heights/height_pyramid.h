#pragma once
/// \file Many lines over a height field: down its pyramid to single cells. Blocks of cells are skipped if the
/// lines pass above or below all their heights.
///
/// Lines that keep close together go down in a bundle, others alone; the 16 blocks of a node of the pyramid
/// are tested at once. Each line queues the smallest blocks that it may meet. Then all lines walk over the
/// cells of these at the same time, each in a block of its own. Even neighbouring lines rarely meet the same
/// cells, but this keeps all lanes busy.

#include <bit>

#include "kernels/heights/height_bundle.h"
#include "kernels/heights/height_walk.h"

namespace oktett {

template <int K, class D>
class PyramidWalk {
 public:
  using M = typename D::M;
  explicit OKTETT_INLINE PyramidWalk(HeightSearch<K, D>& search) : s_(search), g_(search.g) {}

  OKTETT_INLINE void run() {
    if (none(s_.wanted)) return;
    make_bundles();
    for (;;) {
      for (int b = 0; b < size_; ++b) descend(bundles_[b]);
      if (count_ == 0) return;
      walk_blocks();
    }
  }

 private:
  static constexpr int W = D::kWidth;
  using A = typename D::Isa;
  static constexpr std::uint32_t kBlock = HeightGrid::kBlock;
  /// Lines within this many cells of one of them make a bundle, if there are at least kLeastBundle.
  static constexpr float kClose = 12;
  static constexpr int kLeastBundle = 3;
  /// Most blocks that wait at a time, and blocks of a node.
  static constexpr int kMost = 64, kNode = 16;

  /// One of the smallest blocks: its first cell, and its least and greatest value.
  struct Block {
    double i, j, least, greatest;
  };
  struct Node {
    std::uint32_t i, j;
    unsigned left;  ///< blocks yet to visit, as bits in the order of the lines
  };
  struct Bundle : HeightBundle {
    Node stack[HeightGrid::kMaxLevels];
    int level;  ///< of the current node, stack[level]; the nodes above it follow in the stack
  };

  OKTETT_INLINE void make_bundles() {
    LineBounds<W> lines;
    lines.set(s_.grid, g_, s_.from, s_.to);
    const unsigned x = bits(g_.forward_x), z = bits(g_.forward_z);
    const auto flip_of = [&](int k) { return 3 * (~x >> k & 1) | 12 * (~z >> k & 1); };
    const auto near = [&](unsigned left) {
      const int k = std::countr_zero(left);
      return left & (x >> k & 1 ? x : ~x) & (z >> k & 1 ? z : ~z) & close_to(lines, k);
    };
    const int root = s_.grid.levels() - 1;
    unsigned left = bits(s_.wanted), met[W];
    // Most lines that go alone and miss the field are rejected here, without a mispredicted branch.
    if (std::popcount(left) < kLeastBundle || near(left) != left)
      left = height::meet_root<A>(s_.grid, lines, left, g_.forward_x, g_.forward_z, met);
    while (left != 0) {
      const int first = std::countr_zero(left);
      const unsigned group = near(left);
      Bundle& b = bundles_[size_++];
      b.level = root;
      if (W == 1 || std::popcount(group) < kLeastBundle) {
        left &= left - 1;
        b.set_one(lines, first, flip_of(first));
        b.stack[root] = {0, 0, met[first]};
      } else {
        left &= ~group;
        b.template set_several<W, A>(lines, group, flip_of(first));
        b.stack[root] = {0, 0, b.template meets<A>(s_.grid.node(root, 0, 0), 0, 0, s_.grid.level(root))};
      }
    }
  }
  /// The lines that begin and end about where line `k` does.
  OKTETT_INLINE unsigned close_to(const LineBounds<W>& lines, int k) const {
    using F = Simd<float, W, A>;
    const auto apart = [&](const typename LineBounds<W>::Side& side) {
      return abs(F::load(side.low) - F(side.low[k])) + abs(F::load(side.way) - F(side.way[k]));
    };
    return bits(max(apart(lines.x), apart(lines.z)) <= F(kClose));
  }

  /// Goes down to node (i, j) of the level below, if the lines may meet any of its blocks.
  OKTETT_INLINE void enter(Bundle& b, std::uint32_t i, std::uint32_t j) {
    const int level = b.level - 1;
    const unsigned met = b.template meets<A>(s_.grid.node(level, i, j), static_cast<int>(i),
                                             static_cast<int>(j), s_.grid.level(level));
    if (met == 0) return;
    b.level = level, b.stack[level] = {i, j, met};
  }

  /// Goes down the pyramid and queues the smallest blocks, until every line has one.
  OKTETT_INLINE void descend(Bundle& b) {
    const unsigned wanted = b.lanes & bits(s_.wanted);
    if (wanted == 0) b.level = s_.grid.levels();
    while (b.level < s_.grid.levels()) {
      Node& node = b.stack[b.level];
      if (node.left == 0) {
        ++b.level;
        continue;
      }
      if (b.level == 0) {
        if (count_ > kMost - kNode) return;
        queue_blocks(b, node, wanted);
        if ((wanted & ~queued_) == 0) return;
        continue;
      }
      const HeightGrid::Level& level = s_.grid.level(b.level);
      const unsigned k = b.block_of(static_cast<unsigned>(std::countr_zero(node.left)), level);
      node.left &= node.left - 1;
      const std::uint32_t i = level.block_column(node.i, k), j = level.block_row(node.j, k);
      if (level.has_block(i, j)) enter(b, i, j);
    }
  }

  /// Queues the blocks of a node for the lines that may meet them.
  OKTETT_INLINE void queue_blocks(const Bundle& b, Node& node, unsigned wanted) {
    const HeightNode& heights = s_.grid.node(0, node.i, node.j);
    const HeightGrid::Level& level = s_.grid.level(0);
    const bool alone = (wanted & (wanted - 1)) == 0;
    for (; node.left != 0; node.left &= node.left - 1) {
      const unsigned k = b.block_of(static_cast<unsigned>(std::countr_zero(node.left)), level);
      const std::uint32_t i = level.block_column(node.i, k), j = level.block_row(node.j, k);
      if (!level.has_block(i, j)) continue;
      const Block block{double{kBlock} * i, double{kBlock} * j,
                        s_.grid.least() + s_.grid.step() * heights.least[k],
                        s_.grid.least() + s_.grid.step() * heights.greatest[k]};
      const unsigned met = alone ? wanted : wanted & lines_at(b, block);
      blocks_[count_] = block;
      for (int lane = 0; lane < W; ++lane) queue_[lane] |= std::uint64_t{met >> lane & 1} << count_;
      queued_ |= met;
      if (met == 0) continue;
      ++count_;
      s_.grid.prefetch_block(kBlock * i, kBlock * j);
    }
  }

  OKTETT_INLINE unsigned lines_at(const HeightBundle& b, const Block& block) const {
    const double i = block.i, j = block.j, end = kBlock;
    const bool forward_x = (b.flip() & 1) == 0, forward_z = (b.flip() & 4) == 0;
    const D x_in = g_.at_column(D(forward_x ? i : i + end)), x_out = g_.at_column(D(forward_x ? i + end : i));
    const D z_in = g_.at_row(D(forward_z ? j : j + end)), z_out = g_.at_row(D(forward_z ? j + end : j));
    const D in = max(max(x_in, z_in), s_.from), out = min(min(x_out, z_out), s_.to);
    return bits((in <= out) & s_.meets(g_.height(in), g_.height(out), D(block.least), D(block.greatest)));
  }

  /// Lets all lines walk over the cells of their blocks.
  OKTETT_INLINE void walk_blocks() {
    Walk w;
    M walking = ~M::all_true();
    for (;;) {
      // Lines that have finished a block take their next one.
      unsigned fresh = 0;
      for (unsigned free = queued_ & bits(s_.wanted) & ~bits(walking); free != 0; free &= free - 1) {
        const int lane = std::countr_zero(free);
        if (queue_[lane] == 0) {
          queued_ &= ~(1u << lane);
          continue;
        }
        const Block& block = blocks_[std::countr_zero(queue_[lane])];
        queue_[lane] &= queue_[lane] - 1;
        w.block_i[lane] = block.i, w.block_j[lane] = block.j;
        w.least[lane] = block.least, w.greatest[lane] = block.greatest;
        fresh |= 1u << lane;
      }
      if (fresh != 0) {
        const M lanes = M::from_bits(fresh);
        enter_blocks(w, lanes);
        walking = walking | lanes;
      }
      if (none(walking)) break;
      step(w, walking);
    }
    for (std::uint64_t& blocks : queue_) blocks = 0;
    count_ = 0, queued_ = 0;
  }

  /// Where lines are, in cells, and the block that each of them walks over.
  struct Walk {
    alignas(64) double block_i[W] = {}, block_j[W] = {}, least[W] = {}, greatest[W] = {};
    D i = D(0.0), j = D(0.0), last_i = D(0.0), last_j = D(0.0);  ///< the last ones are of the block
  };

  /// Takes lines to the cell where they reach the heights of their block, or to one before it.
  OKTETT_INLINE void enter_blocks(Walk& w, const M& fresh) const {
    const D i = D::load(w.block_i), j = D::load(w.block_j), zero(0.0), end(static_cast<double>(kBlock));
    const D x_in = g_.at_column(i + select(g_.forward_x, zero, end));
    const D z_in = g_.at_row(j + select(g_.forward_z, zero, end));
    const M falls = g_.d.y < zero;
    const D far = D(4.0) * g_.noise;
    const D begins = (select(falls, D::load(w.greatest) + far, D::load(w.least) - far) - g_.o.y) / g_.d.y;
    D t = max(max(x_in, z_in), s_.from);
    t = select((t < begins) & (begins <= s_.to), begins, t);
    const D slack = (abs(g_.o.x) + abs(g_.o.z) + D(kMaxHeightSide)) * D(0x1p-46);
    const auto cell = [&](const D& o, const D& d, const M& forward, const D& first, const D& last) {
      const D place = (o + t * d) + select(forward, -slack, slack), shifter(0x1.8p52);
      const D inside = min(max(place, first - end), last + end);
      return min(max(((inside - D(0.5)) + shifter) - shifter, first), last);
    };
    const D last_i = min(i + D(kBlock - 1.0), D(s_.grid.columns() - 2.0));
    const D last_j = min(j + D(kBlock - 1.0), D(s_.grid.rows() - 2.0));
    w.i = select(fresh, cell(g_.o.x, g_.d.x, g_.forward_x, i, last_i), w.i);
    w.j = select(fresh, cell(g_.o.z, g_.d.z, g_.forward_z, j, last_j), w.j);
    w.last_i = last_i, w.last_j = last_j;
  }

  /// Tests the cell of each line, and takes the line to the next one.
  OKTETT_INLINE void step(Walk& w, M& walking) {
    const GridCell<D> cell(s_.grid, w.i, w.j, g_.forward_x, g_.forward_z);
    const D zero(0.0), one(1.0);
    const D x_in = g_.at_column(w.i + select(g_.forward_x, zero, one));
    const D x_out = g_.at_column(w.i + select(g_.forward_x, one, zero));
    const D z_in = g_.at_row(w.j + select(g_.forward_z, zero, one));
    const D z_out = g_.at_row(w.j + select(g_.forward_z, one, zero));
    const D in = max(max(x_in, z_in), s_.from), out = min(min(x_out, z_out), s_.to);
    const M here = walking & (in <= out) & s_.meets(g_.height(in), g_.height(out), cell.least, cell.greatest);
    if (any(here)) s_.look(cell, here, pass_cell(g_, x_in, x_out, z_in, z_out));
    const M by_row = z_out < x_out;
    const D i = select(by_row, w.i, w.i + select(g_.forward_x, one, -one));
    const D j = select(by_row, w.j + select(g_.forward_z, one, -one), w.j);
    const M in_block =
        (D::load(w.block_i) <= i) & (i <= w.last_i) & (D::load(w.block_j) <= j) & (j <= w.last_j);
    walking = walking & s_.wanted & in_block & (min(x_out, z_out) <= s_.to);
    // All lanes are at cells of the field.
    w.i = select(in_block, i, w.i), w.j = select(in_block, j, w.j);
  }

  HeightSearch<K, D>& s_;
  const GridLines<D>& g_;
  Bundle bundles_[W];
  int size_ = 0;
  Block blocks_[kMost];
  int count_ = 0;                               ///< of blocks_
  alignas(8 * W) std::uint64_t queue_[W] = {};  ///< which of blocks_ each line may meet, as bits
  unsigned queued_ = 0;                         ///< lanes with blocks to walk over
};

}  // namespace oktett
