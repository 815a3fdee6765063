/// \file Tracking through media on grids, see medium_tracker.h.

#include <algorithm>

#include "core/math.h"
#include "render/medium/block_walk.h"
#include "render/medium/medium_tracker.h"

namespace oktett {
namespace {

constexpr int kMostPlaces = 1 << 16;

/// Stops at random places along a segment, more of them where the density may be greater.
class Places {
 public:
  /// `rate`: mean number of places per length and density.
  Places(const DensityGrid& grid, const Affine& to_cells, const MediumSegment& segment, double rate)
      : grid_(grid),
        origin_(to_cells.point(Vec3d(segment.origin))),
        direction_(to_cells.vector(Vec3d(segment.direction))),
        walk_(grid, origin_, direction_, segment.length),
        rate_(rate) {}

  /// Goes to the next place; false if there is none before the end.
  bool next(TrackingNumbers& numbers) {
    for (;;) {
      if (span_.most > 0) {
        t_ -= portable::log(1 - numbers.next()) / (span_.most * rate_);
        if (t_ < span_.end) return true;
      }
      if (!walk_.next(span_)) return false;
      t_ = span_.begin;
    }
  }

  double t() const { return t_; }
  /// The density here over the density of places: the mean length of the way between two places that has the
  /// density here.
  double depth() const {
    const double density = std::min(grid_.at(origin_ + direction_ * t_), span_.most);
    return density / (span_.most * rate_);
  }

 private:
  const DensityGrid& grid_;
  Vec3d origin_, direction_;
  BlockWalk walk_;
  BlockSpan span_;
  double rate_, t_ = 0;
};

}  // namespace

Color MediumTracker::grid_transmittance(const MediumSegment& segment, TrackingNumbers& numbers) const {
  constexpr double kSmall = 0.1, kSurvival = 0.5;
  Vec3d passed{1, 1, 1};
  if (!(max_component(extinction_) > 0 && rate_ > 0)) return Color(passed);
  Places places(*grid_, to_cells_, segment, rate_);
  for (int count = 0; places.next(numbers); ++count) {
    if (count == kMostPlaces) return {0, 0, 0};
    passed = passed * (Vec3d{1, 1, 1} - extinction_ * places.depth());
    if (max_component(passed) >= kSmall) continue;
    if (numbers.next() >= kSurvival) return {0, 0, 0};
    passed = passed / kSurvival;
  }
  return Color(passed);
}

MediumPassage MediumTracker::pass_grid(const MediumSegment& segment, const Color& throughput,
                                       TrackingNumbers& numbers) const {
  MediumPassage passage;
  passage.throughput = throughput;
  Vec3d weight(throughput), emitted{0, 0, 0};
  if (!(rate_ > 0 && max_component(weight) > 0)) return passage;
  Places places(*grid_, to_cells_, segment, rate_);
  for (int count = 0; places.next(numbers); ++count) {
    if (count == kMostPlaces) weight = {0, 0, 0};
    const double sum = weight.x + weight.y + weight.z;
    if (!(sum > 0)) break;
    const double depth = places.depth();
    emitted += weight * emission_ * depth;
    const Vec3d lost = extinction_ * depth;
    // The part of the path's light that is scattered or absorbed here.
    const double chance = scatters_ ? dot(weight, lost) / sum : 0;
    if (scatters_ && numbers.next() < chance) {
      weight = weight * scattering_ * (depth / chance);
      passage.scattered = true, passage.t = places.t();
      break;
    }
    weight = weight * (Vec3d{1, 1, 1} - lost) / (1 - chance);
  }
  passage.throughput = Color(weight), passage.emitted = Color(emitted);
  return passage;
}

}  // namespace oktett
