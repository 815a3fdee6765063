#pragma once
/// \file A ray's way into an instance: transformed in double, its direction not normalised, so that t means
/// the same inside.

#include "accel/accel_data.h"
#include "kernels/lanes.h"

namespace oktett {

template <int W, class A>
OKTETT_INLINE void transform_rays(const InstanceItem& instance, const RayLanes<Simd<float, W, A>>& ray,
                                  Vec3<Simd<float, W, A>>& o, Vec3<Simd<float, W, A>>& d) {
  using D = Simd<double, W, A>;
  const Vec3<D> od = to_double(ray.o), dd = to_double(ray.d);
  const auto linear = [&](int k, const Vec3<D>& v) {
    const double* m = instance.to_child + 4 * k;
    return (D(m[0]) * v.x + D(m[1]) * v.y) + D(m[2]) * v.z;
  };
  const auto point = [&](int k) { return to_float(linear(k, od) + D(instance.to_child[4 * k + 3])); };
  o = {point(0), point(1), point(2)};
  d = {to_float(linear(0, dd)), to_float(linear(1, dd)), to_float(linear(2, dd))};
}

/// The path, in the structure that holds the instance, of a hit whose path inside the child is `child_path`.
OKTETT_INLINE std::uint32_t outer_path(const InstanceItem& instance, std::uint32_t child_path) {
  return instance.first_path + (child_path + 1);
}

}  // namespace oktett
