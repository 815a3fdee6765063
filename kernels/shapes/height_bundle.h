#pragma once
/// \file Lines that go together over the pyramid of a height field, and which blocks of a node they may meet.

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/simd_words.h"
#include "kernels/shapes/height_cell.h"

namespace oktett {

/// What a bundle needs of lines, lane by lane.
template <int W>
struct HeightLineLanes {
  double o[3][W], d[3][W], noise[W], from[W], to[W];
};

/// Lines of one quadrant, or a line alone, from where the first of them begins to matter (s = 0) to where the
/// last one ceases to (s = 1). All numbers are bounds over the lines, and wide enough for what rounding does to
/// the lines, to the bounds and to what is made of them in floats. x and z count samples in the direction of
/// the lines: those of lines that go back are negative. y counts steps of the pyramid above its least.
class HeightBundle {
 public:
  unsigned lanes = 0;
  bool forward_x = true, forward_z = true;
  double spread = 0;  ///< how far lines are apart, in samples, at most

  template <int W>
  void bound(const HeightGrid& grid, const HeightLineLanes<W>& l, unsigned of, bool forward_x_of,
             bool forward_z_of) {
    lanes = of, forward_x = forward_x_of, forward_z = forward_z_of;
    double t0 = kFar, t1 = -kFar, reach = 0;
    for (unsigned left = of; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left);
      t0 = std::min(t0, l.from[k]), t1 = std::max(t1, l.to[k]);
      reach = std::max(reach, std::abs(l.o[0][k]) + std::abs(l.o[2][k]));
    }
    t0 = std::max(t0, -kFar), t1 = std::min(t1, kFar);
    // Floats of numbers up to the sides of the field, and doubles of those of the lines.
    const double slack = std::max(grid.columns(), grid.rows()) * 0x1p-19 + reach * 0x1p-46;
    spread = 0;
    side(l, 0, t0, t1, forward_x ? 1 : -1, slack, x_);
    side(l, 2, t0, t1, forward_z ? 1 : -1, slack, z_);
    height(l, t0, t1, grid);
  }

  /// Bit a + 4 b for each block (a, b) of a node, whose blocks have `side` cells along theirs and whose first
  /// one begins at cell (i, j), in the order in which lines pass them: `a` and `b` count in their directions.
  template <class A>
  OKTETT_INLINE unsigned meets(const HeightNode& node, double i, double j, double side) const {
    using F = Simd<float, 16, A>;
    alignas(64) static constexpr float kUp[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    alignas(64) static constexpr float kDown[16] = {3, 2, 1, 0, 3, 2, 1, 0, 3, 2, 1, 0, 3, 2, 1, 0};
    alignas(64) static constexpr float kRowsUp[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    alignas(64) static constexpr float kRowsDown[16] = {3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0};
    const F size(static_cast<float>(side)), zero(0.0f), one(1.0f);
    const auto near = [&](double first, bool forward, const float* up, const float* down) {
      const double base = forward ? first : -(first + 4 * side);
      return F(static_cast<float>(base)) + size * F::load(forward ? up : down);
    };
    const F x = near(i, forward_x, kUp, kDown), z = near(j, forward_z, kRowsUp, kRowsDown);
    // Where s < 0 or s > 1 it does not matter by how much.
    const F in = max(max((x - F(x_.high)) * F(x_.per_low), (z - F(z_.high)) * F(z_.per_low)), zero);
    const F out = min(min(((x + size) - F(x_.low)) * F(x_.per_high), ((z + size) - F(z_.low)) * F(z_.per_high)), one);
    const F low = F(y_low_) + min(in * F(rise_low_), out * F(rise_low_));
    const F high = F(y_high_) + max(in * F(rise_high_), out * F(rise_high_));
    const F least = load_words<A>(node.least), greatest = load_words<A>(node.greatest);
    return in_order(bits((in <= out) & (least <= high) & (low <= greatest)));
  }
  /// Turns the order of lines into that of the node, or back.
  OKTETT_INLINE unsigned block_of(unsigned in_order) const {
    return in_order ^ (forward_x ? 0u : 3u) ^ (forward_z ? 0u : 12u);
  }

 private:
  static constexpr double kFar = 0x1p+900;
  /// Samples at s = 0, and by how much s grows with each.
  struct Side {
    float low, high, per_low, per_high;
  };

  template <int W>
  OKTETT_INLINE void side(const HeightLineLanes<W>& l, int axis, double t0, double t1, double sign, double slack,
                          Side& out) {
    double low = kFar, high = -kFar, way_low = kFar, way_high = 0;
    for (unsigned left = lanes; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left);
      const double d = l.d[axis][k], begin = sign * (l.o[axis][k] + t0 * d);
      // What hardly moves is taken to move a little, which is less than the slack.
      const double way = std::max(std::abs(d) * (t1 - t0), slack * 0.25);
      low = std::min(low, begin), high = std::max(high, begin);
      way_low = std::min(way_low, way), way_high = std::max(way_high, way);
    }
    spread = std::max(spread, (high - low) + (way_high - way_low));
    out.low = static_cast<float>(low - slack), out.high = static_cast<float>(high + slack);
    out.per_low = static_cast<float>(1 / way_high), out.per_high = static_cast<float>(1 / way_low);
  }

  template <int W>
  OKTETT_INLINE void height(const HeightLineLanes<W>& l, double t0, double t1, const HeightGrid& grid) {
    double low = kFar, high = -kFar, rise_low = kFar, rise_high = -kFar, slack = 0;
    const double per_step = 1 / grid.step();
    for (unsigned left = lanes; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left);
      const double begin = ((l.o[1][k] - grid.least()) + t0 * l.d[1][k]) * per_step;
      const double rise = l.d[1][k] * (t1 - t0) * per_step;
      low = std::min(low, begin), high = std::max(high, begin);
      rise_low = std::min(rise_low, rise), rise_high = std::max(rise_high, rise);
      slack = std::max(slack, 0.125 + l.noise[k] * per_step + (std::abs(begin) + std::abs(rise)) * 0x1p-20);
    }
    // What floats cannot bound meets everything.
    const bool bounded = std::abs(low) + std::abs(high) + std::abs(rise_low) + std::abs(rise_high) + slack < 0x1p+100;
    y_low_ = bounded ? static_cast<float>(low - slack) : -0x1p+100f;
    y_high_ = bounded ? static_cast<float>(high + slack) : 0x1p+100f;
    rise_low_ = bounded ? static_cast<float>(rise_low) : 0;
    rise_high_ = bounded ? static_cast<float>(rise_high) : 0;
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
