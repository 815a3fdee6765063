#include "kernels/fields/metaballs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace oktett {

namespace {

/// Cells are divided down to this, in radii of their smallest ball.
constexpr double kLeastBallSize = 0.5;
/// Times relative to that of a node, measured with 8 rays at once: a cell, and each of its balls.
constexpr double kBallCellCost = 6, kBallCost = 2;

class BallRule : public CellRule {
 public:
  BallRule(const std::vector<Ball>& balls, double iso) : balls_(balls), iso_(iso) {}

  CellRange narrow(const CellBox& box, std::span<const std::uint32_t> part,
                   std::vector<std::uint32_t>& out) const override {
    double least = 0, most = 0, size = iso_;
    for (const std::uint32_t i : part) {
      const Ball& ball = balls_[i];
      double near = 0, far = 0;
      for (int k = 0; k < 3; ++k) {
        const double below = box.lo[k] - ball.center[k], above = ball.center[k] - box.hi[k];
        near += clamp_square(std::max(below, above));
        far += std::max(below * below, above * above);
      }
      if (near >= ball.square) continue;
      out.push_back(i);
      const double high = ball.strength * clamp_square(1 - near * ball.inverse_square);
      const double low = ball.strength * clamp_square(1 - far * ball.inverse_square);
      least += std::min(low, high), most += std::max(low, high);
      size += std::abs(ball.strength);
    }
    const double error = 0x1p-36 * size;
    return {iso_ - most - error, iso_ - least + error};
  }

  double least_size(std::span<const std::uint32_t> part) const override {
    double square = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : part) square = std::min(square, balls_[i].square);
    return kLeastBallSize * std::sqrt(square);
  }

  double cost(std::span<const std::uint32_t> part) const override {
    return kBallCellCost + kBallCost * static_cast<double>(part.size());
  }

 private:
  const std::vector<Ball>& balls_;
  double iso_;
};

}  // namespace

void Metaballs::add(Pool& pool, const MetaballsShape& s, const ExactPlace& place) {
  const auto counts = [](const MetaBall& b) { return b.radius > 0 && b.strength != 0; };
  Vec3d lo, hi;
  bool any = false;
  double least = std::numeric_limits<double>::infinity();
  for (const MetaBall& b : s.balls) {
    if (!std::isfinite(dot(b.center, b.center)) || !std::isfinite(b.radius) || !std::isfinite(b.strength))
      return;
    if (!counts(b)) continue;
    least = std::min(least, b.radius);
    if (b.strength < 0) continue;
    const Vec3d r{b.radius, b.radius, b.radius};
    lo = any ? min(lo, b.center - r) : b.center - r;
    hi = any ? max(hi, b.center + r) : b.center + r;
    any = true;
  }
  if (!any || !(s.iso > 0 && std::isfinite(s.iso))) return;
  const Vec3d middle = lo + (hi - lo) * 0.5, extent = hi - lo;
  const double size = 0.5 * std::max({extent.x, extent.y, extent.z});
  MetaballsElement e{s.iso, std::max(0x1p-32 * least / size, 0x1p-48),
                     static_cast<std::uint32_t>(pool.balls.size()), 0, 0};
  for (const MetaBall& b : s.balls) {
    if (!counts(b)) continue;
    const double r = b.radius / size;
    const double alone =
        b.strength >= s.iso ? std::sqrt(s.iso / b.strength) : std::numeric_limits<double>::infinity();
    pool.balls.push_back({(b.center - middle) / size, r * r, 1 / (r * r), b.strength, alone});
  }
  e.count = static_cast<std::uint32_t>(pool.balls.size()) - e.begin;
  std::vector<std::uint32_t> all(e.count);
  std::iota(all.begin(), all.end(), e.begin);
  BallRule rule(pool.balls, s.iso);
  const Vec3d half = extent * (0.5 / size);
  const auto element = static_cast<std::uint32_t>(pool.elements.size());
  e.root = pool.tree.divide(rule, {-half, half}, all, element, pool.cells);
  add_element(pool, e, place.to_world * Affine::translation(middle) * Affine::scaling({size, size, size}),
              place);
}

}  // namespace oktett
