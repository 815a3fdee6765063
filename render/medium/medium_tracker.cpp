#include "render/medium/medium_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/math.h"
#include "render/medium/medium.h"

namespace oktett {

// ---- How a medium scatters light: the phase function of Henyey and Greenstein (1941).

/// `anisotropy` within its bounds; 0 for NaN.
static double bounded(float anisotropy) {
  const double most = kMostAnisotropy;
  return anisotropy == anisotropy ? std::clamp(static_cast<double>(anisotropy), -most, most) : 0;
}

float phase_value(const Vec3f& direction, const Vec3f& onward, float anisotropy) {
  const double g = bounded(anisotropy);
  const Vec3d a(direction), b(onward);
  // The cosine would lose the smallest angles: |a - b|^2 = 2 - 2 cos, |a + b|^2 = 2 + 2 cos.
  const double square =
      g < 0 ? (1 + g) * (1 + g) - g * dot(a + b, a + b) : (1 - g) * (1 - g) + g * dot(a - b, a - b);
  return static_cast<float>((1 - g * g) / (4 * std::numbers::pi * square * std::sqrt(square)));
}

Vec3f phase_direction(const Vec3f& direction, float anisotropy, const SquareSample& u) {
  const double g = bounded(anisotropy);
  double cosine = 1 - 2 * u.x;
  if (std::abs(g) > 1e-3) {
    const double root = (1 - g * g) / (1 + g - 2 * g * u.x);
    cosine = std::clamp((1 + g * g - root * root) / (2 * g), -1.0, 1.0);
  }
  const double sine = std::sqrt((1 - cosine) * (1 + cosine)), angle = 2 * std::numbers::pi * u.y;
  const Vec3d z = normalize(Vec3d(direction));
  Vec3d x, y;
  make_basis(z, x, y);
  return Vec3f(normalize(x * (sine * portable::cos(angle)) + y * (sine * portable::sin(angle)) + z * cosine));
}

// ---- The blocks of a DensityGrid along a ray, in order (Amanatides and Woo 1987).

BlockWalk::BlockWalk(const DensityGrid& grid, const Vec3d& origin, const Vec3d& direction, double length)
    : grid_(grid), end_(length) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double most = grid.size(axis) - 1.0;
    if (direction[axis] == 0) {
      // The comparison sorts out NaN.
      if (!(origin[axis] >= 0 && origin[axis] <= most)) end_ = -1;
      continue;
    }
    const double a = -origin[axis] / direction[axis], b = (most - origin[axis]) / direction[axis];
    if (!(std::min(a, b) <= std::max(a, b))) end_ = -1;
    begin_ = std::max(begin_, std::min(a, b)), end_ = std::min(end_, std::max(a, b));
  }
  if (!(begin_ < end_)) return;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (origin[axis] + direction[axis] * begin_) / DensityGrid::kBlock;
    block_[axis] = static_cast<int>(std::clamp(place, 0.0, grid.blocks(axis) - 1.0));
    step_[axis] = direction[axis] > 0 ? 1 : -1;
    const int border = block_[axis] + (direction[axis] > 0 ? 1 : 0);
    const bool moves = direction[axis] != 0;
    crossing_[axis] = moves ? (border * DensityGrid::kBlock - origin[axis]) / direction[axis] : kNever;
    across_[axis] = moves ? DensityGrid::kBlock / std::max(direction[axis], -direction[axis]) : kNever;
  }
}

bool BlockWalk::next(BlockSpan& span) {
  if (!(begin_ < end_)) return false;
  int axis = 0;
  if (crossing_[1] < crossing_[axis]) axis = 1;
  if (crossing_[2] < crossing_[axis]) axis = 2;
  span = {begin_, std::clamp(crossing_[axis], begin_, end_),
          grid_.block_most(block_[0], block_[1], block_[2])};
  begin_ = span.end;
  crossing_[axis] += across_[axis];
  block_[axis] += step_[axis];
  if (block_[axis] < 0 || block_[axis] >= grid_.blocks(axis)) {
    span.end = end_;
    begin_ = end_;
  }
  return true;
}

// ---- Tracking.

/// Coefficients of at least 0 whose products with lengths stay finite.
static Vec3d coefficients(const Color& c) {
  const auto bounded = [](float x) { return x > 0 ? std::min(static_cast<double>(x), 1e30) : 0; };
  return {bounded(c.x), bounded(c.y), bounded(c.z)};
}

/// e^(-s t); 1 for s = 0 at any distance.
static double passing(double s, double t) { return s == 0 ? 1 : portable::exp(-s * t); }
static Vec3d passing(const Vec3d& s, double t) { return {passing(s.x, t), passing(s.y, t), passing(s.z, t)}; }

/// The integral of e^(-s x) for x from 0 to t.
static double passing_integral(double s, double t) {
  const double depth = s == 0 ? 0 : s * t;
  // 1 - e^-x cancels for small x.
  return depth < 1e-4 ? t * (1 - depth / 2 + depth * depth / 6) : (1 - portable::exp(-depth)) / s;
}

MediumTracker::MediumTracker(const Medium& medium)
    : scattering_(coefficients(medium.scattering)),
      extinction_(coefficients(medium.absorption) + scattering_),
      emission_(coefficients(medium.emission)),
      anisotropy_(medium.anisotropy),
      scatters_(max_component(scattering_) > 0),
      grid_(medium.grid) {
  if (!grid_) return;
  const auto cells = [&](int axis) { return grid_->size(axis) - 1.0; };
  const bool has_place = medium.grid_place.is_invertible() && grid_->most() > 0;
  if (has_place) to_cells_ = Affine::scaling({cells(0), cells(1), cells(2)}) * medium.grid_place.inverse();
  rate_ = has_place ? max_component(extinction_) : 0;
  if (has_place && rate_ == 0 && max_component(emission_) > 0) {
    // Light without matter: as many places as in smoke that is eight times as thick as light goes in it.
    const double diagonal = length(medium.grid_place.vector({1, 1, 1}));
    rate_ = 8 / (grid_->most() * diagonal);
  }
}

Color MediumTracker::transmittance(const MediumSegment& segment, TrackingNumbers& numbers) const {
  if (grid_) return grid_transmittance(segment, numbers);
  return Color(passing(extinction_, segment.length));
}

MediumPassage MediumTracker::pass(const MediumSegment& segment, const Color& throughput,
                                  const SquareSample& u, TrackingNumbers& numbers) const {
  if (grid_) return pass_grid(segment, throughput, numbers);
  MediumPassage passage;
  passage.throughput = throughput;
  const Vec3d weight(throughput);
  Vec3d emitted{0, 0, 0};
  for (int c = 0; c < 3; ++c)
    if (emission_[c] > 0)
      emitted[c] = weight[c] * emission_[c] * passing_integral(extinction_[c], segment.length);
  passage.emitted = Color(emitted);

  const double sum = weight.x + weight.y + weight.z;
  if (!scatters_ || !(sum > 0)) {
    passage.throughput = Color(weight * passing(extinction_, segment.length));
    return passage;
  }
  const double place = u.y * sum;
  const double rate = place < weight.x              ? extinction_.x
                      : place < weight.x + weight.y ? extinction_.y
                                                    : extinction_.z;
  passage.t = rate > 0 ? -portable::log(1 - u.x) / rate : std::numeric_limits<double>::infinity();
  passage.scattered = passage.t < segment.length;
  if (!passage.scattered) {
    const Vec3d passed = weight * passing(extinction_, segment.length);
    passage.throughput = Color(passed * (sum / (passed.x + passed.y + passed.z)));
    return passage;
  }
  const Vec3d passed = weight * passing(extinction_, passage.t);
  passage.throughput = Color(passed * scattering_ * (sum / dot(passed, extinction_)));
  return passage;
}

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
