#pragma once
/// \file Lines that go together over the pyramid of a height field, and which blocks of a node they may meet.

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simd_words.h"
#include "kernels/heights/height_cell.h"

namespace oktett {

/// Lines of one quadrant, or a line alone, from where the first of them begins to matter (s = 0) to where the
/// last one ceases to (s = 1). All numbers are bounds over the lines, and wide enough for what rounding does
/// to the lines, to the bounds and to what is made of them in floats. x and z count samples in the direction
/// of the lines: those of lines that go back are negative. y counts steps of the pyramid above its least.
class HeightBundle {
 public:
  unsigned lanes = 0;
  bool forward_x = true, forward_z = true;
  float spread = 0;  ///< how far lines are apart, in samples, at most

  /// `from` and `to` are where the lines begin and cease to matter.
  template <class D>
  OKTETT_INLINE void bound(const HeightGrid& grid, const GridLines<D>& g, const D& from, const D& to,
                           unsigned of, bool is_forward_x, bool is_forward_z) {
    lanes = of, forward_x = is_forward_x, forward_z = is_forward_z;
    const auto m = mask_cast<float>(D::M::from_bits(of));
    // Hits are floats, and rounding to them must not lose any.
    const D far(0x1p+127);
    const double first = lowest(m, max(min(from, far), -far)), last = highest(m, max(min(to, far), -far));
    const double t0 = first - std::abs(first) * 0x1p-23, t1 = last + std::abs(last) * 0x1p-23;
    // Floats of numbers up to the sides of the field, and doubles of those of the lines.
    const double slack = std::max(grid.columns(), grid.rows()) * 0x1p-19 +
                         static_cast<double>(highest(m, abs(g.o.x) + abs(g.o.z))) * 0x1p-46;
    const auto side = [&](const D& o, const D& d, bool forward, Side& out) {
      const D at = o + D(t0) * d, begin = forward ? at : -at;
      // What hardly moves is taken to move a little, which is less than the slack.
      const D way = max(abs(d) * D(t1 - t0), D(slack * 0.25));
      out.low = lowest(m, begin - D(slack)), out.high = highest(m, begin + D(slack));
      const float shortest = lowest(m, way), longest = highest(m, way);
      out.per_low = 1 / longest, out.per_high = 1 / shortest;
      return (out.high - out.low) + (longest - shortest);
    };
    const float x = side(g.o.x, g.d.x, forward_x, x_), z = side(g.o.z, g.d.z, forward_z, z_);
    spread = x > z ? x : z;

    const D per_step(1 / grid.step());
    const D begin = ((g.o.y - D(grid.least())) + D(t0) * g.d.y) * per_step,
            rise = g.d.y * D(t1 - t0) * per_step;
    const D room = D(0.125) + g.noise * per_step + (abs(begin) + abs(rise)) * D(0x1p-20);
    y_low_ = lowest(m, begin - room), y_high_ = highest(m, begin + room);
    rise_low_ = lowest(m, rise), rise_high_ = highest(m, rise);
    // What floats cannot bound meets everything.
    constexpr float kMost = 0x1p+100f;
    if (-kMost < y_low_ && y_high_ < kMost && -kMost < rise_low_ && rise_high_ < kMost) return;
    y_low_ = -kMost, y_high_ = kMost, rise_low_ = rise_high_ = 0;
  }

  /// Bit a + 4 b for each block (a, b) of node (i, j) of a level whose blocks have `side` cells along theirs,
  /// in the order in which lines pass them: `a` and `b` count in their directions.
  template <class A>
  OKTETT_INLINE unsigned meets(const HeightNode& node, int i, int j, int side) const {
    using F = Simd<float, 16, A>;
    alignas(64) static constexpr float kUp[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    alignas(64) static constexpr float kDown[16] = {3, 2, 1, 0, 3, 2, 1, 0, 3, 2, 1, 0, 3, 2, 1, 0};
    alignas(64) static constexpr float kRowsUp[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    alignas(64) static constexpr float kRowsDown[16] = {3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0};
    const F zero(0.0f), one(1.0f);
    // s where each block begins and ends: a multiple of a count, and where that begins. Where s < 0 or s > 1
    // it does not matter by how much.
    const F x = F::load(forward_x ? kUp : kDown), z = F::load(forward_z ? kRowsUp : kRowsDown);
    const auto size = static_cast<float>(side);
    const auto near_x = static_cast<float>((forward_x ? i : -i - 1) * 4 * side);
    const auto near_z = static_cast<float>((forward_z ? j : -j - 1) * 4 * side);
    const auto at = [&](const F& count, float begin, float per) {
      return fast_fma(count, F(size * per), F(begin * per));
    };
    const F in = max(max(at(x, near_x - x_.high, x_.per_low), at(z, near_z - z_.high, z_.per_low)), zero);
    const F out =
        min(min(at(x, near_x + size - x_.low, x_.per_high), at(z, near_z + size - z_.low, z_.per_high)), one);
    const F low = min(fast_fma(in, F(rise_low_), F(y_low_)), fast_fma(out, F(rise_low_), F(y_low_)));
    const F high = max(fast_fma(in, F(rise_high_), F(y_high_)), fast_fma(out, F(rise_high_), F(y_high_)));
    const F least = load_words<A>(node.least), greatest = load_words<A>(node.greatest);
    return in_order(bits((in <= out) & (least <= high) & (low <= greatest)));
  }
  /// Turns the order of lines into that of the node, or back.
  OKTETT_INLINE unsigned block_of(unsigned in_order) const {
    return in_order ^ (forward_x ? 0u : 3u) ^ (forward_z ? 0u : 12u);
  }

 private:
  /// Samples at s = 0, and by how much s grows with each.
  struct Side {
    float low, high, per_low, per_high;
  };

  template <class M, class D>
  static OKTETT_INLINE float lowest(const M& lanes, const D& x) {
    using F = Simd<float, D::kWidth, typename D::Isa>;
    return horizontal_min(select(lanes, to_float(x), F(std::numeric_limits<float>::infinity())));
  }
  template <class M, class D>
  static OKTETT_INLINE float highest(const M& lanes, const D& x) {
    return -lowest(lanes, -x);
  }

  /// From the node's order, bit by bit.
  OKTETT_INLINE unsigned in_order(unsigned blocks) const {
    if (!forward_x) {
      blocks = (blocks & 0x3333) << 2 | (blocks >> 2 & 0x3333);
      blocks = (blocks & 0x5555) << 1 | (blocks >> 1 & 0x5555);
    }
    if (!forward_z) {
      blocks = (blocks & 0x00ff) << 8 | (blocks >> 8 & 0x00ff);
      blocks = (blocks & 0x0f0f) << 4 | (blocks >> 4 & 0x0f0f);
    }
    return blocks;
  }

  Side x_, z_;
  float y_low_ = 0, y_high_ = 0, rise_low_ = 0, rise_high_ = 0;
};

}  // namespace oktett
