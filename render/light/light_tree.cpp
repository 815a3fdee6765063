#include "render/light/light_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/four.h"
#include "core/platform.h"

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

static void put(Four values, float (&to)[4]) { std::memcpy(to, &values, sizeof(to)); }

/// The mean of max(0, x) for x uniform in [mean - width, mean + width].
static Four positive_part(Four mean, Four width) {
  const Four wide = max(width, 1e-6f), above = min(max(mean + wide, 0), 2 * wide);
  return above * above / (4 * wide) + max(mean - wide, 0);
}

/// `x`, but 0 where an angle of cosine `cosine` is surely greater than the sum of an angle of cosine `limit`
/// and an acute one of sine `ball`; 1 stands for any angle. cos(a + b) = cos(a) cos(b) - sin(a) sin(b) is not
/// below this bound.
static Four unless_beyond(Four x, Four cosine, Four limit, Four ball) {
  const Four bound = min(limit, limit * (1 - ball * ball)) - ball - kLeastCosine;
  const auto beyond = (ball < 1) & (cosine < bound);
  return beyond ? four(0) : x;
}

/// About the mean of the cosines of a set of angles, none taken below 0, whose cosines are `mean` plus or
/// minus `width`. `middle` is the cosine of the angle in their middle. The part of their greatest cosine
/// keeps the mean from being far too low where the few emitters that face the point are the strongest.
static Four mean_cosine(Four mean, Four width, Four middle) {
  const Four sum = min(max(middle + width, kLeastCosine), 1), greatest = width < 1 ? sum : four(1);
  return positive_part(mean, width) * (1 - kPartOfGreatest) + greatest * kPartOfGreatest;
}

double LightTree::Importances::sum() const {
  return (double{lane[0]} + double{lane[1]}) + (double{lane[2]} + double{lane[3]});
}

LightTree::Importances LightTree::importances(const Quad& quad, const LightPoint& point) {
  const Four x = four(quad.center[0]) - point.position.x, y = four(quad.center[1]) - point.position.y;
  const Four z = four(quad.center[2]) - point.position.z, radius = four(quad.radius);
  const Four square = max(x * x + y * y + z * z, kLeastSquare), scale = 1 / square_root(square);
  // The sine of half the angle that the sphere fills; from inside, light may come from all directions.
  const Four ball = min(radius * scale, 1);

  const Four cosine = -(four(quad.axis[0]) * x + four(quad.axis[1]) * y + four(quad.axis[2]) * z) * scale;
  const Four cos_spread = four(quad.cos_spread);
  const Four width = min(four(quad.sin_spread) + ball, 1);
  const bool any_back = (quad.child[0] | quad.child[1] | quad.child[2] | quad.child[3]) & kBothSides;
  const auto back_part = [](std::uint32_t child) { return child & kBothSides ? 1.0f : 0.0f; };
  const Four back{back_part(quad.child[0]), back_part(quad.child[1]), back_part(quad.child[2]),
                  back_part(quad.child[3])};
  const Four leaving = any_back ? (back > 0 ? magnitude(cosine) : cosine) : cosine;
  const Four mean = leaving * (1 + cos_spread) * 0.5f;
  const Four power = four(quad.power), nearest = max(square, kPartOfRadius * radius * radius);
  Four leaving_part = mean_cosine(mean, width, leaving);
  if (any_back) leaving_part += back * positive_part(-mean, width);
  Four importance = power / nearest * leaving_part;
  Four lit = unless_beyond(power, leaving, four(quad.cos_limit), ball);

  if (point.normal != Vec3f{}) {
    const Four incidence = (point.normal.x * x + point.normal.y * y + point.normal.z * z) * scale;
    const Four arriving = point.front_only ? incidence : magnitude(incidence);
    Four cosines = mean_cosine(arriving, ball, arriving);
    if (!point.front_only) cosines += positive_part(-arriving, ball);
    importance *= cosines;
    lit = unless_beyond(lit, arriving, four(0), ball);
  }
  importance = lit > 0 ? max(importance, kLeastImportance) : four(0);
  Importances w;
  put(importance, w.lane);
  return w;
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
  put(four(w.lane) > 0 ? max(four(w.lane), least) : four(0), w.lane);
  return w;
}

void LightTree::step(const LightPoint& point, Walk& walk) const {
  const Quad& quad = quads_[walk.child / 4];
  const Importances w = weights(quad, point);
  const double sum = w.sum();
  // Without branches, as no processor can predict them.
  const double before[kLanes] = {0, double{w.lane[0]}, double{w.lane[0]} + w.lane[1],
                                 double{w.lane[0]} + w.lane[1] + w.lane[2]};
  const double place = walk.u * sum;
  std::uint32_t chosen =
      (place >= before[1] ? 1u : 0u) + (place >= before[2] ? 1u : 0u) + (place >= before[3] ? 1u : 0u);
  // By rounding, the place may be behind the last child that can be chosen.
  while (OKTETT_UNLIKELY(!(w.lane[chosen] > 0))) --chosen;
  const double rest = place - before[chosen];
  // Rounding may give 1.
  walk.u = std::clamp(rest / w.lane[chosen], 0.0, 1 - 0x1p-53);
  walk.probability *= w.lane[chosen] / sum;
  walk.child = quad.child[chosen];
}

std::optional<LightTree::Choice> LightTree::choose(const LightPoint& point, double u) const {
  if (quads_.empty()) return std::nullopt;
  Choice choice;
  choose({&point, 1}, &u, &choice);
  return choice;
}

void LightTree::choose(std::span<const LightPoint> points, const double* u, Choice* out) const {
  if (slots_.size() == 1) return void(std::fill_n(out, points.size(), Choice{0, 1}));
  constexpr std::size_t kTogether = 8;
  for (std::size_t first = 0; first < points.size(); first += kTogether) {
    Walk walks[kTogether];
    std::size_t left[kTogether], count = std::min(kTogether, points.size() - first);
    for (std::size_t k = 0; k < count; ++k) walks[k].u = u[first + k], left[k] = k;
    while (count > 0) {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = left[i];
        step(points[first + k], walks[k]);
        if (walks[k].child & kLeaf)
          out[first + k] = {walks[k].child / 4, walks[k].probability};
        else
          left[kept++] = k;
      }
      count = kept;
    }
  }
}

double LightTree::probability(const LightPoint& point, std::uint32_t index) const {
  if (slots_.size() == 1) return 1;
  // From the root, so that the product is the same bits as that of choose().
  std::uint32_t way[kDeepest], steps = 0;
  for (std::uint32_t slot = slots_[index]; slot != kRoot; slot = parents_[slot / 4]) way[steps++] = slot;
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
