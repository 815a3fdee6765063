#pragma once
/// \file The kind and the bounds of geometries, for the builder.

#include "accel/accel.h"
#include "kernels/kinds.h"

namespace oktett {

Kind kind_of(const Geometry& geometry);

/// Whether it is an infinite plane or surface, or an instance of a structure with one.
bool is_unbounded(const Geometry& geometry);

/// The sphere's image under a similarity.
SphereShape moved_sphere(const SphereShape& s, const Affine& m);
/// The plane's image.
PlaneShape moved_plane(const PlaneShape& s, const Affine& m);

/// Bounds of item `local` of a geometry of a closed-form shape, or an empty box if it is degenerate or
/// unbounded.
Box shape_bounds(const Geometry& geometry, std::size_t local);
/// The image of the child's bounds, grown by what rounding the transformed ray to float may displace.
Box instance_bounds(const Affine& to_world, const Accel& child);

/// Bounds of all of a geometry; empty if it is degenerate or unbounded.
Box geometry_bounds(const Geometry& geometry);

}  // namespace oktett
