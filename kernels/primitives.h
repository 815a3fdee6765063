#pragma once
/// \file The one list of kinds: everything a leaf of the tree can hold. A new shape is one file and one line
/// here.

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include "kernels/shapes/box_solid.h"
#include "kernels/shapes/disk.h"
#include "kernels/shapes/plane.h"
#include "kernels/shapes/polygon.h"
#include "kernels/shapes/sphere.h"
#include "kernels/shapes/torus.h"
#include "kernels/shapes/triangle.h"

namespace oktett {

/// The closed-form shapes, in the order of their kinds.
using ClosedFormShapes = std::tuple<Sphere, Disk, BoxSolid, Polygon, Plane>;

/// The exact surfaces, in the order of ExactForm.
using ExactShapes = std::tuple<Torus>;

/// What a leaf holds. The closed-form kinds come first and number the entries of ClosedFormShapes; the exact
/// ones follow and number those of ExactShapes.
enum class Kind : std::uint8_t { sphere, disk, box, polygon, plane, torus, triangle, instance };

inline constexpr int kClosedFormKinds = static_cast<int>(std::tuple_size_v<ClosedFormShapes>);
inline constexpr int kExactKinds = static_cast<int>(std::tuple_size_v<ExactShapes>);
inline constexpr int kKinds = static_cast<int>(Kind::instance) + 1;
static_assert(kKinds == kClosedFormKinds + kExactKinds + 2);

inline constexpr bool is_exact(Kind kind) {
  return kind >= static_cast<Kind>(kClosedFormKinds) && kind < Kind::triangle;
}
/// Kinds whose elements cost more to test than a node of the tree.
inline constexpr bool stands_alone(Kind kind) { return kind == Kind::instance || is_exact(kind); }
/// The kind of an exact form.
inline Kind kind_of(const ExactForm& form) { return static_cast<Kind>(kClosedFormKinds + form.index()); }

template <std::size_t... I>
constexpr bool exact_kinds_agree(std::index_sequence<I...>) {
  return std::variant_size_v<ExactForm> == sizeof...(I) &&
         (std::is_same_v<typename std::tuple_element_t<I, ExactShapes>::Data,
                         std::variant_alternative_t<I, ExactForm>> &&
          ...);
}
static_assert(exact_kinds_agree(std::make_index_sequence<kExactKinds>()));

/// One pool per shape.
template <class Shapes>
struct PoolsOf;
template <class... S>
struct PoolsOf<std::tuple<S...>> {
  using type = std::tuple<typename S::Pool...>;
};
using ShapePools = PoolsOf<ClosedFormShapes>::type;
using ExactPools = PoolsOf<ExactShapes>::type;

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

/// The same for an exact `kind`.
template <int K = 0, class Pools, class Function>
OKTETT_INLINE void visit_exact(Kind kind, Pools& pools, Function&& f) {
  if constexpr (K < kExactKinds) {
    if (static_cast<int>(kind) == kClosedFormKinds + K)
      f(std::tuple_element_t<K, ExactShapes>{}, std::get<K>(pools));
    else
      visit_exact<K + 1>(kind, pools, f);
  }
}

}  // namespace oktett
