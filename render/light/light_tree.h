#pragma once
/// \file A tree over many emitters that chooses one by how much light it may bring to a point.
///
/// Conty and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting", as in section
/// 12.6.3 of Pharr, Jakob, Humphreys 2023, "Physically Based Rendering", without splitting at run time.
/// Departs in these points:
/// - A node has up to four children, and bounds emitters by spheres.
/// - The importance of a node estimates the mean of the cosines over its emitters, where the papers take
/// their
///   upper bounds. It is 0 only where these are. Beside many lamps, that and the four children make the
///   variance of a choice ten times smaller.
/// - The build estimates the spread of normals from their mean.
/// - Where no child can light the point the choice goes on by power, so that the probabilities of all
/// emitters
///   sum to 1.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/light/light_bounds.h"
#include "render/light/light_sample.h"

namespace oktett {

class LightTree {
 public:
  LightTree() = default;
  /// The power of each emitter must be > 0 and all numbers finite; at most 2^28 emitters. Deterministic.
  explicit LightTree(std::span<const LightBounds> emitters);

  struct Choice {
    std::uint32_t index;  ///< into the emitters that were given
    double probability;   ///< > 0
  };

  bool empty() const { return quads_.empty(); }
  std::size_t bytes() const {
    return quads_.size() * (sizeof(Quad) + sizeof(parents_[0])) + slots_.size() * sizeof(slots_[0]);
  }

  /// Chooses an emitter by the number `u` in [0, 1), which should have as many random bits as there are
  /// emitters and more. Nothing if the tree is empty.
  std::optional<Choice> choose(const LightPoint& point, double u) const;

  /// The same for many points, with the same answers, side by side: a processor works on the steps of several
  /// points at once. The tree must not be empty.
  void choose(std::span<const LightPoint> points, const double* u, Choice* out) const;

  /// The probability with which choose() answers `index`; never 0 for an emitter that can light the point.
  double probability(const LightPoint& point, std::uint32_t index) const;

  /// About the irradiance that all emitters together bring to the point if nothing is in between. An empty
  /// tree gives 0.
  double importance(const LightPoint& point) const;

 private:
  static constexpr std::uint32_t kLanes = 4;

  /// A node: bounds of the emitters below each of its children. A child that is missing has power 0.
  struct alignas(64) Quad {
    float center[3][kLanes];
    float radius[kLanes];
    float axis[3][kLanes];
    float cos_spread[kLanes];
    float sin_spread[kLanes];  ///< 1 beyond a right angle
    float cos_limit[kLanes];   ///< of the widest angle between axis and light
    float power[kLanes];
    std::uint32_t child[kLanes];  ///< its number of quad or emitter, times 4, plus kLeaf and kBothSides
  };
  static_assert(sizeof(Quad) == 192);

  static constexpr std::uint32_t kLeaf = 1, kBothSides = 2, kRoot = 0xffffffffu;
  static constexpr std::uint32_t kDeepest = 64;  ///< greatest number of quads from the root to an emitter

  /// What the choice among the children of a quad goes by; 0 for children that cannot light the point.
  struct Importances {
    float lane[kLanes];
    double sum() const;
  };

  class Builder;

  /// A choice on its way down.
  struct Walk {
    std::uint32_t child = 0;  ///< a quad, or where kLeaf is set the emitter chosen
    double u, probability = 1;
  };
  void step(const LightPoint& point, Walk& walk) const;

  static Importances importances(const Quad& quad, const LightPoint& point);
  /// The same such that the sum is > 0 and finite, and no part of it but 0 is very small.
  static Importances weights(const Quad& quad, const LightPoint& point);

  std::vector<Quad> quads_;             ///< depth first
  std::vector<std::uint32_t> parents_;  ///< per quad: number of the parent times 4, plus the lane; kRoot
  std::vector<std::uint32_t> slots_;    ///< per emitter: its quad times 4, plus its lane
};

}  // namespace oktett
