#pragma once
/// \file Many lines over a height field: down its pyramid to single cells. Blocks of cells are skipped if the
/// lines pass above or below all their heights.
///
/// Lines that keep close together go down in a bundle, others alone; the 16 blocks of a node of the pyramid
/// are tested at once. Each line queues the smallest blocks that it may meet. Then all lines walk over the
/// cells of these at the same time, each in a block of its own. Even neighbouring lines rarely meet the same
/// cells, but this keeps all lanes busy.

#include <bit>
#include <limits>

#include "core/simd_memory.h"
#include "kernels/heights/height_cell.h"
#include "kernels/heights/height_walk.h"

namespace oktett {

// ---- Lines that go together over the pyramid of a height field, and which blocks of a node they may meet.

/// W lines, one in each lane, each from the point at s = 0 to the point at s = 1. The numbers are floats that
/// bound the true ones. The bounds have room for all rounding errors: in the lines, in the bounds themselves
/// and in what is computed from them in floats (docs/numerics.md). x and z count samples in the line's own
/// direction, so they are negative where it goes back. y counts steps of the pyramid above its least value.
template <int W>
struct LineBounds {
  /// Bounds on x or z at s = 0, how far the line goes until s = 1, and the inverse of that.
  struct Side {
    alignas(4 * W) float low[W], high[W], way[W], per[W];
  };
  Side x, z;
  alignas(4 * W) float y_low[W], y_high[W];  ///< at s = 0
  alignas(4 * W) float rise[W];

  /// Lines from t = `from` to `to`, in lanes where `from` <= `to`.
  template <class D>
  OKTETT_INLINE void set(const HeightGrid& grid, const GridLines<D>& g, const D& from, const D& to) {
    // Hits are floats, and rounding to them must not lose any.
    const D far(0x1p+127), round(0x1p-23);
    const D first = max(min(from, far), -far), last = max(min(to, far), -far);
    const D t0 = first - abs(first) * round, t1 = last + abs(last) * round;
    // Rounding errors of floats up to the sides of the field, and of doubles up to the lines' origins.
    const std::uint32_t most = grid.columns() > grid.rows() ? grid.columns() : grid.rows();
    const D slack = D(most * 0x1p-19) + (abs(g.o.x) + abs(g.o.z)) * D(0x1p-46);
    const auto side = [&](const D& o, const D& d, const typename D::M& forward, Side& out) {
      const D at = o + t0 * d, begin = select(forward, at, -at);
      to_float(begin - slack).store(out.low), to_float(begin + slack).store(out.high);
      // A line that hardly moves counts as moving a little, by less than the slack: 1 / way is finite.
      const auto way = to_float(max(abs(d) * (t1 - t0), slack * D(0.25)));
      way.store(out.way), (Simd<float, W, typename D::Isa>(1.0f) / way).store(out.per);
    };
    side(g.o.x, g.d.x, g.forward_x, x), side(g.o.z, g.d.z, g.forward_z, z);

    const D per_step(1 / grid.step());
    const D begin = ((g.o.y - D(grid.least())) + t0 * g.d.y) * per_step, all = g.d.y * (t1 - t0) * per_step;
    const D room = D(0.125) + g.noise * per_step + (abs(begin) + abs(all)) * D(0x1p-20);
    // A line whose heights are too large for floats may meet every block.
    const D most_y(0x1p+100);
    const auto bounded = abs(begin) + room + abs(all) < most_y;
    to_float(select(bounded, begin - room, -most_y)).store(y_low);
    to_float(select(bounded, begin + room, most_y)).store(y_high);
    to_float(select(bounded, all, D(0.0))).store(rise);
  }
};

namespace height {

alignas(64) inline constexpr float kColumnOf[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) inline constexpr float kRowOf[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

/// The s at which lines enter and leave each of 4 x 4 blocks, cut to [0, 1]. `first` is the s for the first
/// column or row of blocks, and each next one adds `step`.
template <class F>
OKTETT_INLINE F begins(float step_x, float first_x, float step_z, float first_z) {
  return max(max(fast_fma(F::load(kColumnOf), F(step_x), F(first_x)),
                 fast_fma(F::load(kRowOf), F(step_z), F(first_z))),
             F(0.0f));
}
template <class F>
OKTETT_INLINE F ends(float step_x, float first_x, float step_z, float first_z) {
  return min(min(fast_fma(F::load(kColumnOf), F(step_x), F(first_x)),
                 fast_fma(F::load(kRowOf), F(step_z), F(first_z))),
             F(1.0f));
}

/// Bounds on the height of lines: from y_low + s rise_low to y_high + s rise_high.
template <class F>
struct HeightBounds {
  F y_low, y_high, rise_low, rise_high;

  /// The blocks that lines may meet, as bits. Lines are in a block for s from `in` to `out`; its heights are
  /// from `least` to `greatest`.
  OKTETT_INLINE unsigned meet(const F& in, const F& out, const F& least, const F& greatest) const {
    const F low = min(fast_fma(in, rise_low, y_low), fast_fma(out, rise_low, y_low));
    const F high = max(fast_fma(in, rise_high, y_high), fast_fma(out, rise_high, y_high));
    return bits((in <= out) & (least <= high) & (low <= greatest));
  }
};

/// For each of `lines` the blocks of the last level that it may meet, as HeightBundle::meets has them.
/// Returns the lines that may meet any.
template <class A, int W, class M>
OKTETT_INLINE unsigned meet_root(const HeightGrid& grid, const LineBounds<W>& b, unsigned lines,
                                 const M& forward_x, const M& forward_z, unsigned (&met)[W]) {
  using V = Simd<float, W, A>;
  using F = Simd<float, 16, A>;
  const HeightGrid::Level& level = grid.level(grid.levels() - 1);
  struct Side {
    alignas(4 * W) float step[W], begin[W], end[W];
  } x, z;
  const auto side = [&](const typename LineBounds<W>::Side& s, const M& forward, Side& out) {
    const V size(static_cast<float>(level.side)), per = V::load(s.per);
    const V near = select(mask_cast<float>(forward), V(0.0f), V(-4.0f) * size);
    (size * per).store(out.step), ((near - V::load(s.high)) * per).store(out.begin);
    ((near + size - V::load(s.low)) * per).store(out.end);
  };
  side(b.x, forward_x, x), side(b.z, forward_z, z);
  // No branches: the processor could not predict which lines miss, nor their directions.
  const unsigned back_x = ~bits(forward_x), back_z = ~bits(forward_z);
  unsigned any = 0;
  for (; lines != 0; lines &= lines - 1) {
    const int k = __builtin_ctz(lines);
    const F in = begins<F>(x.step[k], x.begin[k], z.step[k], z.begin[k]);
    const F out = ends<F>(x.step[k], x.end[k], z.step[k], z.end[k]);
    const F rise(b.rise[k]);
    const HeightBounds<F> heights{F(b.y_low[k]), F(b.y_high[k]), rise, rise};
    const HeightRoot& root = grid.root((back_x >> k & 1) + 2 * (back_z >> k & 1));
    met[k] = heights.meet(in, out, F::load(root.least), F::load(root.greatest));
    any |= static_cast<unsigned>(met[k] != 0) << k;
  }
  return any;
}

}  // namespace height

/// Lines of one quadrant, or a line alone: bounds over the lines.
class HeightBundle {
 public:
  unsigned lanes = 0;

  /// Bits 0 and 1 are set if the lines go back in x, bits 2 and 3 if they go back in z.
  OKTETT_INLINE unsigned flip() const { return flip_; }

  /// Line `k` alone.
  template <int W>
  OKTETT_INLINE void set_one(const LineBounds<W>& b, int k, unsigned flip) {
    const auto side = [&](const typename LineBounds<W>::Side& from) {
      return Side{from.low[k], from.high[k], from.per[k], from.per[k]};
    };
    lanes = 1u << k, flip_ = flip, x_ = side(b.x), z_ = side(b.z);
    y_low_ = b.y_low[k], y_high_ = b.y_high[k], rise_low_ = rise_high_ = b.rise[k];
  }
  /// The lines `of`, all of one quadrant.
  template <int W, class A>
  OKTETT_INLINE void set_several(const LineBounds<W>& b, unsigned of, unsigned flip) {
    using F = Simd<float, W, A>;
    const auto m = F::M::from_bits(of);
    const F inf(std::numeric_limits<float>::infinity());
    const auto lowest = [&](const float* x) { return horizontal_min(select(m, F::load(x), inf)); };
    const auto highest = [&](const float* x) { return horizontal_max(select(m, F::load(x), -inf)); };
    const auto side = [&](const typename LineBounds<W>::Side& from) {
      return Side{lowest(from.low), highest(from.high), lowest(from.per), highest(from.per)};
    };
    lanes = of, flip_ = flip, x_ = side(b.x), z_ = side(b.z);
    y_low_ = lowest(b.y_low), y_high_ = highest(b.y_high);
    rise_low_ = lowest(b.rise), rise_high_ = highest(b.rise);
  }

  /// Bit a + 4 b for each block (a, b) of node (i, j) of a level, in the order in which lines pass them: `a`
  /// and `b` count in their directions. Blocks beyond the field may be among them.
  template <class A>
  OKTETT_INLINE unsigned meets(const HeightNode& node, int i, int j, const HeightGrid::Level& level) const {
    using F = Simd<float, 16, A>;
    const auto size = static_cast<float>(level.side);
    const int across = static_cast<int>(level.side * level.split);
    // -i - 1 where lines go back.
    const auto near_x = static_cast<float>((i ^ -static_cast<int>(flip_ & 1)) * across);
    const auto near_z = static_cast<float>((j ^ -static_cast<int>(flip_ >> 2 & 1)) * across);
    const F in = height::begins<F>(size * x_.per_low, (near_x - x_.high) * x_.per_low, size * z_.per_low,
                                   (near_z - z_.high) * z_.per_low);
    const F out = height::ends<F>(size * x_.per_high, (near_x + size - x_.low) * x_.per_high,
                                  size * z_.per_high, (near_z + size - z_.low) * z_.per_high);
    const height::HeightBounds<F> heights{F(y_low_), F(y_high_), F(rise_low_), F(rise_high_)};
    const unsigned flip = block_of(0, level), present = level.split == 2 ? 0x33u : 0xffffu;
    return heights.meet(in, out, load_words<A>(node.least, flip), load_words<A>(node.greatest, flip)) &
           present;
  }
  /// Turns a block's number in the order of the lines into its number in a node of the level, or back.
  OKTETT_INLINE unsigned block_of(unsigned in_order, const HeightGrid::Level& level) const {
    return in_order ^ (flip_ & (level.split == 2 ? 5u : 15u));
  }

 private:
  /// Samples at s = 0, and by how much s grows with each.
  struct Side {
    float low, high, per_low, per_high;
  };

  unsigned flip_ = 0;
  Side x_, z_;
  float y_low_ = 0, y_high_ = 0, rise_low_ = 0, rise_high_ = 0;
};

// ---- Many lines over a height field.

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
