#pragma once
/// \file The one list of kinds: everything a leaf of the tree can hold. A new shape is one file and one line
/// here.

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <variant>

#include "kernels/closed/box_solid.h"
#include "kernels/closed/disk.h"
#include "kernels/closed/plane.h"
#include "kernels/closed/polygon.h"
#include "kernels/closed/sphere.h"
#include "kernels/exact_form.h"
#include "kernels/triangle/triangle.h"

namespace oktett {

/// The closed-form shapes, in the order of their kinds.
using ClosedFormShapes = std::tuple<Sphere, Disk, BoxSolid, Polygon, Plane>;

/// What a leaf holds. The closed-form kinds come first and number the entries of ClosedFormShapes; the exact
/// ones follow and number those of ExactForm (exact_form.h) and ExactShapes (exact_shapes.h).
enum class Kind : std::uint8_t {
  sphere,
  disk,
  box,
  polygon,
  plane,
  torus,
  cylinder,
  cone,
  polyhedron,
  quadric,
  polynomial,
  blob,
  revolution,
  lathe,
  superquadric,
  metaballs,
  blobtree,
  implicit,
  sphereflake,
  menger,
  ifs,
  julia,
  terrain,
  height_field,
  triangle,
  csg,
  instance,
  instance_list
};

inline constexpr int kClosedFormKinds = static_cast<int>(std::tuple_size_v<ClosedFormShapes>);
inline constexpr int kExactKinds = static_cast<int>(std::variant_size_v<ExactForm>);
inline constexpr int kKinds = static_cast<int>(Kind::instance_list) + 1;
static_assert(kKinds == kClosedFormKinds + kExactKinds + 4);

inline constexpr bool is_exact(Kind kind) {
  return kind >= static_cast<Kind>(kClosedFormKinds) && kind < Kind::triangle;
}
/// Exact kinds whose elements are one cell and list all their crossings, at most four, at once.
inline constexpr bool has_one_cell(Kind kind) { return Kind::torus <= kind && kind <= Kind::quadric; }
/// Kinds whose elements cost more to test than a node of the tree.
inline constexpr bool stands_alone(Kind kind) { return kind >= Kind::csg || is_exact(kind); }
/// The kind of an exact form.
inline Kind kind_of(const ExactForm& form) { return static_cast<Kind>(kClosedFormKinds + form.index()); }

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
