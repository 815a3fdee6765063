#pragma once
/// \file Fields of one kind of shape over a floor, described for POV-Ray and for Oktett alike.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "render/scene.h"

namespace oktett::bench {

using Vec3l = Vec3<long double>;

/// One object of a field: what POV-Ray reads, what Oktett traces, and what both should be.
struct FieldObject {
  std::string pov;  ///< in its own space, without texture
  Shape shape;
  /// Negative inside, in the space of the shape.
  std::function<long double(const Vec3l&)> f;
};

/// A kind of shape. `make` describes one with parameters that depend on six random numbers of [0, 1).
struct FieldKind {
  std::string name;
  int count;  ///< objects in the field, a square number
  FieldObject (*make)(const double (&r)[6]);
};

std::vector<FieldKind> field_kinds();

/// A cube with rounded corners and three bores.
FieldObject rounded_cube(const double (&r)[6]);
/// A plate with a thousand holes.
FieldObject drilled_plate(const double (&r)[6]);

/// A field seen by both. POV-Ray's space is left-handed: its picture is Oktett's mirrored from left to right.
struct Field {
  Scene scene;               ///< for Oktett; objects 0, 1, ... and the floor last, each with its own material
  std::string pov, pov_ids;  ///< the same for POV-Ray, lit; and each object in a colour that numbers it
  std::vector<FieldObject> objects;  ///< without the floor
};

Field make_field(const FieldKind& kind, std::uint32_t width, std::uint32_t height);

}  // namespace oktett::bench
