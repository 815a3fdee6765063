#include "kernels/exact/implicit_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math.h"
#include "kernels/functions/function_tape.h"
#include "kernels/functions/variation.h"

namespace oktett {

namespace {

using Lane = Simd<double, 1, ScalarIsa>;
constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr ImplicitGridCell kUnknown{{kNoLimit, kNoLimit}, kNoLimit, 0};

/// Rounded up; bounds are computed with relative errors far below 2^-20.
float upward(double x) { return static_cast<float>(x * (1 + 0x1p-20) + 0x1p-140); }

ImplicitGridCell cell_of(const Variation<Lane>& f) {
  const auto number = [](const Lane& x) { return only_lane(x); };
  const double error = number(f.error), lo = number(f.v.lo), hi = number(f.v.hi);
  double h[6];
  for (int k = 0; k < 6; ++k) h[k] = number(f.h[k]);
  // By Gershgorin's theorem no eigenvalue is larger than the greatest sum of a row.
  const double bend = std::max({h[0] + h[3] + h[4], h[3] + h[1] + h[5], h[4] + h[5] + h[2]});
  const double slope = length(only_lane(f.g));
  ImplicitGridCell c{
      {upward(bend + number(f.falls)), upward(bend + number(f.rises))}, upward(slope), upward(error)};
  const bool known = std::isfinite(lo) && std::isfinite(hi) && number(f.doubt) == 0 && std::isfinite(bend) &&
                     std::isfinite(c.slope) && std::isfinite(c.error) &&
                     number(f.slope_error) <= slope * (kSlopeError / 2);
  if (!known) return kUnknown;
  if (lo > 256 * error || hi < -256 * error) c.bend[0] = c.bend[1] = c.slope = 0;
  return c;
}

/// What is known of cell (x, y, z) of a grid.
ImplicitGridCell known_of(const FunctionTape& function, const VariationGrid& grid, const Vec3d& hi,
                          const int (&at)[3]) {
  Variation<Lane> axis[3];
  for (int k = 0; k < 3; ++k) {
    Variation<Lane>& x = axis[k] = variation::constant(Lane(0.0));
    x.v = {Lane(grid.lo[k] + (at[k] - kGridMargin) / grid.per_unit[k]),
           Lane(grid.lo[k] + (at[k] + 1 + kGridMargin) / grid.per_unit[k])};
    x.error = Lane(std::max(max_component(abs(grid.lo)), max_component(abs(hi))) * 0x1p-47);
    (k == 0 ? x.g.x : k == 1 ? x.g.y : x.g.z) = Lane(1.0);
  }
  return cell_of(run_tape(function, axis[0], axis[1], axis[2]));
}

/// Calls f(x, y, z) for cells of a grid: for all, or for eight of them that represent them.
template <class F>
void each_cell(int side, bool all, const F& f) {
  const int count = all ? side * side * side : 8;
  for (int k = 0; k < count; ++k) {
    if (all)
      f({k % side, k / side % side, k / side / side});
    else
      f({k * side / 8, (3 * k + 1) % 8 * side / 8, (5 * k + 2) % 8 * side / 8});
  }
}

/// Some cells of a grid of `side`^3, of edges of at most `edge`.
struct Cells {
  int side;
  double edge;
  std::vector<ImplicitGridCell> list;

  double unknown() const {
    const auto count =
        std::ranges::count_if(list, [](const ImplicitGridCell& c) { return !std::isfinite(c.slope); });
    return static_cast<double>(count) / static_cast<double>(list.size());
  }
  /// The size of the function where its zeros may be, roughly; infinite if they are in no cell.
  double scale() const {
    double least = kInfinity;
    for (const ImplicitGridCell& c : list)
      if (c.slope > 0) least = std::min(least, c.slope * edge / 4);
    return least;
  }
  /// About how many steps a ray takes through the grid: one or more per cell, less where there are no zeros.
  double steps(double scale) const {
    constexpr double kQuiet = 0.3, kKinked = 9;
    double sum = 0;
    for (const ImplicitGridCell& c : list) {
      const double bend = std::min(c.bend[0], c.bend[1]);
      if (c.slope == 0)
        sum += kQuiet;
      else if (std::isfinite(bend))
        sum += 1 + edge * std::sqrt(bend / (2 * scale));
      else if (std::isfinite(c.slope))
        sum += kKinked + edge * c.slope / scale;
    }
    return side * sum / static_cast<double>(list.size());
  }
  /// Whether rays should try at all: intervals take about ten steps, each of which costs several of these. In
  /// small cells the number of steps is overestimated, as the scale is that of the flattest.
  bool pays() const { return unknown() <= 0.2 && steps(scale()) <= (side == kMostGridSide ? 50 : 20); }
};

/// Smaller cells have to save more than what passing their borders costs.
bool is_worth(const Cells& fine, const Cells& coarse) {
  if (fine.unknown() != coarse.unknown()) return fine.unknown() < coarse.unknown();
  const double scale = fine.scale();
  return !std::isfinite(scale) || fine.steps(scale) < 0.8 * coarse.steps(scale);
}

}  // namespace

VariationGrid make_variation_grid(const FunctionTape& function, const Vec3d& lo, const Vec3d& hi,
                                  int most_side) {
  const auto empty_grid = [&](int side) {
    VariationGrid grid{side, lo, {}, {}};
    for (int k = 0; k < 3; ++k) grid.per_unit[k] = side / (hi[k] - lo[k]);
    return grid;
  };
  VariationGrid grid;
  bool pays = false;
  for (const int side : {1, 4, 8}) {
    if (side > most_side || (side == kMostGridSide && function.steps.size() > 128)) break;
    VariationGrid next = empty_grid(side);
    if (!std::isfinite(max_component(next.per_unit))) break;
    const auto find = [&](bool all) {
      std::vector<ImplicitGridCell> cells;
      each_cell(side, all, [&](const int(&at)[3]) { cells.push_back(known_of(function, next, hi, at)); });
      return cells;
    };
    const double edge = max_component(hi - lo) / side;
    if (side > 1 && !is_worth({side, edge, find(false)}, {grid.side, edge * side / grid.side, grid.cells}))
      break;
    next.cells = find(true);
    grid = std::move(next);
    pays = Cells{side, edge, grid.cells}.pays();
  }
  if (!pays) grid.cells.clear();
  return grid;
}

}  // namespace oktett
