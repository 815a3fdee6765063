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

LightSet::LightSet(std::vector<Emitter> emitters, std::vector<std::uint8_t> lists)
    : emitters_(std::move(emitters)), lists_(std::move(lists)), in_tree_(emitters_.size(), kNever) {
  std::vector<LightBounds> bounds;
  double sum = 0;
  for (std::uint32_t i = 0; i < emitters_.size(); ++i) {
    if (const auto b = light_bounds(emitters_[i])) {
      in_tree_[i] = static_cast<std::uint32_t>(placed_.size());
      placed_.push_back(i);
      bounds.push_back(*b);
    } else if (const double irradiance = distant_irradiance(emitters_[i]); irradiance > 0) {
      distant_.push_back(i), distant_irradiances_.push_back(irradiance);
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

LightSet::Choice LightSet::choose_distant(double of_tree, double choice) const {
  const double total = distant_sums_.back(), place = (choice - of_tree) / (1 - of_tree) * total;
  const auto found = std::upper_bound(distant_sums_.begin(), distant_sums_.end() - 1, place);
  const std::size_t i = found - distant_sums_.begin();
  return {distant_[i], (1 - of_tree) * (distant_irradiances_[i] / total), true};
}

void LightSet::choose(ChooseLights code, std::span<const LightPoint> points, const double* choices,
                      SquareSample* s, Choice* out) const {
  constexpr std::size_t kMost = EnvironmentValues::kMost;
  LightPoint near[kMost];
  SquareSample rest[kMost];
  double of_tree[kMost];
  std::size_t entry[kMost], count = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    out[k] = {0, 0, false};
    if (empty()) continue;
    const double share = tree_probability(points[k]);
    if (!(choices[k] < share))
      out[k] = choose_distant(share, choices[k]);
    else
      near[count] = points[k], rest[count] = s[k], of_tree[count] = share, entry[count++] = k;
  }
  if (count == 0) return;
  LightTree::Choice chosen[kMost];
  code(tree_, {near, count}, rest, chosen);
  for (std::size_t i = 0; i < count; ++i)
    out[entry[i]] = placed(chosen[i], of_tree[i]), s[entry[i]] = rest[i];
}

std::optional<LightSet::Choice> LightSet::choose(const LightPoint& point, double choice,
                                                 SquareSample& s) const {
  if (empty()) return std::nullopt;
  const double share = tree_probability(point);
  return choice < share ? placed(*tree_.choose(point, s), share) : choose_distant(share, choice);
}

std::optional<LightSample> LightSet::sample(const LightPoint& point, const Choice& chosen,
                                            const SquareSample& s) const {
  const Emitter& emitter = emitters_[chosen.emitter];
  auto sample =
      chosen.emitter == point.on ? sample_own_emitter(emitter, point, s) : sample_emitter(emitter, point, s);
  if (!sample) return std::nullopt;
  sample->emitter = chosen.emitter;
  if (chosen.distant && !sample->delta && visible_.size() > 1) {
    sample->radiance = environment_radiance(sample->direction, point.lists);
    sample->pdf = environment_pdf(point, sample->direction);
  } else {
    if (!lights(chosen.emitter, point.lists)) return std::nullopt;
    sample->pdf = static_cast<float>(sample->pdf * chosen.probability);
  }
  return sample->pdf > 0 ? sample : std::nullopt;
}

std::optional<LightSample> LightSet::sample(const LightPoint& point, double choice,
                                            const SquareSample& s) const {
  SquareSample rest = s;
  const auto chosen = choose(point, choice, rest);
  return chosen ? sample(point, *chosen, rest) : std::nullopt;
}

double LightSet::distant_probability(std::uint32_t emitter) const {
  const auto found = std::lower_bound(distant_.begin(), distant_.end(), emitter);
  if (found == distant_.end() || *found != emitter) return 0;
  return distant_irradiances_[found - distant_.begin()] / distant_sums_.back();
}

double LightSet::probability(const LightPoint& point, std::uint32_t emitter) const {
  if (in_tree_[emitter] != kNever)
    return tree_probability(point) * tree_.probability(point, in_tree_[emitter]);
  return (1 - tree_probability(point)) * distant_probability(emitter);
}

float LightSet::pdf(const LightPoint& point, std::uint32_t emitter, const Vec3f& direction,
                    float distance) const {
  const float pdf = emitter == point.on ? own_emitter_pdf(emitters_[emitter])
                                        : emitter_pdf(emitters_[emitter], point, direction, distance);
  return pdf > 0 ? static_cast<float>(pdf * probability(point, emitter)) : 0;
}

Color LightSet::environment_radiance(const Vec3f& direction, std::uint16_t lists) const {
  Color sum;
  for (const std::uint32_t emitter : visible_)
    if (lights(emitter, lists)) sum += infinite_radiance(emitters_[emitter], direction);
  return sum;
}

float LightSet::environment_pdf(const LightPoint& point, const Vec3f& direction) const {
  const double of_distant = 1 - tree_probability(point);
  double sum = 0;
  for (const std::uint32_t emitter : visible_)
    if (const float pdf = emitter_pdf(emitters_[emitter], point, direction, 0); pdf > 0)
      sum += pdf * (of_distant * distant_probability(emitter));
  return static_cast<float>(sum);
}

void LightSet::environment_values(const MapCode& code, std::size_t count, const LightPoint* points,
                                  const float* const (&direction)[3], EnvironmentValues& out) const {
  constexpr std::size_t kMost = EnvironmentValues::kMost;
  double sums[kMost] = {}, of_distant[kMost];
  std::fill_n(&out.radiance[0][0], 3 * kMost, 0.0f);
  for (std::size_t k = 0; k < count; ++k)
    of_distant[k] = points != nullptr ? 1 - tree_probability(points[k]) : 0;
  for (const std::uint32_t emitter : visible_) {
    const double probability = distant_probability(emitter);
    const auto add = [&](std::size_t k, const Color& radiance, float pdf) {
      if (points == nullptr || lights(emitter, points[k].lists))
        for (int axis = 0; axis < 3; ++axis) out.radiance[axis][k] += radiance[axis];
      if (pdf > 0) sums[k] += pdf * (of_distant[k] * probability);
    };
    if (const auto* e = std::get_if<EnvironmentEmitter>(&emitters_[emitter])) {
      float radiance[3][kMost], pdf[kMost];
      code.values(e->map->tables(), count, direction, {radiance[0], radiance[1], radiance[2]}, pdf);
      for (std::size_t k = 0; k < count; ++k)
        add(k, {radiance[0][k], radiance[1][k], radiance[2][k]}, pdf[k]);
      continue;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3f d{direction[0][k], direction[1][k], direction[2][k]};
      add(k, infinite_radiance(emitters_[emitter], d), emitter_pdf(emitters_[emitter], {}, d, 0));
    }
  }
  for (std::size_t k = 0; k < count; ++k) out.pdf[k] = static_cast<float>(sums[k]);
}

}  // namespace oktett
