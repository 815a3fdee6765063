#include "render/light/light_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {

/// Light leaves and arrives up to this much, in cosines, beyond what the bounds say. It covers rounding.
static constexpr float kLeastCosine = 1e-3f;

/// The part of the greatest cosine in the estimate of a mean cosine, and the part of the square of the radius
/// that the square of the distance is at least. Chosen for small variance in rows, clouds and clusters of
/// lamps.
static constexpr float kPartOfGreatest = 0.1f;
static constexpr float kPartOfRadius = 0.125f;

/// Importances and probabilities are at least this large where they are not 0.
static constexpr float kLeastImportance = 1e-37f;
static constexpr double kLeastProbability = 0x1p-30;

/// How far the stored axis may point away from the given one, in radians.
static constexpr double kAxisError = 1e-4;

static std::uint16_t stored_cosine(double angle) {
  const double cosine = portable::cos(std::min(angle, std::numbers::pi));
  return static_cast<std::uint16_t>(std::max(0.0, std::floor((cosine + 1) * 32767.5)));
}

static float cosine_of(std::uint16_t stored) { return static_cast<float>(stored) * (1 / 32767.5f) - 1; }

/// The octahedral map of a unit vector (Cigolle et al. 2014, JCGT 3(2)).
static void encode_axis(const Vec3f& axis, std::int16_t (&stored)[2]) {
  const float sum = std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z);
  float x = axis.x / sum, y = axis.y / sum;
  if (axis.z < 0) {
    const float folded = (1 - std::abs(y)) * std::copysign(1.0f, x);
    y = (1 - std::abs(x)) * std::copysign(1.0f, y);
    x = folded;
  }
  stored[0] = static_cast<std::int16_t>(std::floor(x * 32767 + 0.5f));
  stored[1] = static_cast<std::int16_t>(std::floor(y * 32767 + 0.5f));
}

/// Not unit, but not shorter than 1 / sqrt(3).
static Vec3f decode_axis(const std::int16_t (&stored)[2]) {
  const float x = static_cast<float>(stored[0]) * (1 / 32767.0f);
  const float y = static_cast<float>(stored[1]) * (1 / 32767.0f);
  const float z = 1 - std::abs(x) - std::abs(y);
  const float fold = std::max(-z, 0.0f);
  return {x - std::copysign(fold, x), y - std::copysign(fold, y), z};
}

LightTree::Node LightTree::make_node(const LightBounds& bounds) {
  Node node{};
  node.center = bounds.box.center();
  const Vec3d center(node.center);
  const Vec3d half = max(Vec3d(bounds.box.hi) - center, center - Vec3d(bounds.box.lo));
  node.radius = round_up(length(half) * (1 + 1e-12));
  node.power = bounds.power;
  encode_axis(bounds.axis, node.axis);
  node.cos_spread = stored_cosine(bounds.spread + kAxisError);
  node.cos_limit = stored_cosine(double{bounds.spread} + bounds.reach + kAxisError);
  node.both_sides = bounds.both_sides;
  return node;
}

/// The mean of max(0, x) for x uniform in [mean - width, mean + width].
static float positive_part(float mean, float width) {
  if (mean >= width) return mean;
  if (mean <= -width) return 0;
  return (mean + width) * (mean + width) / (4 * width);
}

/// Whether an angle of cosine `cosine` is surely greater than the sum of an angle of cosine `limit` and an
/// acute one of sine `ball`; 1 stands for any angle. cos(a + b) = cos(a) cos(b) - sin(a) sin(b) is not below
/// this bound.
static bool is_beyond(float cosine, float limit, float ball) {
  return ball < 1 && cosine < (limit > 0 ? limit * (1 - ball * ball) : limit) - ball - kLeastCosine;
}

/// About the mean of the cosines of a set of angles, none taken below 0, whose cosines are `mean` plus or
/// minus `width`. `middle` is the cosine of the angle in their middle. The part of their greatest cosine
/// keeps the mean from being far too low where the few emitters that face the point are the strongest.
static float mean_cosine(float mean, float width, float middle) {
  const float greatest = width < 1 ? std::clamp(middle + width, kLeastCosine, 1.0f) : 1;
  return positive_part(mean, width) * (1 - kPartOfGreatest) + greatest * kPartOfGreatest;
}

float LightTree::node_importance(const Node& node, const LightPoint& point) {
  const Vec3f to = node.center - point.position;
  const float square = dot(to, to), distance = std::sqrt(square);
  // The sine of half the angle that the sphere fills; from inside, light may come from all directions.
  const float ball = node.radius < distance ? node.radius / distance : 1;
  const float scale = distance > 0 ? 1 / distance : 0;

  const Vec3f axis = decode_axis(node.axis);
  const float cosine = -dot(axis, to) * scale / std::sqrt(dot(axis, axis));
  const float cos_spread = cosine_of(node.cos_spread);
  const float spread = cos_spread > 0 ? std::sqrt((1 - cos_spread) * (1 + cos_spread)) : 1;
  const float width = std::min(1.0f, spread + ball), mean = cosine * (1 + cos_spread) / 2;
  const float leaving_cosine = node.both_sides ? std::abs(cosine) : cosine;
  if (is_beyond(leaving_cosine, cosine_of(node.cos_limit), ball)) return 0;
  float leaving = mean_cosine(mean, width, leaving_cosine);
  if (node.both_sides) leaving += positive_part(-mean, width);

  float arriving = 1;
  if (point.normal != Vec3f{}) {
    const float incidence = dot(point.normal, to) * scale;
    const float arriving_cosine = point.front_only ? incidence : std::abs(incidence);
    if (is_beyond(arriving_cosine, 0, ball)) return 0;
    arriving = mean_cosine(incidence, ball, arriving_cosine);
    if (!point.front_only) arriving += positive_part(-incidence, ball);
  }
  const float nearest = std::max(square, kPartOfRadius * node.radius * node.radius);
  return std::max(node.power / std::max(nearest, kLeastImportance) * leaving * arriving, kLeastImportance);
}

double LightTree::left_probability(std::uint32_t node, const LightPoint& point) const {
  const Node &left = nodes_[node + 1], &right = nodes_[nodes_[node].next];
  double a = node_importance(left, point), b = node_importance(right, point);
  // If none can light the point, and where floats overflow.
  if (!(a + b > 0) || !std::isfinite(a + b)) a = left.power, b = right.power;
  const double left_part = a / (a + b);
  // Powers whose sum is infinite.
  if (std::isnan(left_part)) return 0.5;
  return a > 0 && b > 0 ? std::clamp(left_part, kLeastProbability, 1 - kLeastProbability) : left_part;
}

std::optional<LightTree::Choice> LightTree::choose(const LightPoint& point, double u) const {
  if (nodes_.empty()) return std::nullopt;
  double probability = 1;
  std::uint32_t node = 0;
  while (!nodes_[node].leaf) {
    const double left = left_probability(node, point);
    if (u < left) {
      u = u / left;
      probability *= left;
      ++node;
    } else {
      u = (u - left) / (1 - left);
      probability *= 1 - left;
      node = nodes_[node].next;
    }
    // Rounding may give 1, where a child of probability 0 would be chosen.
    u = std::min(u, 1 - 0x1p-53);
  }
  return Choice{nodes_[node].next, probability};
}

double LightTree::probability(const LightPoint& point, std::uint32_t index) const {
  double probability = 1;
  std::uint32_t node = 0;
  for (std::uint64_t trail = trails_[index]; !nodes_[node].leaf; trail >>= 1) {
    const double left = left_probability(node, point);
    probability *= trail & 1 ? 1 - left : left;
    node = trail & 1 ? nodes_[node].next : node + 1;
  }
  return probability;
}

double LightTree::importance(const LightPoint& point) const {
  return nodes_.empty() ? 0 : node_importance(nodes_[0], point);
}

}  // namespace oktett
