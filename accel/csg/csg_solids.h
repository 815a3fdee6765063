#pragma once
/// \file What the sweep along a ray asks of the solids of a Boolean combination.

#include "accel/accel.h"

namespace oktett {

/// Item, in the structure itself, of the outermost instance or combination that path `path` leads through.
std::uint32_t top_item(const Accel& accel, std::uint32_t path);

/// True if a ray that meets no boundary of `geometry`, which is not bounded, runs inside of it. `ray.tmin` is
/// where it begins.
bool runs_inside(const Accel& accel, std::uint32_t geometry, const Ray& ray);

}  // namespace oktett
