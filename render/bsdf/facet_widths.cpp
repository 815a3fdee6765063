#include "render/bsdf/facet_widths.h"

#include "core/math.h"

namespace oktett {

std::span<const FacetPoint> facet_points() {
  static constexpr int kCount = 144, kGenerator = 89;
  static const std::array<FacetPoint, kCount> points = [] {
    std::array<FacetPoint, kCount> made{};
    double sum = 0;
    for (int i = 0; i < kCount; ++i) {
      // Turns are periodic by themselves; heights are made so (Sloan 1994).
      const double s = (i + 0.5) / kCount,
                   turn = 2 * std::numbers::pi * ((i * kGenerator % kCount + 0.5) / kCount);
      made[static_cast<std::size_t>(i)] = {s * s * (3 - 2 * s), portable::sin(turn), portable::cos(turn),
                                           s * (1 - s)};
      sum += s * (1 - s);
    }
    for (FacetPoint& p : made) p.weight /= sum;
    return made;
  }();
  return points;
}

}  // namespace oktett
