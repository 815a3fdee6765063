#pragma once
/// \file The exact surfaces and their pools. Traversals know only their kinds (primitives.h), so that a
/// change to a shape recompiles little.

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "kernels/exact/blob.h"
#include "kernels/exact/blobtree.h"
#include "kernels/exact/cone.h"
#include "kernels/exact/cylinder.h"
#include "kernels/exact/implicit.h"
#include "kernels/exact/lathe.h"
#include "kernels/exact/metaballs.h"
#include "kernels/exact/polyhedron.h"
#include "kernels/exact/polynomial.h"
#include "kernels/exact/quadric.h"
#include "kernels/exact/revolution.h"
#include "kernels/exact/superquadric.h"
#include "kernels/exact/torus.h"
#include "kernels/fractals/ifs.h"
#include "kernels/fractals/julia.h"
#include "kernels/fractals/menger.h"
#include "kernels/fractals/sphereflake.h"
#include "kernels/fractals/terrain.h"
#include "kernels/heights/height_field.h"
#include "kernels/kinds.h"

namespace oktett {

/// In the order of ExactForm.
using ExactShapes = std::tuple<Torus, Cylinder, Cone, Polyhedron, Quadric, PolynomialSurface, Blob,
                               Revolution, Lathe, Superquadric, Metaballs, BlobTree, Implicit, Sphereflake,
                               Menger, Ifs, Julia, Terrain, HeightField>;

template <std::size_t... I>
constexpr bool exact_kinds_agree(std::index_sequence<I...>) {
  return std::variant_size_v<ExactForm> == sizeof...(I) &&
         (std::is_same_v<typename std::tuple_element_t<I, ExactShapes>::Data,
                         std::variant_alternative_t<I, ExactForm>> &&
          ...);
}
static_assert(exact_kinds_agree(std::make_index_sequence<kExactKinds>()));

struct ExactPools {
  PoolsOf<ExactShapes>::type pools;
};

/// Appends `shape`, whose form is of S, to its pool.
template <class S>
void add_exact(typename S::Pool& pool, const ExactShape& shape, const Affine& to_world, std::uint32_t item) {
  S::add(pool, std::get<typename S::Data>(shape.form), {to_world, item, shape.normals});
}

/// Calls f(shape tag, pool) for the exact `kind`; `Pools` is ExactPools, const or not.
template <int K = 0, class Pools, class Function>
OKTETT_INLINE void visit_exact(Kind kind, Pools& pools, Function&& f) {
  if constexpr (K < kExactKinds) {
    if (static_cast<int>(kind) == kClosedFormKinds + K)
      f(std::tuple_element_t<K, ExactShapes>{}, std::get<K>(pools.pools));
    else
      visit_exact<K + 1>(kind, pools, f);
  }
}

}  // namespace oktett
