#pragma once
/// \file What describes an exact surface: one that is found by solving an equation along the ray. Each in its
/// own space; any affine transform may follow.

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/vec3.h"
#include "kernels/exact/field_data.h"
#include "kernels/fractals/fractal_data.h"
#include "kernels/functions/tape_data.h"
#include "kernels/heights/height_data.h"
#include "kernels/roots/roots.h"

namespace oktett {

/// How the normal of an exact surface is computed.
enum class NormalMethod : std::uint8_t {
  gradient,  ///< exact
  forward,   ///< forward differences of the function
  central,   ///< central differences
};

/// (major - sqrt(x^2 + y^2))^2 + z^2 = minor^2 (slides). With minor > major the surface meets itself on the
/// axis.
struct TorusShape {
  double major = 0.7;  ///< >= 0
  double minor = 0.3;  ///< > 0
};

/// All points nearer than `radius` to the line from `from` to `to`, cut off flat at its ends.
struct CylinderShape {
  Vec3d from{0, -1, 0}, to{0, 1, 0};  ///< different
  double radius = 1;                  ///< > 0
  bool open = false;                  ///< without the ends
};

/// As a cylinder, with a radius at each end; a radius of 0 makes a tip.
struct ConeShape {
  Vec3d from{0, -1, 0}, to{0, 1, 0};      ///< different
  double from_radius = 1, to_radius = 0;  ///< >= 0, not both 0
  bool open = false;                      ///< without the ends
};

/// All points p with normal . p <= offset; the normal need not have unit length.
struct HalfSpace {
  Vec3d normal;
  double offset;
};

/// What all of the half-spaces have in common; bounded, with an inside.
struct PolyhedronShape {
  std::vector<HalfSpace> planes;
};

/// A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0 (slides: x^2 + y^2 = 1,
/// x^2 + y^2 - z = 0, x^2 + y^2 - z^2 = 1).
struct QuadricShape {
  std::array<double, 10> coefficients{1, 1, 1, 0, 0, 0, 0, 0, 0, -1};  ///< A to J
  bool clipped = false;
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi; nothing is outside of this box if `clipped`
  bool open = false;                  ///< without the faces of the box, which otherwise close the solid
};

/// c x^i y^j z^k.
struct Monomial {
  std::uint8_t i, j, k;
  double c;
};

/// The sum of the terms is negative inside and zero on the surface. What is outside of the box is no part of
/// the solid.
struct PolynomialShape {
  std::vector<Monomial> terms;        ///< i + j + k <= roots::kMaxDegree, each only once
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi
  bool open = false;                  ///< without the faces of the box
  roots::Method root_finder = roots::Method::automatic;
};

/// weight / p, where p is the squared distance from a point, a line or a plane.
struct BlobSource {
  enum class Kind : std::uint8_t { point, line, plane };
  Kind kind = Kind::point;
  Vec3d at{0, 0, 0};         ///< the point, or one on the line
  Vec3d direction{0, 1, 0};  ///< of the line, or the plane's normal; not zero
  double offset = 0;         ///< direction . x = offset on the plane, with the direction's unit vector
  double weight = 1;
};
inline constexpr std::size_t kMaxBlobSources = roots::kMaxDegree / 2;

/// Where the sources add up to more than `iso` (Melcher, "Blobs, Typ I").
struct BlobShape {
  std::vector<BlobSource> sources;  ///< at most kMaxBlobSources
  double iso = 1;                   ///< > 0
  bool bounded = false;             ///< whether it is cut by the box; needed unless all sources are points
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};
  bool open = false;  ///< without the faces of the box
  roots::Method root_finder = roots::Method::automatic;
};

/// A point of a profile, which turns about the y axis.
struct ProfilePoint {
  double radius, height;
};

/// x^2 + z^2 < r(y)^2, where r is given piece by piece; the ends are closed by disks (Melcher, "Surface of
/// Revolution").
struct RevolutionShape {
  enum class Profile : std::uint8_t {
    spline,  ///< r is cubic between the inner points; the first and the last only give slopes
    linear,  ///< straight between all points
    sor,     ///< r^2 is cubic between the inner points, as POV-Ray's `sor`
  };
  std::vector<ProfilePoint> points;  ///< heights ascend; in `linear` two may be the same
  Profile profile = Profile::spline;
  bool open = false;  ///< without the disks
};

/// As RevolutionShape for any plane curve of cubic Bezier pieces, which need not ascend.
struct LatheShape {
  std::vector<ProfilePoint> points;  ///< 3 n + 1 control points; pieces share their ends
  bool open = false;                 ///< without the disks at the curve's ends
};

/// Superquadrics (slides). With `ratio` the powers |x|^p are replaced by Blanc and Schlick's pseudo-powers
/// g_p(x) = |x| / (p + (1 - p) |x|); nothing is inside beyond their poles, |x| >= p / (p - 1) for p > 1.
struct SuperquadricShape {
  enum class Form : std::uint8_t {
    ellipsoid,    ///< |x/a|^p + |y/b|^q + |z/c|^r = 1
    hyperboloid,  ///< |x/a|^p + |y/b|^q - |z/c|^r = 1, cut by a box
    toroid,       ///< |d - (|x/a|^m + |y/b|^n)^q|^r + |z/c|^p = e^2
  };
  Form form = Form::ellipsoid;
  bool ratio = false;
  Vec3d radii{1, 1, 1};                 ///< a, b, c > 0
  double p = 2, q = 2, r = 2;           ///< > 0
  double m = 2, n = 2, d = 1, e = 0.5;  ///< of the toroid; m, n, e > 0, d >= 0
  Vec3d lo{-2, -2, -2}, hi{2, 2, 2};    ///< the box of the hyperboloid, lo < hi
  bool open = false;                    ///< without the faces of the box
};

/// Where a function of x, y and z is negative, in a box. Where it is not defined is outside.
struct ImplicitShape {
  FunctionTape function;
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi
  bool open = false;                  ///< without the faces of the box
};

/// One of them, in the order of ExactShapes in kernels/kinds.h.
using ExactForm = std::variant<TorusShape, CylinderShape, ConeShape, PolyhedronShape, QuadricShape,
                               PolynomialShape, BlobShape, RevolutionShape, LatheShape, SuperquadricShape,
                               MetaballsShape, BlobTreeShape, ImplicitShape, SphereflakeShape, MengerShape,
                               IfsShape, JuliaShape, TerrainShape, HeightFieldShape>;

struct ExactShape {
  ExactForm form;
  NormalMethod normals = NormalMethod::gradient;
};

}  // namespace oktett
