#pragma once
/// \file What describes the shapes with closed-form intersections, each in its own space.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/description.h"
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

  static constexpr Surface kSurface{"triangle", "a triangle"};
  void describe(auto& p) {
    p.field("vertices", v, whole(3, 3), "counter-clockwise seen from its front");
    const Vec3d ab = v[1] - v[0], ac = v[2] - v[0], bc = v[2] - v[1];
    const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
    // Below this the area is all rounding error.
    p.nothing_if(!(length(cross(ab, ac)) > 1e-12 * longest), "the triangle has no area");
  }
};

/// One sphere.
struct SphereShape {
  Vec3d center{0, 0, 0};
  double radius = 1;  ///< > 0

  static constexpr Surface kSurface{"sphere", "a ball; with a transform also an ellipsoid"};
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "the centre");
    p.field("radius", radius, kLength, "distance of the surface from the centre");
    p.nothing_if(radius == 0, "the radius is zero");
  }
};

/// Any number of spheres as one shape; each is a primitive.
struct SpheresShape {
  std::vector<SphereShape> spheres;
};

/// The infinite plane at the distance `offset` from the origin along `normal`.
struct PlaneShape {
  Vec3d normal{0, 1, 0};  ///< of any length but zero
  double offset = 0;      ///< in units of length, whatever the length of `normal`; of either sign

  static constexpr Surface kSurface{"plane", "a plane without end; what is behind it is inside"};
  void describe(auto& p) {
    p.field("normal", normal, "away from the inside, of any length");
    p.field("offset", offset, kCoordinate, "distance from the origin along the unit normal");
    p.nothing_if(normal == Vec3d{0, 0, 0}, "the normal is zero");
  }
};

/// A flat disk.
struct DiskShape {
  Vec3d center{0, 0, 0};
  Vec3d normal{0, 1, 0};  ///< of any length but zero
  double radius = 1;      ///< > 0

  static constexpr Surface kSurface{"disk", "a flat round plate"};
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "the centre");
    p.field("normal", normal, "of any length");
    p.field("radius", radius, kLength, "distance of the edge from the centre");
    p.nothing_if(normal == Vec3d{0, 0, 0}, "the normal is zero");
    p.nothing_if(radius == 0, "the radius is zero");
  }
};

/// A box whose faces are perpendicular to the axes of its own space.
struct BoxShape {
  Vec3d min{-1, -1, -1};
  Vec3d max{1, 1, 1};  ///< > min

  static constexpr Surface kSurface{"box", "a solid box along the axes"};
  void describe(auto& p) {
    p.field("min", min, kCoordinate, "the corner of least x, y and z");
    p.field("max", max, kCoordinate, "the corner of greatest x, y and z");
    p.check(min.x <= max.x, "max", "the box has min > max along x");
    p.check(min.y <= max.y, "max", "the box has min > max along y");
    p.check(min.z <= max.z, "max", "the box has min > max along z");
    p.nothing_if((min.x == max.x) + (min.y == max.y) + (min.z == max.z) >= 2, "the box has no area");
  }
};

/// Most vertices of a polygon: testing that it is simple takes quadratic time in the worst case.
inline constexpr std::uint32_t kMaxPolygonVertices = 4096;

/// A flat polygon, convex or not, whose edges do not cross. Its front is the side from which the vertices run
/// counter-clockwise.
struct PolygonShape {
  std::vector<Vec3d> vertices;  ///< at least three, in one plane

  static constexpr Surface kSurface{
      "polygon", "points in one plane in order, convex or not; edges must not touch each other"};
  void describe(auto& p) {
    p.required("vertices", vertices, whole(3, kMaxPolygonVertices), "counter-clockwise seen from its front");
  }
};

/// How the children of a Boolean expression are combined.
enum class CsgOp : std::uint8_t {
  operand,    ///< no combination: a solid, or the union of several
  unite,      ///< what is in any child
  intersect,  ///< what is in all children
  subtract,   ///< what is in the first child and in none of the others
};

}  // namespace oktett
