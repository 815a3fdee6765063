#pragma once
/// \file The candidate hits of finished rays, which are decided together, one in each lane.

#include "accel/traverse/inflight/decide_pairs.h"
#include "accel/traverse/single.h"

namespace oktett {

/// Up to N candidates. `kInstances`: they may be in instances.
template <int N, class A, bool kInstances>
class PendingHits {
 public:
  /// Adds triangle `triangle` = block * TriangleBlock::kSize + lane for ray `ray`, in an instance of that
  /// number or kNoInstance. Returns true if there is no room for another.
  OKTETT_INLINE bool add(std::uint32_t ray, std::uint32_t triangle, std::uint32_t instance) {
    ray_[size_] = ray, triangle_[size_] = triangle;
    if constexpr (kInstances) instance_[size_] = instance;
    return ++size_ == N;
  }

  /// Forgets all.
  void clear() { size_ = 0; }

  /// Decides all for `rays` in `accel` and calls store(ray, hit) for each.
  template <class Store>
  OKTETT_NOINLINE void decide(const Accel& accel, const RaySpan& rays, Store&& store) {
    if (size_ == 0) return;
    alignas(64) float column[8][N];
    const TriangleBlock* block[N];
    std::uint32_t path[N];
    for (int i = 0; i < N; ++i) {
      if (i >= size_) add_again(i);
      Ray ray = rays[ray_[i]];
      if constexpr (kInstances) {
        block[i] = accel.blocks.data(), path[i] = kNoId;
        if (instance_[i] != kNoInstance) ray = go_inside(accel, instance_[i], ray, block[i], path[i]);
        block[i] += triangle_[i] / TriangleBlock::kSize;
      }
      for (int k = 0; k < 3; ++k) column[k][i] = ray.origin[k], column[3 + k][i] = ray.direction[k];
      column[6][i] = ray.tmin, column[7][i] = ray.tmax;
    }
    const auto vec = [&](int k) {
      return Vec3<F>{F::load(column[k]), F::load(column[k + 1]), F::load(column[k + 2])};
    };
    const RayLanes<F> lanes{vec(0), vec(3), F::load(column[6]), F::load(column[7])};
    HitLanes<F> h;
    unsigned met;
    if constexpr (kInstances)
      met = decide_pairs<N, A>(lanes, gather_triangles<N, A>(block, triangle_), h);
    else
      met = decide_pairs<N, A>(lanes, accel.blocks.data(), triangle_, h);
    alignas(64) float t[N], u[N], v[N];
    h.t.store(t), h.u.store(u), h.v.store(v);
    for (int i = 0; i < size_; ++i) {
      const TriangleBlock& b = kInstances ? *block[i] : accel.blocks[triangle_[i] / TriangleBlock::kSize];
      const std::uint32_t item = b.item[triangle_[i] % TriangleBlock::kSize];
      const std::uint32_t instance = kInstances ? path[i] : kNoId;
      store(ray_[i], (met >> i & 1) != 0 ? Hit{t[i], u[i], v[i], item, instance} : Hit{});
    }
    size_ = 0;
  }

 private:
  OKTETT_INLINE void add_again(int i) {
    ray_[i] = ray_[0], triangle_[i] = triangle_[0];
    if constexpr (kInstances) instance_[i] = instance_[0];
  }

  using F = Simd<float, N, A>;

  /// The ray in the space of an instance, with the instance's blocks of triangles and the path of its hits.
  static OKTETT_INLINE Ray go_inside(const Accel& accel, std::uint32_t number, const Ray& ray,
                                     const TriangleBlock*& blocks, std::uint32_t& path) {
    using One = Simd<float, 1, A>;
    const RayLanes<One> outer{broadcast<One>(ray.origin), flush_direction(broadcast<One>(ray.direction)),
                              One(ray.tmin), One(ray.tmax)};
    Ray inside;
    with_instance(accel, number, [&](const auto& instance, const Accel& child) {
      inside = ray_inside<std::decay_t<decltype(instance)>, A>(instance, outer);
      blocks = child.blocks.data(), path = outer_path(instance, kNoId);
    });
    return inside;
  }

  int size_ = 0;
  std::uint32_t triangle_[N], ray_[N], instance_[kInstances ? N : 1];
};

}  // namespace oktett
