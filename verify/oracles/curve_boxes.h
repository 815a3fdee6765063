#pragma once
/// \file Thin boxes that hold the curves of an outline or a profile, to tell where in their plane no curve
/// is.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "verify/oracles/enclosure.h"

namespace oktett {

/// Boxes that hold parts of plane curves, in boxes about whole pieces.
class CurveBoxes {
 public:
  /// Adds the piece (x(s), y(s)), 0 <= s <= 1, of degree 3 at most. A coordinate has a value `at(s)` and a
  /// derivative `slope(s)`.
  template <class X, class Y>
  void add(const X& x, const Y& y) {
    Group group{box_about(x, y, 0, 1), {}};
    for (int i = 0; i < kParts; ++i)
      group.parts[i] = box_about(x, y, double(i) / kParts, double(i + 1) / kParts);
    groups_.push_back(group);
  }
  /// Whether a curve may come into a box.
  bool meet(const Enclosure& x, const Enclosure& y) const {
    const double half_x = 0.5 * (x.hi - x.lo), half_y = 0.5 * (y.hi - y.lo);
    const auto meets = [&](const Box& box) {
      const double dx = 0.5 * (x.lo + x.hi) - box.x, dy = 0.5 * (y.lo + y.hi) - box.y;
      // Apart along the axes or across the curve.
      return std::abs(dx) <= box.half_x + half_x && std::abs(dy) <= box.half_y + half_y &&
             std::abs(dx * box.across_x + dy * box.across_y) <=
                 box.thick + half_x * std::abs(box.across_x) + half_y * std::abs(box.across_y);
    };
    for (const Group& group : groups_)
      if (meets(group.all) && std::any_of(std::begin(group.parts), std::end(group.parts), meets)) return true;
    return false;
  }

 private:
  static constexpr int kParts = 32;
  /// A box along the axes about its middle, of which only a strip counts.
  struct Box {
    double x, y, half_x, half_y;
    double across_x = 0, across_y = 0, thick = 0;  ///< the normal of the strip, and half its width
  };
  struct Group {
    Box all, parts[kParts];
  };

  /// About the control points of a part, with some room for rounding.
  template <class X, class Y>
  static Box box_about(const X& x, const Y& y, double from, double to) {
    double px[4], py[4];
    control_points(x, from, to, px), control_points(y, from, to, py);
    const auto [x0, x1] = std::minmax_element(px, px + 4);
    const auto [y0, y1] = std::minmax_element(py, py + 4);
    Box box{0.5 * (*x0 + *x1), 0.5 * (*y0 + *y1), 0.5 * (*x1 - *x0), 0.5 * (*y1 - *y0)};
    const double dx = px[3] - px[0], dy = py[3] - py[0], long_by = std::hypot(dx, dy);
    if (long_by > 0) box.across_x = -dy / long_by, box.across_y = dx / long_by;
    for (int k = 0; k < 4; ++k)
      box.thick =
          std::max(box.thick, std::abs((px[k] - box.x) * box.across_x + (py[k] - box.y) * box.across_y));
    const double rounding = 1e-9 * (1 + std::abs(box.x) + std::abs(box.y) + box.half_x + box.half_y);
    box.half_x += rounding, box.half_y += rounding, box.thick += rounding;
    return box;
  }
  template <class X>
  static void control_points(const X& x, double from, double to, double (&p)[4]) {
    const double third = (to - from) / 3;
    p[0] = x.at(from), p[3] = x.at(to), p[1] = p[0] + third * x.slope(from),
    p[2] = p[3] - third * x.slope(to);
  }

  std::vector<Group> groups_;
};

}  // namespace oktett
