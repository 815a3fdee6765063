#pragma once
/// \file What a ray and a shape truly do, computed by other formulas and with more digits than the kernels
/// have. Serves `oktett verify` and the tests.

#include <cstdint>

#include "core/box.h"
#include "core/ray.h"
#include "core/transform.h"
#include "kernels/closed/shape_data.h"

namespace oktett {

/// `undecided`: the answer is within the tolerance that was granted, either way is right.
enum class OracleVerdict : std::uint8_t { miss, hit, undecided };

/// The nearest hit inside the ray's range. `t_error` bounds what the granted tolerance may do to t,
/// `uv_error` to u and v; the rounding of the results to float comes on top.
struct OracleAnswer {
  OracleVerdict verdict = OracleVerdict::miss;
  double t = 0, u = 0, v = 0;
  double t_error = 0, uv_error = 0;
};

/// The errors that a triangle test may commit, as factors of the magnitudes of what it computes. With p, q
/// the corners of an edge seen from the ray's origin, e the greatest edge and R the greatest of |p|, |q|, an
/// edge function is undecided below |d| * (vertex |p| |q| + edge |e| R + conditioned |e| R |e|^2 |d| /
/// |det|).
struct TriangleTolerance {
  double vertex = 0x1p-49;
  double edge = 0;
  double conditioned = 0;
};

/// By signed volumes: the ray passes the triangle if the tetrahedra over its edges turn the same way.
OracleAnswer oracle_triangle(const Ray& ray, const Vec3f (&corner)[3], const TriangleTolerance& tolerance);

/// The other shapes, in the ray's space, to 2^-48 of distances from the ray's origin.
OracleAnswer oracle_sphere(const Ray& ray, const SphereShape& sphere);
/// `plane.normal` as given: of unit length up to rounding.
OracleAnswer oracle_plane(const Ray& ray, const PlaneShape& plane);
OracleAnswer oracle_disk(const Ray& ray, const DiskShape& disk);
/// The box [-1, 1]^3 behind the map `to_cube`.
OracleAnswer oracle_box(const Ray& ray, const Affine& to_cube);
/// By winding number in the polygon's plane.
OracleAnswer oracle_polygon(const Ray& ray, const PolygonShape& polygon);
/// Whether any point of the ray lies in the closed box; never undecided.
OracleAnswer oracle_slab(const Ray& ray, const Box& box);

}  // namespace oktett
