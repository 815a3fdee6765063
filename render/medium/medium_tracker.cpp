#include "render/medium/medium_tracker.h"

#include <algorithm>
#include <limits>

#include "core/math.h"

namespace oktett {

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

}  // namespace oktett
