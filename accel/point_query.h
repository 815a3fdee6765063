#pragma once
/// \file Questions about points: the nearest point of the surfaces in a structure, and whether a point is
/// inside.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "accel/accel.h"

namespace oktett {

/// The point of the surfaces in a structure that is nearest to a given point, or a miss: what the members are
/// set to here.
struct ClosestPoint {
  Vec3f point;
  float distance = std::numeric_limits<float>::infinity();
  /// Unit normal of the surface at `point`, outwards; that of a triangle by its winding.
  Vec3f normal;
  float u = 0, v = 0;  ///< of a triangle: barycentric coordinates of its second and third corner
  std::uint32_t item = kNoId, instance = kNoId;  ///< as in Hit

  /// False for a miss.
  bool valid() const { return item != kNoId; }
  /// The hit of a ray that ends there, for identify() and object_transform().
  Hit hit() const { return {distance, u, v, item, instance}; }
  bool operator==(const ClosestPoint&) const = default;
};

/// Borrowed columns of `size` points: coordinate k of point i is p[k][i].
struct PointSpan {
  const float* p[3] = {};
  std::size_t size = 0;

  Vec3f operator[](std::size_t i) const { return {p[0][i], p[1][i], p[2][i]}; }
  /// Points `begin` to `begin + count - 1`.
  PointSpan part(std::size_t begin, std::size_t count) const {
    return {{p[0] + begin, p[1] + begin, p[2] + begin}, count};
  }
};

/// Borrowed columns of `size` nearest points. A column that is null is not written.
struct ClosestPointSpan {
  float* point[3] = {};
  float* distance = nullptr;
  float* normal[3] = {};
  float* u = nullptr;
  float* v = nullptr;
  std::uint32_t* item = nullptr;
  std::uint32_t* instance = nullptr;
  std::size_t size = 0;

  void set(std::size_t i, const ClosestPoint& c) const {
    const auto write = [i](auto* column, auto value) {
      if (column != nullptr) column[i] = value;
    };
    for (int k = 0; k < 3; ++k) write(point[k], c.point[k]), write(normal[k], c.normal[k]);
    write(distance, c.distance), write(u, c.u), write(v, c.v);
    write(item, c.item), write(instance, c.instance);
  }
};

// The answers are the same bits for every instruction set, number of threads, order of points and size of a
// batch. Batches are shared out among threads. Points that are near each other are answered faster if they
// are neighbours in the batch. Throws Error if the arrays of one call differ in size, or if this build has no
// code for `isa`.

/// closest[i] becomes the point of all surfaces that is nearest to points[i]; a miss if there are no surfaces
/// or if the point is not finite. Of points at equal distance the one with the lowest (instance, item)
/// counts, where no instance is lower than any. Meshes, spheres, boxes, planes, disks, polygons, cylinders,
/// cones, tori and instances of them are answered. Throws Error if `accel` holds another shape. Spheres,
/// disks, cylinders, cones and tori may be moved, rotated, mirrored and scaled, but not distorted; if they
/// are, it throws Error, too.
void closest_point(const Accel& accel, const PointSpan& points, const ClosestPointSpan& closest,
                   Isa isa = default_isa());
/// The same for arrays of structures.
void closest_point(const Accel& accel, std::span<const Vec3f> points, std::span<ClosestPoint> closest,
                   Isa isa = default_isa());
/// The same for one point.
ClosestPoint closest_point(const Accel& accel, const Vec3f& point, Isa isa = default_isa());

/// How it is judged whether a point is inside of meshes.
enum class InsideRule : std::uint8_t {
  /// By the crossings of one ray from the point, for each mesh alone, as in combinations. Where all edges
  /// pair up, a point is inside of a mesh that winds around it, in either sense: also where shells of one
  /// mesh
  /// overlap; not where an inner shell of the other sense cuts a hole. Where faces are wound against each
  /// other, but every edge has an even number of them, it is inside after an odd number of crossings. In
  /// meshes with holes the answer depends on the direction of the ray, which is fixed.
  crossings,
  /// By |winding_number()| > 1/2, of all meshes together: for meshes with holes, doubled or turned faces, and
  /// for surfaces in several meshes. Decided exactly; a point where it is 1/2, as on a face, is outside.
  winding,
};

/// answers[i] becomes 1 if points[i] is inside of any solid, else 0. Each of these is a solid of its own: the
/// triangles of one mesh together, a sphere, a box, the half-space behind a plane, an exact surface that is
/// not open, a combination; and each of them in every instance. Disks, polygons and open surfaces have no
/// inside. Points that are not finite are outside. For points on a boundary either answer may come.
void inside(const Accel& accel, const PointSpan& points, std::span<std::uint8_t> answers,
            Isa isa = default_isa());
/// The same for an array of structures.
void inside(const Accel& accel, std::span<const Vec3f> points, std::span<std::uint8_t> answers,
            Isa isa = default_isa());
/// The same for one point.
bool inside(const Accel& accel, const Vec3f& point, Isa isa = default_isa());

/// The same by either rule; the rule counts for meshes, other solids are judged as ever.
void inside(const Accel& accel, const PointSpan& points, std::span<std::uint8_t> answers, InsideRule rule,
            Isa isa = default_isa());
void inside(const Accel& accel, std::span<const Vec3f> points, std::span<std::uint8_t> answers,
            InsideRule rule, Isa isa = default_isa());
bool inside(const Accel& accel, const Vec3f& point, InsideRule rule, Isa isa = default_isa());

/// numbers[i] becomes how often all meshes together wind around points[i]: the sum of the solid angles of
/// their triangles over 4 pi, positive seen from the back (Jacobson et al. 2013). It is whole for a closed
/// mesh, and between where there are holes. It is off by at most `error`, which is at least 2^-20, and by a
/// rounding to float. Mirrored instances keep their outside. On a surface it is the mean of both sides. Each
/// other solid that holds the point adds 1. NaN for points that are not finite. Throws Error if `error` is
/// less.
void winding_number(const Accel& accel, const PointSpan& points, std::span<float> numbers,
                    double error = 1e-4, Isa isa = default_isa());
/// The same for an array of structures.
void winding_number(const Accel& accel, std::span<const Vec3f> points, std::span<float> numbers,
                    double error = 1e-4, Isa isa = default_isa());
/// The same for one point.
float winding_number(const Accel& accel, const Vec3f& point, double error = 1e-4, Isa isa = default_isa());

/// distances[i] becomes the distance of points[i] to the nearest point of all surfaces, as closest_point
/// finds it, negative if the point is inside(); infinite for a miss. Throws Error where closest_point does.
void signed_distance(const Accel& accel, const PointSpan& points, std::span<float> distances,
                     Isa isa = default_isa());
/// The same for an array of structures.
void signed_distance(const Accel& accel, std::span<const Vec3f> points, std::span<float> distances,
                     Isa isa = default_isa());
/// The same for one point.
float signed_distance(const Accel& accel, const Vec3f& point, Isa isa = default_isa());

/// The same, negative where the point is inside() by the rule.
void signed_distance(const Accel& accel, const PointSpan& points, std::span<float> distances, InsideRule rule,
                     Isa isa = default_isa());
void signed_distance(const Accel& accel, std::span<const Vec3f> points, std::span<float> distances,
                     InsideRule rule, Isa isa = default_isa());
float signed_distance(const Accel& accel, const Vec3f& point, InsideRule rule, Isa isa = default_isa());

}  // namespace oktett
