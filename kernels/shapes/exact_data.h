#pragma once
/// \file What describes an exact surface: one that is found by solving an equation along the ray. Each in its
/// own space; any affine transform may follow.

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/vec3.h"

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

/// One of them, in the order of ExactShapes in kernels/primitives.h.
using ExactForm = std::variant<TorusShape, CylinderShape, ConeShape, PolyhedronShape, QuadricShape>;

struct ExactShape {
  ExactForm form;
  NormalMethod normals = NormalMethod::gradient;
};

}  // namespace oktett
