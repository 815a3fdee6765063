#pragma once
/// \file What describes the shapes with closed-form intersections, each in its own space.

#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace oktett {

/// How a ray is tested against a triangle. All but `watertight` may miss or double a hit on a shared edge.
enum class TriangleTest : std::uint8_t {
  watertight,  ///< Woop, Benthin and Wald 2013 with exact signs: no hit on a shared edge is missed or doubled
  moller_trumbore,  ///< Möller and Trumbore 1997
  badouel,          ///< Badouel 1990: plane, then barycentric coordinates in the dominant plane
  segura_feito,     ///< Segura and Feito 2001: signs of volumes
};

/// One triangle with corners `v[0]`, `v[1]`, `v[2]`, counter-clockwise seen from outside.
struct TriangleShape {
  Vec3d v[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
};

/// One sphere.
struct SphereShape {
  Vec3d center{0, 0, 0};
  double radius = 1;  ///< > 0
};

/// Any number of spheres as one shape; each is a primitive.
struct SpheresShape {
  std::vector<SphereShape> spheres;
};

/// The infinite plane at the distance `offset` from the origin along `normal`.
struct PlaneShape {
  Vec3d normal{0, 1, 0};  ///< of any length but zero
  double offset = 0;      ///< in units of length, whatever the length of `normal`; of either sign
};

/// A flat disk.
struct DiskShape {
  Vec3d center{0, 0, 0};
  Vec3d normal{0, 1, 0};  ///< of any length but zero
  double radius = 1;      ///< > 0
};

/// A box whose faces are perpendicular to the axes of its own space.
struct BoxShape {
  Vec3d min{-1, -1, -1};
  Vec3d max{1, 1, 1};  ///< > min
};

/// A flat polygon, convex or not, whose edges do not cross. Its front is the side from which the vertices run
/// counter-clockwise.
struct PolygonShape {
  std::vector<Vec3d> vertices;  ///< at least three, in one plane
};

/// How the children of a Boolean expression are combined.
enum class CsgOp : std::uint8_t {
  operand,    ///< no combination: a solid, or the union of several
  unite,      ///< what is in any child
  intersect,  ///< what is in all children
  subtract,   ///< what is in the first child and in none of the others
};

}  // namespace oktett
