#include "render/sampling/warp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/elementary.h"
#include "core/math.h"

namespace oktett {

Vec3f cosine_direction(const Vec3f& n, const SquareSample& s) {
  using D = Simd<double, 1, ScalarIsa>;
  const double radius = std::sqrt(s.x);
  D sine, cosine;
  sin_cos_of_turn(D(s.y), sine, cosine);
  const auto x = static_cast<float>(radius * only_lane(cosine));
  const auto y = static_cast<float>(radius * only_lane(sine));
  const auto z = static_cast<float>(std::sqrt(1 - s.x));
  Vec3f tangent, bitangent;
  make_basis(n, tangent, bitangent);
  return normalize(tangent * x + bitangent * y + n * z);
}

SquareSample disk_point(const SquareSample& s) {
  constexpr double kQuarter = std::numbers::pi / 4;
  const double a = 2 * s.x - 1, b = 2 * s.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b, angle = kQuarter * (wide ? b / a : a / b);
  const double along = radius * portable::cos(angle), across = radius * portable::sin(angle);
  return wide ? SquareSample{along, across} : SquareSample{across, along};
}

// ---- Places of samples about a pixel's centre, with the density of a reconstruction filter.

/// So many that the standard deviation of the steps is that of the bell within 1e-6 of the radius.
static constexpr std::uint32_t kSteps = 2048;

double filter_weight(FilterKind kind, double x) {
  switch (kind) {
    case FilterKind::box:
      return 1;
    case FilterKind::tent:
      return 1 - std::abs(x);
    case FilterKind::gaussian:
      return portable::exp(-4.5 * x * x);
    case FilterKind::blackman_harris: {
      const double angle = std::numbers::pi * (x + 1);
      return 0.35875 - 0.48829 * portable::cos(angle) + 0.14128 * portable::cos(2 * angle) -
             0.01168 * portable::cos(3 * angle);
    }
  }
  return 1;
}

FilterSampler::FilterSampler(FilterKind kind, double radius)
    : kind_(kind), radius_(radius > 0 ? radius : usual_radius(kind)) {
  if (kind == FilterKind::box || kind == FilterKind::tent) return;
  std::vector<double> weight(kSteps);
  double sum = 0;
  for (std::uint32_t i = 0; i < kSteps; ++i)
    sum += weight[i] = filter_weight(kind, (i + 0.5) * (2.0 / kSteps) - 1);
  below_.push_back(0);
  double below = 0;
  for (const double w : weight) below_.push_back((below += w) / sum);
  below_.back() = 1;
  std::uint32_t step = 0;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    while (below_[step + 1] <= static_cast<double>(i) / kSteps) ++step;
    first_.push_back(step);
  }
}

double FilterSampler::offset(double u) const {
  if (kind_ == FilterKind::box) return (u - 0.5) * (2 * radius_);
  if (kind_ == FilterKind::tent) return radius_ * (u < 0.5 ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u));
  std::uint32_t step = first_[static_cast<std::size_t>(u * kSteps)];
  while (below_[step + 1] <= u) ++step;
  const double part = (u - below_[step]) / (below_[step + 1] - below_[step]);
  return radius_ * ((step + part) * (2.0 / kSteps) - 1);
}

}  // namespace oktett
