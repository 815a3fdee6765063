#pragma once
/// \file A tree over many emitters that chooses one by how much light it may bring to a point.
///
/// Conty and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting", as in section
/// 12.6.3 of Pharr, Jakob, Humphreys 2023, "Physically Based Rendering", without splitting at run time.
/// Departs in these points: a node bounds its emitters by a sphere in floats instead of a quantised box; the
/// weight of an emitter is its peak intensity; the build estimates the spread of normals from their mean; and
/// where no child can light the point the choice goes on by power, so that the probabilities of all emitters
/// sum to 1.

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
  /// The power of each emitter must be > 0 and all numbers finite; at most 2^29 emitters. Deterministic.
  explicit LightTree(std::span<const LightBounds> emitters);

  struct Choice {
    std::uint32_t index;  ///< into the emitters that were given
    double probability;   ///< > 0
  };

  bool empty() const { return nodes_.empty(); }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node) + trails_.size() * sizeof(trails_[0]); }

  /// Chooses an emitter by the number `u` in [0, 1), which should have as many random bits as there are
  /// emitters and more. Nothing if the tree is empty.
  std::optional<Choice> choose(const LightPoint& point, double u) const;

  /// The probability with which choose() answers `index`; never 0 for an emitter that can light the point.
  double probability(const LightPoint& point, std::uint32_t index) const;

  /// About the irradiance that all emitters together bring to the point if nothing is in between. An empty
  /// tree gives 0.
  double importance(const LightPoint& point) const;

 private:
  /// Bounds of the emitters below. The left child of a node follows it in memory.
  struct Node {
    Vec3f center;
    float radius;
    float power;
    std::int16_t axis[2];      ///< octahedral, times 32767
    std::uint16_t cos_spread;  ///< rounded down; see cosine_of in the source
    std::uint16_t cos_limit;   ///< of the widest angle between axis and light, rounded down
    std::uint32_t leaf : 1, both_sides : 1;
    std::uint32_t next : 30;  ///< leaf: index of the emitter; else: the right child
  };
  static_assert(sizeof(Node) == 32);

  class Builder;

  static Node make_node(const LightBounds& bounds);
  static float node_importance(const Node& node, const LightPoint& point);
  /// The probability of the left child of the inner node `node`.
  double left_probability(std::uint32_t node, const LightPoint& point) const;

  std::vector<Node> nodes_;            ///< depth first
  std::vector<std::uint64_t> trails_;  ///< per emitter: bit i says whether step i from the root goes right
};

}  // namespace oktett
