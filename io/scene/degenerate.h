#pragma once
/// \file Which shapes have nothing that a ray could hit. Within io/ only.

#include <cstddef>
#include <string>

#include "core/transform.h"
#include "kernels/closed/shape_data.h"

namespace oktett {

/// Most vertices of a polygon: testing that it is simple takes quadratic time in the worst case.
inline constexpr std::size_t kMaxPolygonVertices = 4096;

// Each says why the shape is degenerate, or nothing if it is not. Numbers are finite and lengths not
// negative.
std::string why_degenerate(const TriangleShape& triangle);
std::string why_degenerate(const SphereShape& sphere);
std::string why_degenerate(const PlaneShape& plane);
std::string why_degenerate(const DiskShape& disk);
/// Needs min <= max.
std::string why_degenerate(const BoxShape& box);
/// Zero area, edges that touch each other, or a vertex further from the plane than 1e-5 of the polygon's
/// size.
std::string why_degenerate(const PolygonShape& polygon);
/// Singular, or with numbers beyond kMaxCoordinate.
std::string why_degenerate(const Affine& transform);

/// Removes each vertex that repeats the one before it, and a last one that repeats the first.
void remove_repeated_vertices(PolygonShape& polygon);

}  // namespace oktett
