#include "render/light/light_tree.h"

#include <algorithm>
#include <cmath>

namespace oktett {

/// Light leaves and arrives up to this much, in cosines, beyond what the bounds say. It covers rounding.
static constexpr float kLeastCosine = 1e-3f;

/// The part of the greatest cosine in the estimate of a mean cosine, and the part of the square of the radius
/// that the square of the distance is at least. Chosen for small variance in rows, clouds and clusters of
/// lamps.
static constexpr float kPartOfGreatest = 0.1f;
static constexpr float kPartOfRadius = 0.125f;

/// Squares of distances are at least this large, so that divisions do not overflow.
static constexpr float kLeastSquare = 1e-30f;

/// Importances are at least this large where they are not 0, and at least this part of the sum.
static constexpr float kLeastImportance = 1e-37f;
static constexpr double kLeastPart = 0x1p-30;

// All lanes take the same way, so that the compiler can compute them together.

/// The mean of max(0, x) for x uniform in [mean - width, mean + width].
static inline float positive_part(float mean, float width) {
  const float wide = std::max(width, 1e-6f), above = std::min(std::max(mean + wide, 0.0f), 2 * wide);
  return above * above / (4 * wide) + std::max(mean - wide, 0.0f);
}

/// Whether an angle of cosine `cosine` is surely greater than the sum of an angle of cosine `limit` and an
/// acute one of sine `ball`; 1 stands for any angle. cos(a + b) = cos(a) cos(b) - sin(a) sin(b) is not below
/// this bound.
static inline bool is_beyond(float cosine, float limit, float ball) {
  return (ball < 1) & (cosine < std::min(limit, limit * (1 - ball * ball)) - ball - kLeastCosine);
}

/// About the mean of the cosines of a set of angles, none taken below 0, whose cosines are `mean` plus or
/// minus `width`. `middle` is the cosine of the angle in their middle. The part of their greatest cosine
/// keeps the mean from being far too low where the few emitters that face the point are the strongest.
static inline float mean_cosine(float mean, float width, float middle) {
  const float sum = std::min(std::max(middle + width, kLeastCosine), 1.0f), greatest = width < 1 ? sum : 1;
  return positive_part(mean, width) * (1 - kPartOfGreatest) + greatest * kPartOfGreatest;
}

double LightTree::Importances::sum() const {
  return (double{lane[0]} + double{lane[1]}) + (double{lane[2]} + double{lane[3]});
}

LightTree::Importances LightTree::importances(const Quad& quad, const LightPoint& point) {
  const Vec3f p = point.position, n = point.normal;
  const bool any_side = !point.front_only, surface = n != Vec3f{};
  Importances result;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const float x = quad.center[0][i] - p.x, y = quad.center[1][i] - p.y, z = quad.center[2][i] - p.z;
    const float square = std::max(x * x + y * y + z * z, kLeastSquare), scale = 1 / std::sqrt(square);
    // The sine of half the angle that the sphere fills; from inside, light may come from all directions.
    const float ball = std::min(quad.radius[i] * scale, 1.0f);

    const float cosine = -(quad.axis[0][i] * x + quad.axis[1][i] * y + quad.axis[2][i] * z) * scale;
    const float cos_spread = quad.cos_spread[i];
    const float sin_spread = cos_spread > 0 ? std::sqrt(std::max(1 - cos_spread * cos_spread, 0.0f)) : 1.0f;
    const float width = std::min(1.0f, sin_spread + ball), mean = cosine * (1 + cos_spread) * 0.5f;
    const bool both_sides = (quad.child[i] & kBothSides) != 0;
    const float leaving_cosine = both_sides ? std::abs(cosine) : cosine;
    const float back = positive_part(-mean, width);
    const float leaving = mean_cosine(mean, width, leaving_cosine) + (both_sides ? back : 0.0f);

    const float incidence = (n.x * x + n.y * y + n.z * z) * scale;
    const float arriving_cosine = any_side ? std::abs(incidence) : incidence;
    const float behind = positive_part(-incidence, ball);
    const float arriving = mean_cosine(incidence, ball, arriving_cosine) + (any_side ? behind : 0.0f);

    const float nearest = std::max(square, kPartOfRadius * quad.radius[i] * quad.radius[i]);
    const float importance = quad.power[i] / nearest * leaving * (surface ? arriving : 1.0f);
    const bool dark = is_beyond(leaving_cosine, quad.cos_limit[i], ball) |
                      (surface & is_beyond(arriving_cosine, 0, ball)) | !(quad.power[i] > 0);
    result.lane[i] = dark ? 0.0f : std::max(importance, kLeastImportance);
  }
  return result;
}

LightTree::Importances LightTree::weights(const Quad& quad, const LightPoint& point) {
  Importances w = importances(quad, point);
  const double sum = w.sum();
  // If none can light the point, and where floats overflow.
  if (!(sum > 0) || !std::isfinite(sum)) {
    std::copy(quad.power, quad.power + kLanes, w.lane);
    // Powers of nodes may be infinite sums.
    if (!std::isfinite(w.sum()))
      for (float& lane : w.lane) lane = lane > 0 ? 1 : 0;
    return w;
  }
  const auto least = static_cast<float>(sum * kLeastPart);
  for (float& lane : w.lane) lane = lane > 0 ? std::max(lane, least) : 0;
  return w;
}

std::optional<LightTree::Choice> LightTree::choose(const LightPoint& point, double u) const {
  if (quads_.empty()) return std::nullopt;
  double probability = 1;
  std::uint32_t child = 0;
  do {
    const Quad& quad = quads_[child / 4];
    const Importances w = weights(quad, point);
    const double sum = w.sum();
    double rest = u * sum;
    std::uint32_t chosen = kLanes;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      if (!(w.lane[i] > 0)) continue;
      if (chosen != kLanes) rest -= w.lane[chosen];
      chosen = i;
      if (rest < w.lane[i]) break;
    }
    // Rounding may give 1.
    u = std::clamp(rest / w.lane[chosen], 0.0, 1 - 0x1p-53);
    probability *= w.lane[chosen] / sum;
    child = quad.child[chosen];
  } while (!(child & kLeaf));
  return Choice{child / 4, probability};
}

double LightTree::probability(const LightPoint& point, std::uint32_t index) const {
  // From the root, so that the product is the same bits as that of choose().
  std::uint32_t way[kDeepest], steps = 0;
  for (std::uint32_t slot = slots_[index]; slot != kRoot; slot = quads_[slot / 4].parent) way[steps++] = slot;
  double probability = 1;
  while (steps-- > 0) {
    const Importances w = weights(quads_[way[steps] / 4], point);
    probability *= w.lane[way[steps] % 4] / w.sum();
  }
  return probability;
}

double LightTree::importance(const LightPoint& point) const {
  return quads_.empty() ? 0 : importances(quads_[0], point).sum();
}

}  // namespace oktett
