#include "render/light/light_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {

/// Light leaves and arrives up to this much, in cosines, beyond what the bounds say. It covers the rounding
/// of sines by sine_of, which is below 6e-4 each.
static constexpr float kLeastCosine = 4e-3f;

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
  node.cos_reach = stored_cosine(bounds.reach);
  node.both_sides = bounds.both_sides;
  return node;
}

static float sine_of(float cosine) { return std::sqrt(std::max(0.0f, (1 - cosine) * (1 + cosine))); }

namespace {

/// An angle in [0, pi].
struct Angle {
  float cosine, sine;

  /// max(0, this - b)
  Angle reduced_by(const Angle& b) const {
    if (cosine >= b.cosine) return {1, 0};
    return {cosine * b.cosine + sine * b.sine, sine * b.cosine - cosine * b.sine};
  }
};

}  // namespace

float LightTree::node_importance(const Node& node, const LightPoint& point) {
  const Vec3f to = node.center - point.position;
  const float square = dot(to, to), radius_square = node.radius * node.radius;
  // Inside the sphere light may come from any direction.
  if (!(square > radius_square * (1 + 1e-5f)))
    return std::max(node.power / std::max(radius_square, 1e-30f), kLeastImportance);
  const float distance = std::sqrt(square), sine = node.radius / distance;
  const Angle ball{sine_of(sine), sine};

  const Vec3f axis = decode_axis(node.axis);
  float cosine = -dot(axis, to) / (std::sqrt(dot(axis, axis)) * distance);
  if (node.both_sides) cosine = std::abs(cosine);
  const float cos_spread = cosine_of(node.cos_spread);
  const Angle leaving =
      Angle{cosine, sine_of(cosine)}.reduced_by({cos_spread, sine_of(cos_spread)}).reduced_by(ball);
  if (leaving.cosine < cosine_of(node.cos_reach) - kLeastCosine) return 0;
  const float importance = node.power / square * std::max(leaving.cosine, kLeastCosine);

  if (point.normal == Vec3f{}) return std::max(importance, kLeastImportance);
  float incidence = dot(point.normal, to) / distance;
  if (!point.front_only) incidence = std::abs(incidence);
  const Angle arriving = Angle{incidence, sine_of(incidence)}.reduced_by(ball);
  if (arriving.cosine < -kLeastCosine) return 0;
  return std::max(importance * std::max(arriving.cosine, kLeastCosine), kLeastImportance);
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
