#pragma once
/// \file Points and lines of meshes as shapes: balls, and round cylinders between them.

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "core/surface_interaction.h"

namespace oktett {

/// Which stroke each ball and cylinder of a mesh of points and lines belongs to; see MeshShape::stroke_width.
struct StrokeParts {
  std::shared_ptr<const TriangleMesh> strokes;
  /// The stroke at whose end ball k of the first geometry lies; empty without lines: ball k is stroke k.
  std::vector<std::uint32_t> balls;
  std::vector<std::uint32_t> cylinders;  ///< the stroke that geometry k + 1 shows

  /// The place on its stroke, as a triangle of `strokes`, of a surface met at `place` in the strokes' space.
  MeshPoint at(const SurfaceInteraction& surface, const Vec3d& place) const;
};

/// Adds the geometries of all strokes to `out`, which is empty: first one of all balls, of this radius, then
/// a cylinder for each line that has a length. `user`: the number of the object.
StrokeParts add_strokes(std::shared_ptr<const TriangleMesh> strokes, double radius, std::uint32_t user,
                        std::vector<Geometry>& out);

}  // namespace oktett
