#pragma once
/// \file The kind and the bounds of geometries, for the builder.

#include "accel/accel.h"
#include "kernels/kinds.h"

namespace oktett {

Kind kind_of(const Geometry& geometry);

/// Whether it is an infinite plane or surface, or an instance of a structure with one.
bool is_unbounded(const Geometry& geometry);

/// The image of the child's bounds, grown by what rounding the transformed ray to float may displace.
Box instance_bounds(const Affine& to_world, const Accel& child);

/// Whether a tree can hold the box: it is not empty, and finite.
inline bool is_usable(const Box& b) { return !b.empty() && is_finite(b.lo) && is_finite(b.hi); }

/// Bounds of all of a geometry; empty if it is degenerate or unbounded.
Box geometry_bounds(const Geometry& geometry);

}  // namespace oktett
