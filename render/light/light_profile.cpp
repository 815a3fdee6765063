#include "render/light/light_profile.h"

#include <algorithm>
#include <numbers>

#include "core/math.h"

namespace oktett {

/// The interval of `angles`, which holds `angle`, as the index of its end, and the place in it. A single
/// angle is an interval by itself.
static std::size_t find_interval(const std::vector<double>& angles, double angle, double& place) {
  place = 1;
  if (angles.size() == 1) return 0;
  const auto end =
      std::clamp<std::ptrdiff_t>(std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin(), 1,
                                 static_cast<std::ptrdiff_t>(angles.size()) - 1);
  const auto i = static_cast<std::size_t>(end);
  place = std::clamp((angle - angles[i - 1]) / (angles[i] - angles[i - 1]), 0.0, 1.0);
  return i;
}

double profile_value(const LightProfile& p, double vertical, double horizontal) {
  if (!(vertical >= p.vertical.front() && vertical <= p.vertical.back())) return 0;
  double down, around;
  const std::size_t v = find_interval(p.vertical, vertical, down);
  const std::size_t h = find_interval(p.horizontal, horizontal, around);
  const auto column = [&](std::size_t k) {
    const float* values = p.values.data() + k * p.vertical.size();
    return v == 0 ? double{values[0]} : values[v - 1] * (1 - down) + values[v] * down;
  };
  return h == 0 ? column(0) : column(h - 1) * (1 - around) + column(h) * around;
}

double profile_flux(const LightProfile& p) {
  // The integral of (a + b x) sin x is sin(x) b - cos(x) (a + b x).
  const auto column = [&](std::size_t h) {
    const float* values = p.values.data() + h * p.vertical.size();
    double sum = 0;
    for (std::size_t v = 1; v < p.vertical.size(); ++v) {
      const double x0 = p.vertical[v - 1] * kDegree, x1 = p.vertical[v] * kDegree;
      const double y0 = values[v - 1], y1 = values[v], b = (y1 - y0) / (x1 - x0);
      sum += (portable::sin(x1) - portable::sin(x0)) * b - portable::cos(x1) * y1 + portable::cos(x0) * y0;
    }
    return sum;
  };
  if (p.horizontal.size() == 1) return 2 * std::numbers::pi * column(0);
  double sum = 0;
  for (std::size_t h = 1; h < p.horizontal.size(); ++h)
    sum += (column(h - 1) + column(h)) / 2 * (p.horizontal[h] - p.horizontal[h - 1]) * kDegree;
  return sum;
}

}  // namespace oktett
