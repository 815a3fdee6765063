#include "render/light/light_set.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace oktett {

/// Where there are emitters with a place and others, both are chosen at least this often.
static constexpr double kLeastShare = 1 / 8.0;

/// Whether rays that leave the scene meet the emitter.
static bool seen_at_infinity(const Emitter& emitter) {
  if (const auto* e = std::get_if<EnvironmentEmitter>(&emitter)) return e->map != nullptr;
  if (const auto* e = std::get_if<DirectionalEmitter>(&emitter))
    return e->angle > 0 && distant_irradiance(emitter) > 0;
  return false;
}

LightSet::LightSet(std::vector<Emitter> emitters)
    : emitters_(std::move(emitters)), in_tree_(emitters_.size(), kNever) {
  std::vector<LightBounds> bounds;
  double sum = 0;
  for (std::uint32_t i = 0; i < emitters_.size(); ++i) {
    if (const auto b = light_bounds(emitters_[i])) {
      in_tree_[i] = static_cast<std::uint32_t>(placed_.size());
      placed_.push_back(i);
      bounds.push_back(*b);
    } else if (const double irradiance = distant_irradiance(emitters_[i]); irradiance > 0) {
      distant_.push_back(i);
      distant_sums_.push_back(sum += irradiance);
    }
    if (seen_at_infinity(emitters_[i])) visible_.push_back(i);
  }
  tree_ = LightTree(bounds);
}

double LightSet::tree_probability(const LightPoint& point) const {
  if (tree_.empty()) return 0;
  if (distant_.empty()) return 1;
  const double near = tree_.importance(point), share = near / (near + distant_sums_.back());
  // If both are infinite.
  if (std::isnan(share)) return 0.5;
  return std::clamp(share, kLeastShare, 1 - kLeastShare);
}

std::optional<LightSample> LightSet::sample(const LightPoint& point, double choice,
                                            const SquareSample& s) const {
  if (empty()) return std::nullopt;
  const double of_tree = tree_probability(point);
  if (choice < of_tree) {
    const auto chosen = tree_.choose(point, choice / of_tree);
    if (!chosen) return std::nullopt;
    const std::uint32_t emitter = placed_[chosen->index];
    auto sample = sample_emitter(emitters_[emitter], point, s);
    if (!sample) return std::nullopt;
    sample->emitter = emitter;
    sample->pdf = static_cast<float>(sample->pdf * chosen->probability * of_tree);
    return sample->pdf > 0 ? sample : std::nullopt;
  }
  const double total = distant_sums_.back(), place = (choice - of_tree) / (1 - of_tree) * total;
  const auto found = std::upper_bound(distant_sums_.begin(), distant_sums_.end() - 1, place);
  const std::uint32_t emitter = distant_[found - distant_sums_.begin()];
  auto sample = sample_emitter(emitters_[emitter], point, s);
  if (!sample) return std::nullopt;
  sample->emitter = emitter;
  if (sample->delta) {
    sample->pdf = static_cast<float>(probability(point, emitter));
  } else if (visible_.size() > 1) {
    sample->radiance = environment_radiance(sample->direction);
    sample->pdf = environment_pdf(point, sample->direction);
  } else {
    sample->pdf = static_cast<float>(sample->pdf * probability(point, emitter));
  }
  return sample->pdf > 0 ? sample : std::nullopt;
}

double LightSet::probability(const LightPoint& point, std::uint32_t emitter) const {
  if (in_tree_[emitter] != kNever)
    return tree_probability(point) * tree_.probability(point, in_tree_[emitter]);
  const auto found = std::lower_bound(distant_.begin(), distant_.end(), emitter);
  if (found == distant_.end() || *found != emitter) return 0;
  return (1 - tree_probability(point)) * distant_irradiance(emitters_[emitter]) / distant_sums_.back();
}

float LightSet::pdf(const LightPoint& point, std::uint32_t emitter, const Vec3f& direction,
                    float distance) const {
  const float pdf = emitter_pdf(emitters_[emitter], point, direction, distance);
  return pdf > 0 ? static_cast<float>(pdf * probability(point, emitter)) : 0;
}

Color LightSet::environment_radiance(const Vec3f& direction) const {
  Color sum;
  for (const std::uint32_t emitter : visible_) sum += infinite_radiance(emitters_[emitter], direction);
  return sum;
}

float LightSet::environment_pdf(const LightPoint& point, const Vec3f& direction) const {
  double sum = 0;
  for (const std::uint32_t emitter : visible_)
    if (const float pdf = emitter_pdf(emitters_[emitter], point, direction, 0); pdf > 0)
      sum += pdf * probability(point, emitter);
  return static_cast<float>(sum);
}

}  // namespace oktett
