#pragma once
/// \file Points and lines of meshes as shapes: balls, and round cylinders between them.

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "core/surface_interaction.h"

namespace oktett {

/// What of which stroke the geometries of a mesh of points and lines show; see MeshShape::stroke_width.
struct StrokeParts {
  std::shared_ptr<const TriangleMesh> strokes;
  /// Of ball k of the first geometry, the stroke that it ends; empty: each stroke is the ball of its number.
  /// The geometries behind it are the strokes of `cylinders` in their order.
  std::vector<std::uint32_t> balls, cylinders;

  /// The place on its stroke, as a triangle of `strokes`, of a surface met at `place` in the strokes' space.
  MeshPoint at(const SurfaceInteraction& surface, const Vec3d& place) const;
};

/// Adds the geometries of all strokes to `out`, which is empty, for an object with the number `user`: balls
/// of this radius, the first one, and if there are lines a cylinder for each.
StrokeParts add_strokes(std::shared_ptr<const TriangleMesh> strokes, double radius, std::uint32_t user,
                        std::vector<Geometry>& out);

}  // namespace oktett
