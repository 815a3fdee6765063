#pragma once
/// \file A tree over many emitters that chooses one by how much light it may bring to a point.
///
/// Conty and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting", as in section
/// 12.6.3 of Pharr, Jakob, Humphreys 2023, "Physically Based Rendering", without splitting at run time.
/// Departs in these points:
/// - A node has up to four children, and bounds emitters by spheres.
/// - The importance of a node estimates the mean of the cosines over its emitters, where the papers take
///   their upper bounds. It is 0 only where these are. Beside many lamps, that and the four children make
///   the variance of a choice ten times smaller.
/// - The build estimates the spread of normals from their mean.
/// - Where no child can light the point the choice goes on by power, so that the probabilities of all
///   emitters sum to 1.
/// - Two random numbers take turns, by the axis along which a node divides its emitters. So points spread
///   evenly over a square choose emitters spread evenly over a ceiling, as one large panel would be sampled.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/light/light_bounds.h"
#include "render/light/light_quad.h"
#include "render/light/light_sample.h"
#include "render/sampling/square_sample.h"

namespace oktett {

class LightTree {
 public:
  LightTree() = default;
  /// The power of each emitter must be > 0 and all numbers finite. Deterministic. Throws Error beyond 2^27
  /// emitters.
  explicit LightTree(std::span<const LightBounds> emitters);

  struct Choice {
    std::uint32_t index;  ///< into the emitters that were given
    double probability;   ///< > 0
  };

  bool empty() const { return quads_.empty(); }
  std::size_t size() const { return slots_.size(); }  ///< emitters
  std::size_t bytes() const {
    return quads_.size() * (sizeof(LightQuad) + sizeof(parents_[0])) + slots_.size() * sizeof(slots_[0]);
  }

  /// Chooses an emitter by the numbers `s` in [0, 1), which together should have as many random bits as there
  /// are emitters and more. What they leave is spread evenly over [0, 1) again, for a place on the emitter.
  /// Nothing if the tree is empty.
  std::optional<Choice> choose(const LightPoint& point, SquareSample& s) const;

  /// The probability with which choose() answers `index`; never 0 for an emitter that can light the point.
  double probability(const LightPoint& point, std::uint32_t index) const;

  /// About the irradiance that all emitters together bring to the point if nothing is in between. An empty
  /// tree gives 0.
  double importance(const LightPoint& point) const;

  /// Depth first. For code that chooses for many points at once.
  std::span<const LightQuad> quads() const { return quads_; }

 private:
  static constexpr std::uint32_t kRoot = 0xffffffffu;
  static constexpr std::uint32_t kDeepest = 64;  ///< greatest number of quads from the root to an emitter

  class Builder;

  std::vector<LightQuad> quads_;        ///< depth first
  std::vector<std::uint32_t> parents_;  ///< per quad: number of the parent times 4, plus the lane; kRoot
  std::vector<std::uint32_t> slots_;    ///< per emitter: its quad times 4, plus its lane
};

/// Code of an instruction set that chooses for points as LightTree::choose does, with the same bits. The tree
/// must not be empty.
using ChooseLights = void (*)(const LightTree&, std::span<const LightPoint>, SquareSample*,
                              LightTree::Choice*);

}  // namespace oktett
