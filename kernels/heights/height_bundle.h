#pragma once
/// \file Lines that go together over the pyramid of a height field, and which blocks of a node they may meet.

#include <limits>

#include "core/simd_memory.h"
#include "kernels/heights/height_cell.h"

namespace oktett {

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

}  // namespace oktett
