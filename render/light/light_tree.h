#pragma once
/// \file A tree over many emitters that chooses one by how much light it may bring to a point.
///
/// Conty and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting", as in section
/// 12.6.3 of Pharr, Jakob, Humphreys 2023, "Physically Based Rendering", without splitting at run time.
/// Departs in these points:
/// - A node has up to four children, and bounds emitters by spheres.
/// - The importance of a node estimates the mean of the cosines over its emitters, where the papers take
///   their upper bounds. It is 0 only where these are. Beside many emitters, that and the four children make
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

#include "core/box.h"
#include "core/vec3.h"
#include "render/light/light_sample.h"
#include "render/sampling/warp.h"

namespace oktett {

// ---- Bounds of where the light of one or several emitters comes from and where it goes (section 4.1 of
// Conty and Kulla 2018).

/// Each emitter lies in `box`. It has a normal within `spread` of the axis and gives light up to `reach` away
/// from its normal.
struct LightBounds {
  Box box;
  Vec3f axis{0, 0, 1};      ///< unit
  float spread = 0;         ///< radians, [0, pi]
  float reach = 0;          ///< radians, [0, pi / 2]
  bool both_sides = false;  ///< the same light goes to the side opposite to each normal
  /// Sum of radiance times area, in W / sr. Things that are not flat count as made of small pieces with
  /// normals in the cone, see lit_part.
  float power = 0;
};

/// About the mean cosine, none taken below 0, between the axis of a cone of normals and the normals.
double lit_part(double spread);

/// Bounds of the emitters of both.
LightBounds join(const LightBounds& a, const LightBounds& b);

// ---- The tree.

/// A node: bounds of the emitters below each of up to four children, and the order in which a choice among
/// the children is made.
///
/// The children stand in a row. A choice halves the row up to three times, each time at the boundary between
/// two neighbours, until one child is left. It uses one of two random numbers each time, so that points
/// spread evenly over a square are spread evenly over emitters that lie in a plane.
///
/// A child that is missing has power 0; those that are there come first.
struct alignas(64) LightQuad {
  static constexpr std::uint32_t kLanes = 4, kDecisions = 3;

  float center[3][kLanes];
  float radius[kLanes];
  float axis[3][kLanes];
  float cos_spread[kLanes];
  float sin_spread[kLanes];  ///< 1 beyond a right angle
  float cos_limit[kLanes];   ///< of the widest angle between axis and light
  float power[kLanes];       ///< of LightBounds, below 0 if that is true of `both_sides`
  /// Bit 0: kLeaf. Bits 1 to 27: the number of the quad or, of a leaf, of the emitter.
  /// Bits 28 and 29 of child k: the boundary of decision k, which is the number of the child behind it; 0 if
  /// there is no such decision. Bit 30: which random number decides.
  std::uint32_t child[kLanes];

  static constexpr std::uint32_t kLeaf = 1, kMostNumbers = 1u << 27;

  static constexpr std::uint32_t number(std::uint32_t child) { return child >> 1 & (kMostNumbers - 1); }
  std::uint32_t boundary(std::uint32_t decision) const { return child[decision] >> 28 & 3; }
  std::uint32_t dimension(std::uint32_t decision) const { return child[decision] >> 30 & 1; }
};
static_assert(sizeof(LightQuad) == 192);

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
