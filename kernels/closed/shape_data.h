#pragma once
/// \file What describes the shapes with closed-form intersections, each in its own space.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/box.h"
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

/// The smallest box that holds all points.
OKTETT_INLINE Box bounds_of_points(const Vec3d* begin, const Vec3d* end) {
  Box box;
  for (; begin != end; ++begin) box.grow(Box{round_down(*begin), round_up(*begin)});
  return box;
}

/// One triangle with corners `v[0]`, `v[1]`, `v[2]`, counter-clockwise seen from outside.
struct TriangleShape {
  Vec3d v[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

  static constexpr bool kFlat = true;
  static constexpr ShapeInfo kShapeInfo{"triangle", "a triangle"};
  OKTETT_INLINE Box bounds() const { return bounds_of_points(v, v + 3); }
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

  static constexpr ShapeInfo kShapeInfo{"sphere", "a ball; with a transform also an ellipsoid"};
  OKTETT_INLINE Box bounds() const {
    const Vec3d r{radius, radius, radius};
    return {round_down(center - r), round_up(center + r)};
  }
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "the centre");
    p.field("radius", radius, kLength, "distance of the surface from the centre");
    p.nothing_if(radius == 0, "the radius is zero");
  }
};

/// Any number of spheres as one shape; each is a primitive.
struct SpheresShape {
  std::vector<SphereShape> spheres;

  OKTETT_INLINE Box bounds() const {
    Box box;
    for (const SphereShape& sphere : spheres) box.grow(sphere.bounds());
    return box;
  }
};

/// The infinite plane at the distance `offset` from the origin along `normal`.
struct PlaneShape {
  Vec3d normal{0, 1, 0};  ///< of any length but zero
  double offset = 0;      ///< in units of length, whatever the length of `normal`; of either sign

  static constexpr ShapeInfo kShapeInfo{"plane", "a plane without end; what is behind it is inside"};
  void describe(auto& p) {
    p.field("normal", normal, "away from the inside, of any length");
    p.field("offset", offset, kCoordinate, "distance from the origin along the unit normal");
    p.nothing_if(normal == Vec3d{0, 0, 0}, "the normal is zero");
  }
};

/// A flat disk.
struct DiskShape {
  Vec3d center{0, 0, 0};
  Vec3d normal{0, 1, 0};    ///< of any length but zero
  double radius = 1;        ///< > 0
  double inner_radius = 0;  ///< of a hole in the middle; < radius

  static constexpr bool kFlat = true;
  static constexpr ShapeInfo kShapeInfo{"disk", "a flat round plate, perhaps with a hole in the middle"};
  OKTETT_INLINE Box bounds() const {
    const Vec3d n = normalize(normal);
    Vec3d reach;
    for (int k = 0; k < 3; ++k) reach[k] = radius * std::sqrt(std::max(0.0, 1 - n[k] * n[k]));
    return {round_down(center - reach), round_up(center + reach)};
  }
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "the centre");
    p.field("normal", normal, "of any length");
    p.field("radius", radius, kLength, "distance of the edge from the centre");
    p.field("inner_radius", inner_radius, kLength, "that of the edge of the hole");
    p.check(inner_radius < radius || radius == 0, "inner_radius", "the hole must be smaller than the disk");
    p.nothing_if(normal == Vec3d{0, 0, 0}, "the normal is zero");
    p.nothing_if(radius == 0, "the radius is zero");
  }
};

/// A box whose faces are perpendicular to the axes of its own space.
struct BoxShape {
  Vec3d min{-1, -1, -1};
  Vec3d max{1, 1, 1};  ///< > min

  static constexpr ShapeInfo kShapeInfo{"box", "a solid box along the axes"};
  OKTETT_INLINE Box bounds() const { return {round_down(min), round_up(max)}; }
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

/// The outline of a hole.
struct PolygonHole {
  std::vector<Vec3d> vertices;
};

/// A flat polygon, convex or not, whose edges do not cross. Its front is the side from which the vertices run
/// counter-clockwise.
struct PolygonShape {
  std::vector<Vec3d> vertices;          ///< at least three, in one plane
  std::vector<PolygonHole> holes = {};  ///< likewise, in that plane, in any order

  static constexpr bool kFlat = true;
  static constexpr ShapeInfo kShapeInfo{
      "polygon", "points in one plane in order, convex or not; edges must not touch each other"};
  OKTETT_INLINE Box bounds() const {
    return bounds_of_points(vertices.data(), vertices.data() + vertices.size());
  }
  void describe(auto& p) {
    p.required("vertices", vertices, whole(3, kMaxPolygonVertices), "counter-clockwise seen from its front");
    p.optional("holes", holes, whole(0, kMaxPolygonVertices),
               "polygons in the same plane that are cut out; what is in two of them is not");
  }
};

/// The closed forms: FORM(kernel, data, kind) for each. The kernel is described in contract.h;
/// `data` is what geometries and scenes hold; `kind` is the name of its Kind.
#define OKTETT_CLOSED_FORMS(FORM)    \
  FORM(Sphere, SpheresShape, sphere) \
  FORM(Plane, PlaneShape, plane)     \
  FORM(Disk, DiskShape, disk)        \
  FORM(BoxSolid, BoxShape, box)      \
  FORM(Polygon, PolygonShape, polygon)
/// The data of the closed forms behind other arguments of a template.
#define OKTETT_AND_CLOSED_FORMS OKTETT_CLOSED_FORMS(OKTETT_AND_DATA)
#define OKTETT_AND_DATA(Kernel, Data, kind) , Data

/// Whether a shape has no inside.
template <class Shape>
inline constexpr bool kIsFlat = requires {
  Shape::kFlat;
};

/// How the children of a Boolean expression are combined.
enum class CsgOp : std::uint8_t {
  operand,    ///< no combination: a solid, or the union of several
  unite,      ///< what is in any child
  intersect,  ///< what is in all children
  subtract,   ///< what is in the first child and in none of the others
  surfaces,   ///< no combination: surfaces without an inside, which other operands cut
};

}  // namespace oktett
