#pragma once
/// \file The one list of kinds: everything a leaf of the tree can hold. A new shape is one file and one line
/// here.

#include <cstdint>
#include <tuple>

#include "kernels/shapes/box_solid.h"
#include "kernels/shapes/disk.h"
#include "kernels/shapes/plane.h"
#include "kernels/shapes/polygon.h"
#include "kernels/shapes/sphere.h"
#include "kernels/shapes/triangle.h"

namespace oktett {

/// The closed-form shapes, in the order of their kinds.
using ClosedFormShapes = std::tuple<Sphere, Disk, BoxSolid, Polygon, Plane>;

/// What a leaf holds. The closed-form kinds come first and number the entries of ClosedFormShapes.
enum class Kind : std::uint8_t { sphere, disk, box, polygon, plane, triangle, instance };

inline constexpr int kClosedFormKinds = static_cast<int>(std::tuple_size_v<ClosedFormShapes>);

/// One pool per closed-form shape.
template <class Shapes>
struct PoolsOf;
template <class... S>
struct PoolsOf<std::tuple<S...>> {
  using type = std::tuple<typename S::Pool...>;
};
using ShapePools = PoolsOf<ClosedFormShapes>::type;

/// Calls f(shape tag, pool) for the closed-form `kind`; the branch is the only dispatch on the way to a
/// kernel.
template <int K = 0, class Pools, class Function>
OKTETT_INLINE void visit_pool(Kind kind, Pools& pools, Function&& f) {
  if constexpr (K < kClosedFormKinds) {
    if (static_cast<int>(kind) == K)
      f(std::tuple_element_t<K, ClosedFormShapes>{}, std::get<K>(pools));
    else
      visit_pool<K + 1>(kind, pools, f);
  }
}

}  // namespace oktett
