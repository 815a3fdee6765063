#pragma once
/// \file Loads rays from columns into lanes.

#include "core/lanes.h"
#include "core/ray.h"

namespace oktett {

/// W rays from column position `b`; lanes past the end repeat the last ray.
template <class F>
OKTETT_INLINE RayLanes<F> load_span(const RaySpan& rays, std::size_t b) {
  constexpr int W = F::kWidth;
  if (OKTETT_LIKELY(b + W <= rays.size)) {
    return {{F::load(rays.origin[0] + b), F::load(rays.origin[1] + b), F::load(rays.origin[2] + b)},
            {F::load(rays.direction[0] + b), F::load(rays.direction[1] + b), F::load(rays.direction[2] + b)},
            F::load(rays.tmin + b),
            F::load(rays.tmax + b)};
  }
  const auto load_tail = [&](const float* column) {
    return F::load_front(column + b, static_cast<int>(rays.size - b));
  };
  return {{load_tail(rays.origin[0]), load_tail(rays.origin[1]), load_tail(rays.origin[2])},
          {load_tail(rays.direction[0]), load_tail(rays.direction[1]), load_tail(rays.direction[2])},
          load_tail(rays.tmin),
          load_tail(rays.tmax)};
}

}  // namespace oktett
