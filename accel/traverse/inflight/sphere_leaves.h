#pragma once
/// \file Rays in flight against leaves of spheres. What the test takes of a ray is kept in double, so that it
/// need not be converted at each leaf.

#include "accel/traverse/inflight/inflight_queues.h"

namespace oktett {

/// Tests rays in flight against the spheres of a tree. Each ray has one of kInflightRays places, and comes
/// there from a chunk of W rays.
template <int W, class A>
class SphereLeaves {
 public:
  static constexpr int kSpheres = kShapeLanes<Sphere>;
  static_assert(kSpheres == TriangleBlock::kSize, "a leaf is tested at once");

  explicit SphereLeaves(const Accel& accel) : pool_(std::get<Sphere::Pool>(accel.pools)) {}

  /// Prepares the rays of a chunk for start().
  OKTETT_INLINE void prepare(const RayChunk<W, A>& c) {
    using F = Simd<float, W, A>;
    using D = Simd<double, W, A>;
    if (pool_.size() == 0) return;
    const Vec3<D> d{to_double(F::load(c.d[0])), to_double(F::load(c.d[1])), to_double(F::load(c.d[2]))};
    (D(1.0) / dot_lanes(d, d)).store(inverse_);
  }

  /// Puts ray `i` of the chunk at `place`.
  OKTETT_INLINE void start(std::ptrdiff_t place, const RayChunk<W, A>& c, int i) {
    if (pool_.size() == 0) return;
    Line& line = lines_[place];
    for (int k = 0; k < 3; ++k) line.o[k] = c.o[k][i], line.d[k] = c.d[k][i];
    line.tmin = c.tmin[i], line.inverse = inverse_[i];
  }

  /// Returns which spheres of `leaf` the ray at `place` hits, as bits; t[k] is the distance of sphere k. The
  /// ray is in no instance.
  OKTETT_INLINE unsigned meet(std::ptrdiff_t place, const InflightRay& ray, const LeafEntry& leaf,
                              float (&t)[kSpheres]) const {
    using F = Simd<float, kSpheres, A>;
    using D = Simd<double, kSpheres, A>;
    const Line& line = lines_[place];
    const auto tmax = static_cast<double>(ray.tmax);
    const RayLanes<D> wide{{D(line.o[0]), D(line.o[1]), D(line.o[2])},
                           {D(line.d[0]), D(line.d[1]), D(line.d[2])},
                           D(line.tmin),
                           D(tmax)};
    D roots[Sphere::kRoots];
    const auto maybe = Sphere::roots_in_range(wide, D(line.inverse), D(Sphere::last_root(tmax)),
                                              Sphere::load<D>(pool_, leaf.begin), roots);
    if (none(maybe)) return 0;
    const Vec3<F> unused{F(0.0f), F(0.0f), F(0.0f)};
    HitLanes<F> hit;
    const auto met = first_in_range(RayLanes<F>{unused, unused, F(ray.tmin), F(ray.tmax)},
                                    mask_cast<float>(maybe), roots, hit);
    hit.t.store(t);
    return bits(met) & ((2u << (leaf.count - 1)) - 1);
  }

 private:
  struct alignas(64) Line {
    double o[3], d[3], tmin;
    double inverse;  ///< one over the square of the direction
  };

  const Sphere::Pool& pool_;
  alignas(64) double inverse_[W];  ///< of the chunk
  Line lines_[kInflightRays];
};

}  // namespace oktett
