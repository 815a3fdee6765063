#pragma once
/// \file Questions of the sweep along a ray about the solids of a Boolean combination.

#include "accel/accel.h"

namespace oktett {

/// Item of the outermost instance or combination on `path`.
std::uint32_t top_item(const Accel& accel, std::uint32_t path);

/// Whether a ray that does not cross the boundary of `geometry`, which is unbounded, runs inside it from
/// ray.tmin on.
bool runs_inside(const Accel& accel, std::uint32_t geometry, const Ray& ray);

}  // namespace oktett
