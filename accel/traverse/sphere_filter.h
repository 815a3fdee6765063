#pragma once
/// \file Rays side by side against spheres in float, before the test in double.

#include "core/lanes.h"
#include "kernels/closed/sphere.h"

namespace oktett {

/// Tells which rays may meet a sphere. Those that are left out pass its centre at more than its radius; the
/// bounds on the rounding errors are derived in docs/numerics.md. The exact test takes about three times as
/// many steps, on half as many lanes.
template <class F>
class SphereFilter {
 public:
  /// Eight spheres, rounded.
  struct Spheres {
    static constexpr int kSize = 8;
    alignas(32) float x[kSize], y[kSize], z[kSize];
    alignas(32) float reach[kSize];  ///< square of the radius, and slack for the rounded centre

    /// Spheres `first` ... of the pool.
    OKTETT_INLINE void set(const Sphere::Pool& pool, std::size_t first) {
      using D = Simd<double, kSize, typename F::Isa>;
      const Sphere::Lanes<D> s = Sphere::load<D>(pool, first);
      const Vec3<D>& c = s.center;
      to_float(c.x).store(x), to_float(c.y).store(y), to_float(c.z).store(z);
      to_float(s.radius * s.radius * D(1 + 0x1p-20) + dot_lanes(c, c) * D(kSlack) + D(kLeastSlack))
          .store(reach);
    }
  };

  OKTETT_INLINE explicit SphereFilter(const RayLanes<F>& ray) : o_(ray.o), d_(ray.d) {
    const F square = fast_dot(d_, d_);
    inverse_ = F(1.0f) / square;
    // Outside of these limits the quotient is not exact enough, so no ray is left out.
    const auto tame = (F(0x1p-100f) <= square) & (square <= F(0x1p100f));
    slack_ = select(tame, fast_dot(o_, o_) * F(kSlack), F(std::numeric_limits<float>::infinity()));
  }

  /// The rays that may meet sphere `k`, as bits.
  OKTETT_INLINE unsigned may_meet(const Spheres& s, int k) const {
    const Vec3<F> m{F(s.x[k]) - o_.x, F(s.y[k]) - o_.y, F(s.z[k]) - o_.z};
    const F closest = fast_dot(m, d_) * inverse_;
    const Vec3<F> miss{fast_fma(-closest, d_.x, m.x), fast_fma(-closest, d_.y, m.y),
                       fast_fma(-closest, d_.z, m.z)};
    // NaN is not left out.
    return ~bits(slack_ + F(s.reach[k]) < fast_dot(miss, miss));
  }

 private:
  /// Bound on the error of the squared distance, relative to the squares of the origin and of the centre.
  static constexpr float kSlack = 0x1p-16f;
  static constexpr float kLeastSlack = 0x1p-66f;  ///< for products that underflow

  Vec3<F> o_, d_;
  F inverse_, slack_;
};

}  // namespace oktett
