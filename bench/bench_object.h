#pragma once
/// \file Objects of the scenes that benchmarks render.

#include <utility>

#include "render/scene.h"

namespace oktett::bench {

/// `shape` where it stands, of material `material`.
inline Object make_object(Shape shape, std::uint32_t material) {
  Object object;
  object.shape = std::move(shape), object.material = material;
  return object;
}

}  // namespace oktett::bench
