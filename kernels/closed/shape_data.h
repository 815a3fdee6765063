#pragma once
/// \file What describes one shape, as a caller or a scene file states it, in the shape's own space. Each
/// shape's pool and kernel are in its own file; here is only data, in double, that the builder turns into
/// pools.

#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace oktett {

/// How a ray is tested against a triangle. All but `watertight` may miss or double a hit on a shared edge.
enum class TriangleTest : std::uint8_t {
  watertight,  ///< Woop, Benthin and Wald 2013 with exact signs: each point of a closed mesh is hit exactly
               ///< once
  moller_trumbore,  ///< Möller and Trumbore 1997
  badouel,          ///< Badouel 1990: plane, then barycentric coordinates in the dominant plane
  segura_feito,     ///< Segura and Feito 2001: signs of volumes
};

/// One triangle with corners `v[0]`, `v[1]`, `v[2]`, counter-clockwise seen from outside.
struct TriangleShape {
  Vec3d v[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
};

struct SphereShape {
  Vec3d center{0, 0, 0};
  double radius = 1;  ///< > 0
};

/// Many spheres.
struct SpheresShape {
  std::vector<SphereShape> spheres;
};

/// The points p with dot(normal, p) = offset. Unbounded. `normal` need not be of unit length; it is
/// normalised together with `offset`'s meaning unchanged: the plane lies `offset` along the unit normal.
struct PlaneShape {
  Vec3d normal{0, 1, 0};
  double offset = 0;
};

struct DiskShape {
  Vec3d center{0, 0, 0};
  Vec3d normal{0, 1, 0};
  double radius = 1;  ///< > 0
};

/// Solid box, axis-aligned in its own space; under a rotation it is an oriented box.
struct BoxShape {
  Vec3d min{-1, -1, -1};
  Vec3d max{1, 1, 1};
};

/// A planar simple polygon, convex or not, of at least three vertices in order; the side from which they run
/// counter-clockwise is its front.
struct PolygonShape {
  std::vector<Vec3d> vertices;
};

/// How the children of a Boolean expression are combined. `subtract` takes the others from the first.
enum class CsgOp : std::uint8_t {
  operand,  ///< not combined: a solid, or the union of several
  unite,
  intersect,
  subtract,
};

}  // namespace oktett
