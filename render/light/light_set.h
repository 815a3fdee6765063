#pragma once
/// \file All lights of a scene: chooses one of them, and a direction to it.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/light/emitter.h"
#include "render/light/light_sample.h"
#include "render/light/light_tree.h"
#include "render/sampling/warp.h"

namespace oktett {

/// Code of an instruction set that looks up directions, given as columns, in environment maps.
struct MapCode {
  void (*values)(const EnvironmentTables&, std::size_t count, const float* const (&direction)[3],
                 float* const (&radiance)[3], float* pdf);
};

/// Light and densities of up to kMost directions.
struct EnvironmentValues {
  static constexpr std::size_t kMost = 64;
  float radiance[3][kMost], pdf[kMost];
};

/// Emitters that have a place are chosen by a LightTree. The others (directional light, environments and
/// points without falloff) are few; each is chosen by its irradiance. Emitters that give no light, have no
/// area or hold a number that is infinite or NaN are never chosen.
///
/// Infinite emitters that are not delta lights are seen by rays that leave the scene. They overlap: a sample
/// of one has the radiance of all of them and the density of all of them together, as have
/// environment_radiance and environment_pdf.
class LightSet {
 public:
  LightSet() = default;
  /// `lists`: of each emitter the list of points that it lights, by LightPoint::lists; kNoLightList for all,
  /// and empty if all do. What an emitter does not light it may still be chosen for: that counts as black.
  explicit LightSet(std::vector<Emitter> emitters, std::vector<std::uint8_t> lists = {});

  /// Numbered as they were given.
  const std::vector<Emitter>& emitters() const { return emitters_; }
  /// Whether light of the emitter reaches points of these lists.
  bool lights(std::uint32_t emitter, std::uint16_t lists) const {
    return lists_.empty() || list(emitter) == kNoLightList || (lists >> list(emitter) & 1) != 0;
  }
  /// The list of an emitter, or kNoLightList.
  std::uint8_t list(std::uint32_t emitter) const { return lists_.empty() ? kNoLightList : lists_[emitter]; }
  /// True if sample() never finds anything.
  bool empty() const { return tree_.empty() && distant_.empty(); }

  /// A light that may reach the point. `choice` in [0, 1) decides between emitters that have a place and
  /// others, and among these; `s` decides among the former, and for the direction. Nothing if there is no
  /// light, or if the chosen emitter cannot light the point; that happens although others can, and counts as
  /// a sample that is black.
  std::optional<LightSample> sample(const LightPoint& point, double choice, const SquareSample& s) const;

  /// The same in two steps, of which the second may be done for many points together.
  struct Choice {
    std::uint32_t emitter;
    double probability;  ///< of choosing it
    bool distant;        ///< it has no place
  };
  /// What the choice leaves of `s` is spread evenly over the unit square again.
  std::optional<Choice> choose(const LightPoint& point, double choice, SquareSample& s) const;
  /// The same for up to 64 points. Where nothing is chosen the probability is 0.
  void choose(ChooseLights code, std::span<const LightPoint> points, const double* choices, SquareSample* s,
              Choice* out) const;
  std::optional<LightSample> sample(const LightPoint& point, const Choice& chosen,
                                    const SquareSample& s) const;

  /// The density, per solid angle, with which sample() chooses the unit vector `direction` to the point of
  /// emitter number `emitter` at `distance`, for a ray that found the emitter by another way. 0 for delta
  /// lights and for emitters that sample() never chooses. For infinite emitters see environment_pdf.
  float pdf(const LightPoint& point, std::uint32_t emitter, const Vec3f& direction, float distance) const;

  /// The probability with which sample() chooses the emitter.
  double probability(const LightPoint& point, std::uint32_t emitter) const;

  /// Radiance of all infinite emitters that are not delta lights and light points of these lists, in the unit
  /// vector `direction` away from a point.
  Color environment_radiance(const Vec3f& direction, std::uint16_t lists = 0xffff) const;
  /// The density, per solid angle, with which sample() chooses `direction` to any infinite emitter.
  float environment_pdf(const LightPoint& point, const Vec3f& direction) const;
  /// Both for up to EnvironmentValues::kMost directions, given as columns, with the same bits. Without
  /// `points` the densities are 0, and all emitters give light.
  void environment_values(const MapCode& code, std::size_t count, const LightPoint* points,
                          const float* const (&direction)[3], EnvironmentValues& out) const;
  /// The numbers of the infinite emitters that are not delta lights.
  const std::vector<std::uint32_t>& visible() const { return visible_; }
  /// Whether infinite emitters overlap, so that samples of one need environment_values.
  bool environment_overlaps() const { return visible_.size() > 1; }

 private:
  /// The probability of choosing the tree.
  double tree_probability(const LightPoint& point) const;

  Choice placed(const LightTree::Choice& chosen, double of_tree) const {
    return {placed_[chosen.index], chosen.probability * of_tree, false};
  }
  Choice choose_distant(double of_tree, double choice) const;
  /// The probability of a distant emitter among these.
  double distant_probability(std::uint32_t emitter) const;

  static constexpr std::uint32_t kNever = 0xffffffffu;

  std::vector<Emitter> emitters_;
  std::vector<std::uint8_t> lists_;  ///< of each emitter; empty if all light all points
  LightTree tree_;
  std::vector<std::uint32_t> placed_;   ///< numbers of the emitters in the tree
  std::vector<std::uint32_t> in_tree_;  ///< per emitter: its number in the tree, or kNever
  std::vector<std::uint32_t> distant_;  ///< numbers of the emitters without place that are chosen
  std::vector<double> distant_irradiances_;
  std::vector<double> distant_sums_;    ///< irradiance of these up to and with each
  std::vector<std::uint32_t> visible_;  ///< numbers of the infinite emitters that are not delta lights
};

}  // namespace oktett
