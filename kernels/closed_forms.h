#pragma once
/// \file The closed-form shapes and their pools. Their kernels are inlined where leaves are tested.

#include <cstddef>
#include <tuple>
#include <variant>

#include "core/platform.h"
#include "kernels/closed/box_solid.h"
#include "kernels/closed/disk.h"
#include "kernels/closed/plane.h"
#include "kernels/closed/polygon.h"
#include "kernels/closed/sphere.h"
#include "kernels/kinds.h"

namespace oktett {

/// One pool per shape.
template <class, class... S>
struct PoolsOf {
  using type = std::tuple<typename S::Pool...>;
};
#define FORM(Kernel, Data, name) , Kernel
using ShapePools = PoolsOf<void OKTETT_CLOSED_FORMS(FORM)>::type;
#undef FORM

/// Calls f(shape tag, kind) for each closed form.
template <class Function>
OKTETT_INLINE void each_closed_form(Function&& f) {
#define FORM(Kernel, Data, name) f(Kernel{}, Kind::name);
  OKTETT_CLOSED_FORMS(FORM)
#undef FORM
}

/// Calls f(shape tag, pool) for the closed-form `kind`; the branch is the only dispatch on the way to a
/// kernel.
template <class Pools, class Function>
OKTETT_INLINE void visit_pool(Kind kind, Pools& pools, Function&& f) {
#define FORM(Kernel, Data, name) \
  if (kind == Kind::name) return f(Kernel{}, std::get<Kernel::Pool>(pools));
  OKTETT_CLOSED_FORMS(FORM)
#undef FORM
}

/// Calls f(shape tag, kind, data) if `shape`, a variant, holds the data of a closed form.
template <class Variant, class Function>
void visit_closed_form(const Variant& shape, Function&& f) {
  each_closed_form([&]<class S>(S form, Kind kind) {
    if (const auto* data = std::get_if<typename S::Data>(&shape)) f(form, kind, *data);
  });
}

/// The shapes that `data` describes: how many, and number i.
template <class S>
std::size_t shape_count(const typename S::Data& data) {
  if constexpr (requires { S::count(data); })
    return S::count(data);
  else
    return 1;
}
template <class S>
const auto& nth_shape(const typename S::Data& data, std::size_t i) {
  if constexpr (requires { S::nth(data, i); })
    return S::nth(data, i);
  else
    return data;
}

/// Whether S has bounds.
template <class S>
inline constexpr bool kHasBounds = requires(const typename S::Pool& pool) {
  S::bounds(pool, 0);
};

/// Bounds of a shape in the world; empty if there is nothing of it or it has none.
template <class S, class Shape>
Box moved_bounds(const Shape& shape, const Affine& to_world) {
  if constexpr (kHasBounds<S>) {
    if (S::is_empty(shape)) return {};
    if constexpr (requires { S::bounds(S::moved(shape, to_world)); }) {
      return S::bounds(S::moved(shape, to_world));
    } else {
      typename S::Pool pool;
      S::add(pool, shape, to_world, 0);
      return S::bounds(pool, 0);
    }
  }
  return {};
}

}  // namespace oktett
