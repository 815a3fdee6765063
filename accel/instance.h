#pragma once
/// \file Rays into instances. They are transformed in double and rounded to float. The direction is not
/// normalised, so t means the same inside.

#include "accel/accel_data.h"
#include "core/lanes.h"

namespace oktett {

/// Entry k of the instance's map, in all lanes.
template <class D, class Instance>
OKTETT_INLINE D map_entry(const Instance& instance, int k) {
  if constexpr (requires { instance.map_entry(k); })
    return instance.map_entry(k);
  else
    return D(static_cast<double>(instance.to_child[k]));
}

/// Origins `o` and directions `d` of rays in the child's space. `Instance` is an InstanceItem or a
/// ListedInstance, or has a map_entry(k), in which the lanes have maps of their own.
template <class Instance, int W, class A>
OKTETT_INLINE void transform_rays(const Instance& instance, const RayLanes<Simd<float, W, A>>& ray,
                                  Vec3<Simd<float, W, A>>& o, Vec3<Simd<float, W, A>>& d) {
  using D = Simd<double, W, A>;
  const Vec3<D> od = to_double(ray.o), dd = to_double(ray.d);
  const auto linear = [&](int k, const Vec3<D>& v) {
    const auto entry = [&](int j) { return map_entry<D>(instance, 4 * k + j); };
    return (entry(0) * v.x + entry(1) * v.y) + entry(2) * v.z;
  };
  const auto point = [&](int k) { return to_float(linear(k, od) + map_entry<D>(instance, 4 * k + 3)); };
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

OKTETT_INLINE bool has_instances(const Accel& accel) {
  return !accel.instances.empty() || !accel.listed_instances.empty();
}

/// Instances of both kinds have one number: the index in Accel::instances, or that in
/// Accel::listed_instances plus kListedNumber.
inline constexpr std::uint32_t kListedNumber = 0x80000000u;
/// The number of no instance.
inline constexpr std::uint32_t kNoInstance = 0xffffffffu;

/// The number of the first instance of a leaf; the others follow.
OKTETT_INLINE std::uint32_t first_instance(const LeafEntry& leaf) {
  return leaf.begin + (leaf.kind == Kind::instance ? 0 : kListedNumber);
}

/// Calls f(instance, child) for the instance with a number.
template <class Function>
OKTETT_INLINE void with_instance(const Accel& accel, std::uint32_t number, Function&& f) {
  const auto run = [&](const auto& instance) { f(instance, child_of(accel, instance)); };
  if (number < kListedNumber)
    run(accel.instances[number]);
  else
    run(accel.listed_instances[number - kListedNumber]);
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
