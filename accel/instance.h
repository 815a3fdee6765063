#pragma once
/// \file Rays into instances. They are transformed in double and rounded to float. The direction is not
/// normalised, so t means the same inside.

#include "accel/accel_data.h"
#include "core/lanes.h"

namespace oktett {

/// Origins `o` and directions `d` of rays in the child's space. `Instance` is an InstanceItem or a
/// ListedInstance.
template <class Instance, int W, class A>
OKTETT_INLINE void transform_rays(const Instance& instance, const RayLanes<Simd<float, W, A>>& ray,
                                  Vec3<Simd<float, W, A>>& o, Vec3<Simd<float, W, A>>& d) {
  using D = Simd<double, W, A>;
  const Vec3<D> od = to_double(ray.o), dd = to_double(ray.d);
  const auto linear = [&](int k, const Vec3<D>& v) {
    const auto entry = [&](int j) { return D(static_cast<double>(instance.to_child[4 * k + j])); };
    return (entry(0) * v.x + entry(1) * v.y) + entry(2) * v.z;
  };
  const auto point = [&](int k) {
    return to_float(linear(k, od) + D(static_cast<double>(instance.to_child[4 * k + 3])));
  };
  o = {point(0), point(1), point(2)};
  d = {to_float(linear(0, dd)), to_float(linear(1, dd)), to_float(linear(2, dd))};
}

/// The path, in the structure that holds the instance, of a hit whose path inside the child is `child_path`.
template <class Instance>
OKTETT_INLINE std::uint32_t outer_path(const Instance& instance, std::uint32_t child_path) {
  return instance.first_path + (child_path + 1);
}

/// What an instance of `accel` shows.
OKTETT_INLINE const Accel& child_of(const Accel&, const InstanceItem& instance) { return *instance.child; }
OKTETT_INLINE const Accel& child_of(const Accel& accel, const ListedInstance& instance) {
  return *accel.listed_children[instance.child];
}

/// Calls f(instance, child) for the instances of a leaf until it returns false.
template <class Function>
OKTETT_INLINE void each_instance(const Accel& accel, const LeafEntry& leaf, Function&& f) {
  const auto run = [&](const auto& list) {
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
      if (!f(list[k], child_of(accel, list[k]))) return;
  };
  if (leaf.kind == Kind::instance)
    run(accel.instances);
  else
    run(accel.listed_instances);
}

}  // namespace oktett
