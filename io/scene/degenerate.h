#pragma once
/// \file Polygons and transforms that leave nothing for a ray to hit. Within io/ only.

#include <string>

#include "core/transform.h"
#include "kernels/closed/shape_data.h"

namespace oktett {

// Each says why nothing of the shape or the transform can be seen, or nothing if it is usable.
/// Zero area, edges that touch each other, or a vertex further from the plane than 1e-5 of the polygon's
/// size.
std::string why_degenerate(const PolygonShape& polygon);
/// Singular, or with numbers beyond kMaxCoordinate.
std::string why_degenerate(const Affine& transform);

/// Removes each vertex that repeats the one before it, and a last one that repeats the first.
void remove_repeated_vertices(PolygonShape& polygon);

}  // namespace oktett
