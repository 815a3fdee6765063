#pragma once
/// \file Choices of emitters of a LightTree for many points, for one instruction set.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/four.h"
#include "core/simd.h"
#include "core/simd_memory.h"
#include "core/simd_native.h"
#include "render/light/light_tree.h"
#include "render/light/light_tree_lanes.h"

namespace oktett {

/// Points whose quads are looked at in the lanes of one register.
template <class A>
inline constexpr int kLightPoints = 1;
template <>
inline constexpr int kLightPoints<Avx2Isa> = 2;
template <>
inline constexpr int kLightPoints<Avx512Isa> = 4;

/// Walks down the tree, several at a time: a processor works on the steps of several points at once. Where a
/// walk ends, that of the next point begins.
template <class A>
class LightChooser {
 public:
  LightChooser(const LightTree& tree, std::span<const LightPoint> points, SquareSample* s,
               LightTree::Choice* out)
      : quads_(tree.quads().data()), points_(points), s_(s), out_(out) {}

  void run() {
    while (count_ < kMost && next_ < points_.size()) begin(count_++);
    while (count_ > 0) {
      for (std::size_t i = 0; i < count_; i += K) look_from(i);
      for (std::size_t i = 0; i < count_; i += kDoubleLanes<A>)
        choose_children<kDoubleLanes<A>, A>(walks_, i);
      for (std::size_t i = count_; i-- > 0;) {
        const LightQuad& quad = quads_[LightQuad::number(walks_.child[i])];
        walks_.child[i] = quad.child[static_cast<int>(walks_.chosen[i])];
        if (walks_.child[i] & LightQuad::kLeaf) finish(i);
      }
    }
  }

 private:
  static constexpr std::size_t K = kLightPoints<A>, kMost = 16;
  static constexpr std::uint32_t kLanes = LightQuad::kLanes;
  // Without an instruction set, the compiler's own vectors are faster than single lanes.
  static constexpr bool kPlain = std::is_same_v<A, ScalarIsa>;
  using F = std::conditional_t<kPlain, Four, Simd<float, K * kLanes, A>>;
  using Q = std::conditional_t<kPlain, Four, Simd<float, kLanes, A>>;

  void begin(std::size_t i) {
    const LightPoint& point = points_[next_];
    walks_.begin(i, s_[next_].x, s_[next_].y);
    const float columns[kColumns] = {point.position.x,
                                     point.position.y,
                                     point.position.z,
                                     point.normal.x,
                                     point.normal.y,
                                     point.normal.z,
                                     point.front_only ? 1.0f : 0.0f,
                                     point.normal != Vec3f{} ? 1.0f : 0.0f};
    for (int c = 0; c < kColumns; ++c) Q(columns[c]).store(columns_[c] + kLanes * i);
    entry_[i] = next_++;
  }

  void finish(std::size_t i) {
    out_[entry_[i]] = {LightQuad::number(walks_.child[i]), walks_.probability[i]};
    s_[entry_[i]] = {walks_.u[0][i], walks_.u[1][i]};
    if (next_ < points_.size()) return begin(i);
    // The last walk takes its place.
    --count_;
    for (auto& u : walks_.u) u[i] = u[count_];
    walks_.probability[i] = walks_.probability[count_], walks_.child[i] = walks_.child[count_];
    entry_[i] = entry_[count_];
    for (auto& column : columns_) Q::load(column + kLanes * count_).store(column + kLanes * i);
  }

  /// The weights of the walks from number `first` on, as many as fit into a register.
  OKTETT_INLINE void look_from(std::size_t first) {
    const LightQuad* quad[K];
    for (std::size_t k = 0; k < K; ++k)
      quad[k] = quads_ + (first + k < count_ ? LightQuad::number(walks_.child[first + k]) : 0);
    const LightQuadLanes<F> q([&](const auto& column) {
      if constexpr (kPlain)
        return F::load(column(*quad[0]));
      else
        return load_pieces<F::kWidth, A>([&](int k) { return column(*quad[k]); });
    });
    const auto load = [&](int c) { return F::load(columns_[c] + kLanes * first); };
    const F zero(0.0f);
    const LightPointLanes<F> p{
        {load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6) > zero, load(7) > zero};
    alignas(64) float importances[K * kLanes];
    light_importances(q, p).store(importances);
    for (std::size_t k = 0; k < K && first + k < count_; ++k)
      walks_.look_at(first + k, *quad[k], LightWeights<Q>(*quad[k], Q::load(importances + kLanes * k)));
  }

  static constexpr int kColumns = 8;

  const LightQuad* const quads_;
  const std::span<const LightPoint> points_;
  SquareSample* const s_;
  LightTree::Choice* const out_;
  std::size_t count_ = 0, next_ = 0;
  LightWalks<kMost> walks_ = {};
  std::size_t entry_[kMost];
  /// Of the walks' points: position, normal, whether only light from the front matters, whether there is a
  /// normal. Each value stands in the four lanes of its quad.
  alignas(64) float columns_[kColumns][kLanes * kMost] = {};
};

template <class A>
void choose_lights_code(const LightTree& tree, std::span<const LightPoint> points, SquareSample* s,
                        LightTree::Choice* out) {
  if (tree.size() == 1) return void(std::fill_n(out, points.size(), LightTree::Choice{0, 1}));
  LightChooser<A>(tree, points, s, out).run();
}

}  // namespace oktett
