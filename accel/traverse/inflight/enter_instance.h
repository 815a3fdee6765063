#pragma once
/// \file Rays in flight go into instances and out again. A ray in an instance is the transformed ray in the
/// child's tree, with the distances of the ray outside, because directions are not normalised. So what the
/// ray has on its stack, what it has hit and where it ends stay valid on both sides.

#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/single.h"

namespace oktett {

/// Prefetches the memory that describes the instance that the ray goes into, if it goes into one.
OKTETT_INLINE void prefetch_instance(const Accel& accel, const InflightRay& ray) {
  if (ray.in.instance != kNoInstance) return;
  const LeafEntry& leaf = accel.leaves[ray.current.table_index()];
  if (leaf.kind == Kind::instance_list) __builtin_prefetch(&accel.listed_instances[leaf.begin]);
  if (leaf.kind != Kind::instance) return;
  const InstanceItem& instance = accel.instances[leaf.begin];
  __builtin_prefetch(&instance), __builtin_prefetch(&instance.child);
}

/// Takes the ray out of its instance; `outer` is what it was outside, `accel` holds the instance.
OKTETT_INLINE void leave_instance(InflightRay& ray, const InflightHead& outer, const Accel& accel) {
  const InflightHead inside = ray;
  static_cast<InflightHead&>(ray) = outer;
  ray.set_end(inside.tmax);
  ray.hit_lo = inside.hit_lo, ray.candidate = inside.candidate, ray.has_state = inside.has_state;
  ray.size = inside.size;
  ray.in.set(accel);
}

/// Rays that go into an instance each, and are transformed together, one in each lane.
template <int W, class A>
class EnteringRays {
 public:
  int size() const { return size_; }
  InflightRay& ray(int i) const { return *ray_[i]; }

  /// Adds a ray that goes into instance `number` of `accel`; `outer` is the ray outside. Returns true if
  /// there is no room for another.
  OKTETT_INLINE bool add(InflightRay& ray, const InflightHead& outer, std::uint32_t number,
                         const Accel& accel) {
    const int i = size_++;
    ray_[i] = &ray, number_[i] = number;
    for (int k = 0; k < 3; ++k) o_[k][i] = outer.o[k], d_[k][i] = outer.d[k];
    tmin_[i] = ray.tmin, tmax_[i] = ray.tmax, slack_[i] = outer.slack;
    with_instance(accel, number, [&](const auto& instance, const Accel& child) {
      for (int k = 0; k < 12; ++k) to_child_[k][i] = static_cast<double>(instance.to_child[k]);
      for (int k = 0; k < 3; ++k) lo_[k][i] = child.bounds.lo[k], hi_[k][i] = child.bounds.hi[k];
      child_[i] = &child;
    });
    return size_ == W;
  }

  /// Takes the rays into their instances and calls enter(ray, root) for each. For rays that miss the bounds
  /// of what is inside, it calls miss(ray). Where a ray is not tame inside, where its stack might overflow,
  /// or where there are unbounded shapes, it calls stay(ray, number).
  template <class Enter, class Miss, class Stay>
  OKTETT_INLINE void go(const Accel& accel, Enter&& enter, Miss&& miss, Stay&& stay) {
    for (int i = size_; i < W; ++i) repeat_first(i);
    const auto vec = [](const float(&v)[3][W]) {
      return Vec3<F>{F::load(v[0]), F::load(v[1]), F::load(v[2])};
    };
    RayLanes<F> rays{vec(o_), vec(d_), F::load(tmin_), F::load(tmax_)};
    const RayLanes<F> outer = rays;
    transform_rays(*this, outer, rays.o, rays.d);
    const Vec3<F> lo = vec(lo_), hi = vec(hi_);
    chunk_.set(rays, (1u << size_) - 1, extent_of(lo, hi));
    const unsigned met = chunk_.meets(lo, hi);
    for (int i = 0; i < size_; ++i) {
      InflightRay& ray = *ray_[i];
      const Accel& child = *child_[i];
      if (OKTETT_UNLIKELY((chunk_.tame >> i & 1) == 0 || !child.unbounded.empty() ||
                          accel.stats.depth + child.stats.depth > kMaxDepth)) {
        stay(ray, number_[i]);
        continue;
      }
      if ((met >> i & 1) == 0) {
        miss(ray);
        continue;
      }
      set_lines(ray, chunk_, i);
      // The entries of the stack that were pushed outside must not be removed too early.
      ray.slack = std::max(ray.slack, slack_[i]);
      ray.set_end(ray.tmax);
      ray.in.accel = &child, ray.in.bytes = TreeBytes(child), ray.in.instance = number_[i];
      ray.push(NodeRef::way_out(), -1);
      enter(ray, child.root);
    }
    size_ = 0;
  }

  /// Entry k of the maps into the children, for transform_rays().
  OKTETT_INLINE Simd<double, W, A> map_entry(int k) const { return Simd<double, W, A>::load(to_child_[k]); }

 private:
  using F = Simd<float, W, A>;

  /// The greatest |coordinate| of a box each.
  static OKTETT_INLINE F extent_of(const Vec3<F>& lo, const Vec3<F>& hi) {
    const auto axis = [](const F& a, const F& b) { return max(abs(a), abs(b)); };
    return max(axis(lo.x, hi.x), max(axis(lo.y, hi.y), axis(lo.z, hi.z)));
  }

  OKTETT_INLINE void repeat_first(int i) {
    for (int k = 0; k < 3; ++k) o_[k][i] = o_[k][0], d_[k][i] = d_[k][0];
    tmin_[i] = tmin_[0], tmax_[i] = tmax_[0];
    for (int k = 0; k < 3; ++k) lo_[k][i] = lo_[k][0], hi_[k][i] = hi_[k][0];
    for (auto& row : to_child_) row[i] = row[0];
  }

  int size_ = 0;
  alignas(64) float o_[3][W], d_[3][W], tmin_[W], tmax_[W], slack_[W], lo_[3][W], hi_[3][W];
  alignas(64) double to_child_[12][W];
  InflightRay* ray_[W];
  const Accel* child_[W];
  std::uint32_t number_[W];
  RayChunk<W, A> chunk_;
};

}  // namespace oktett
