#pragma once
/// \file What describes metaballs.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/fields/field_data.h"

namespace oktett {

/// Most balls or elements of one object in a scene file.
inline constexpr std::uint32_t kMaxBalls = std::uint32_t{1} << 20;
/// Factors of potentials, and values on surfaces.
inline constexpr Range kStrength{-1e9, 1e9};
inline constexpr Range kIso{0, 1e9, true};

/// strength (1 - a^2 / radius^2)^2 at the distance a < radius from the centre, 0 beyond.
struct MetaBall {
  Vec3d center{0, 0, 0};
  double radius = 1;
  double strength = 1;

  static constexpr const char* kMap = "ball";
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "where the potential is greatest");
    p.field("radius", radius, kPositiveLength, "how far the potential reaches");
    p.field("strength", strength, kStrength, "the potential at the centre, of either sign");
  }
};

/// The sum of the balls' potentials is `iso` on the surface and greater inside (M. Melcher: Blobs II).
struct MetaballsShape {
  double iso = 0.5;
  std::vector<MetaBall> balls;
  /// Points, segments and ellipsoids, with the potential `wyvill`, which is that of the balls.
  std::vector<FieldElement> elements{};

  static constexpr ShapeInfo kShapeInfo{
      "metaballs", "where the sum of the potentials of one of `balls`, `file` and `elements` exceeds `iso`"};
  void describe(auto& p) {
    p.field("iso", iso, kIso, "the value on the surface");
    p.optional("balls", balls, whole(1, kMaxBalls), "the balls");
    p.optional("file", ByHand{"file", "file"},
               "a text file of the balls, `x y z radius [strength]` per line, `#` begins a comment");
    p.optional("elements", ByHand{"list of [elements](#skeletons-and-potentials)", "elements"},
               "potentials of points, segments, polygons and ellipsoids");
    p.one_of({"balls", "file", "elements"});
    p.normals();
  }
};

}  // namespace oktett
