#pragma once
/// \file Light samples and look-ups in environment maps for many points, for one instruction set. Columns are
/// up to 64 long; entries up to the end of the last group of lanes are read and written.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include "core/four.h"
#include "core/simd.h"
#include "core/simd_memory.h"
#include "core/simd_native.h"
#include "render/light/emitter_lanes.h"
#include "render/light/light_tree.h"
#include "render/light/light_tree_lanes.h"
#include "render/transport/path_lights.h"

namespace oktett {

// ---- Choices of emitters of a LightTree.

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

// ---- Samples of emitters and look-ups in environment maps. Columns are up to 64 long; entries up to the end
// of the last group of lanes are read and written.

template <class A>
using LightLanes = Simd<double, kDoubleLanes<A>, A>;

template <class A>
void map_values_code(const EnvironmentTables& map, std::size_t count, const float* const (&direction)[3],
                     float* const (&radiance)[3], float* pdf) {
  using F = FloatsOf<LightLanes<A>>;
  for (std::size_t i = 0; i < count; i += F::kWidth) {
    const auto at = map_places(
        map, Vec3<F>{F::load(direction[0] + i), F::load(direction[1] + i), F::load(direction[2] + i)});
    map_radiance(map, at, {radiance[0] + i, radiance[1] + i, radiance[2] + i});
    map_density(map, at, pdf + i);
  }
}

template <class A>
void map_samples_code(const EnvironmentTables& map, LightGroup& group) {
  using D = LightLanes<A>;
  constexpr int W = D::kWidth;
  for (std::size_t i = 0; i < group.count; i += W) {
    const auto s = map_samples(map, D::load(group.x + i), D::load(group.y + i));
    s.direction.x.store(group.direction[0] + i), s.direction.y.store(group.direction[1] + i);
    s.direction.z.store(group.direction[2] + i);
    std::int64_t pixel[W];
    for (int k = 0; k < W; ++k) {
      pixel[k] = std::int64_t{s.row[k]} * map.width + s.column[k];
      group.pdf[i + k] = map.density[pixel[k]];
    }
    if (map.smooth) {
      map_radiance(map, s.place, {group.radiance[0] + i, group.radiance[1] + i, group.radiance[2] + i});
      continue;
    }
    for (int k = 0; k < W; ++k)
      for (int axis = 0; axis < 3; ++axis) group.radiance[axis][i + k] = map.pixels[pixel[k]][axis];
  }
}

template <class D>
OKTETT_INLINE Vec3<D> group_positions(const LightGroup& group, std::size_t i) {
  using F = FloatsOf<D>;
  return to_double(Vec3<F>{F::load(group.position[0] + i), F::load(group.position[1] + i),
                           F::load(group.position[2] + i)});
}

template <class D>
OKTETT_INLINE void store_samples(const LightSamples<D>& s, LightGroup& group, std::size_t i) {
  s.direction.x.store(group.direction[0] + i), s.direction.y.store(group.direction[1] + i);
  s.direction.z.store(group.direction[2] + i);
  s.distance.store(group.distance + i);
  select(s.found, s.pdf, FloatsOf<D>(0.0f)).store(group.pdf + i);
  s.u.store(group.x + i), s.v.store(group.y + i);
}

/// Calls `sample(emitters, i)` for each group of lanes, where `emitters` are the EmitterLanes of the entries
/// from `i` on.
template <class D, class Kind, class Sample>
OKTETT_INLINE void for_groups(const LightGroup& group, const Sample& sample) {
  for (std::size_t i = 0; i < group.count; i += D::kWidth)
    sample(EmitterLanes<D, Kind>{group.emitter + i}, i);
}

template <class A, class Flat>
void flat_samples_code(LightGroup& group) {
  using D = LightLanes<A>;
  for_groups<D, Flat>(group, [&](const auto& emitter, std::size_t i) {
    const auto views = view(emitter, group_positions<D>(group, i));
    store_samples(views.sample(D::load(group.x + i), D::load(group.y + i)), group, i);
  });
}

template <class A>
void sphere_samples_code(LightGroup& group) {
  using D = LightLanes<A>;
  for_groups<D, SphereEmitter>(group, [&](const auto& emitter, std::size_t i) {
    const Vec3<D> to_center = sub_lanes(emitter(&SphereEmitter::center), group_positions<D>(group, i));
    store_samples(sample_spheres(to_center, emitter(&SphereEmitter::radius), D::load(group.x + i),
                                 D::load(group.y + i)),
                  group, i);
  });
}

template <class A>
void point_samples_code(LightGroup& group) {
  using D = LightLanes<A>;
  for_groups<D, LightCone>(group, [&](const auto& cone, std::size_t i) {
    const Vec3<D> to = sub_lanes(cone(&LightCone::position), group_positions<D>(group, i));
    const PointSamples<D> points = sample_points(to, cone(&LightCone::axis), cone(&LightCone::cos_inner),
                                                 cone(&LightCone::cos_outer), cone(&LightCone::falls_off));
    store_samples(points.at, group, i);
    points.scale.store(group.scale + i);
  });
}

template <class A>
void sun_directions_code(LightGroup& group) {
  using D = LightLanes<A>;
  for_groups<D, DirectionalEmitter>(group, [&](const auto& emitter, std::size_t i) {
    const auto towards = to_float(around_lanes(emitter(&DirectionalEmitter::direction),
                                               D::load(group.x + i) * emitter(&DirectionalEmitter::height),
                                               D::load(group.y + i)));
    towards.x.store(group.direction[0] + i), towards.y.store(group.direction[1] + i);
    towards.z.store(group.direction[2] + i);
  });
}

/// The functions above for the set.
template <class A>
LightCode light_code();

}  // namespace oktett
