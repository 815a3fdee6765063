#pragma once
/// \file The closed-form shapes and their pools. Their kernels are inlined where leaves are tested.

#include <cstddef>
#include <iterator>
#include <tuple>

#include "core/platform.h"
#include "kernels/closed/box_solid.h"
#include "kernels/closed/disk.h"
#include "kernels/closed/plane.h"
#include "kernels/closed/polygon.h"
#include "kernels/closed/sphere.h"
#include "kernels/kinds.h"

namespace oktett {

using ClosedFormShapes = std::tuple<Sphere, Disk, BoxSolid, Polygon, Plane>;
/// The kind of each.
inline constexpr Kind kClosedFormKinds[] = {Kind::sphere, Kind::disk, Kind::box, Kind::polygon, Kind::plane};
static_assert(std::size(kClosedFormKinds) == std::tuple_size_v<ClosedFormShapes>);

/// One pool per shape.
template <class Shapes>
struct PoolsOf;
template <class... S>
struct PoolsOf<std::tuple<S...>> {
  using type = std::tuple<typename S::Pool...>;
};
using ShapePools = PoolsOf<ClosedFormShapes>::type;

/// Calls f(shape tag, pool) for the closed-form `kind`; the branch is the only dispatch on the way to a
/// kernel.
template <std::size_t I = 0, class Pools, class Function>
OKTETT_INLINE void visit_pool(Kind kind, Pools& pools, Function&& f) {
  if constexpr (I < std::size(kClosedFormKinds)) {
    if (kind == kClosedFormKinds[I])
      f(std::tuple_element_t<I, ClosedFormShapes>{}, std::get<I>(pools));
    else
      visit_pool<I + 1>(kind, pools, f);
  }
}

}  // namespace oktett
