#pragma once
/// \file Fields of one kind of shape over a floor, described for both POV-Ray and Oktett.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/ray.h"
#include "core/surface_interaction.h"
#include "render/scene.h"
#include "verify/oracles/exact.h"

namespace oktett::bench {

/// One object of a field: as POV-Ray reads it, as Oktett traces it, and its equation.
struct FieldObject {
  std::string pov;  ///< in its own space, without texture
  Shape shape;
  /// Negative inside, in the space of the shape.
  SurfaceFunction f;
};

/// A kind of shape. `make` describes one with parameters that depend on six random numbers of [0, 1).
struct FieldKind {
  std::string name;
  int count;  ///< objects in the field, a square number
  FieldObject (*make)(const double (&r)[6]);
};

std::vector<FieldKind> field_kinds();
/// The kind that is a height field instead of a field of objects: a terrain of kTerrainSide^2 samples.
inline constexpr const char* kTerrainKind = "heightfield";
inline constexpr std::uint32_t kTerrainSide = 4096;

/// A cube with rounded corners and three bores.
FieldObject rounded_cube(const double (&r)[6]);
/// A plate with a thousand holes.
FieldObject drilled_plate(const double (&r)[6]);

/// A field for both. POV-Ray's space is left-handed, so its picture is Oktett's, mirrored from left to right.
struct Field {
  Scene scene;               ///< for Oktett; objects 0, 1, ... and the floor last, each with its own material
  std::string pov, pov_ids;  ///< the same for POV-Ray, lit; and each object in a colour that numbers it
  std::vector<FieldObject> objects;  ///< without the floor
  /// If set, the number of the colour at a hit of Oktett's, and the one that is right for a ray.
  std::function<std::uint32_t(const SurfaceInteraction&)> id;
  std::function<std::uint32_t(const Ray&)> right;
};

Field make_field(const FieldKind& kind, std::uint32_t width, std::uint32_t height);
/// The terrain; the file of its heights for POV-Ray goes to `directory`.
Field make_terrain_field(std::uint32_t width, std::uint32_t height, const std::string& directory);

// What all fields share.
std::string field_head(bool ids);
std::string id_color(std::uint32_t id);
Material field_material(const Color& color);
Scene empty_field(std::uint32_t width, std::uint32_t height);

}  // namespace oktett::bench
