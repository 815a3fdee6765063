#pragma once
/// \file The points of closed-form shapes that are nearest to a given point, in double. Each shape is placed
/// in the world by an affine map from the space of its data.

#include "core/transform.h"
#include "kernels/closed/shape_data.h"
#include "kernels/closed/surface_nearest.h"

namespace oktett {

/// The map must be a similarity: Affine::uniform_scale() is not 0. To the centre the point along +z is
/// nearest.
SurfaceNearest closest_on(const SphereShape& sphere, const Affine& to_world, const Vec3d& p);
/// The map must be a similarity.
SurfaceNearest closest_on(const DiskShape& disk, const Affine& to_world, const Vec3d& p);
SurfaceNearest closest_on(const PlaneShape& plane, const Affine& to_world, const Vec3d& p);
SurfaceNearest closest_on(const PolygonShape& polygon, const Affine& to_world, const Vec3d& p);
/// The nearest point of the faces, also for points inside. The map may shear the box.
SurfaceNearest closest_on(const BoxShape& box, const Affine& to_world, const Vec3d& p);

}  // namespace oktett
