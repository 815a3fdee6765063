#pragma once
/// \file What shading needs to know about a hit.

#include <cstdint>

#include "core/mesh.h"
#include "core/vec3.h"

namespace oktett {

/// The surface at a hit. Normals have unit length and point out of solids (for open surfaces: to the front
/// side), whatever side the ray came from.
struct SurfaceInteraction {
  Vec3f position;
  Vec3f position_error;  ///< per component; what it bounds is guarantee 4 of docs/numerics.md
  Vec3f geometric_normal;
  Vec3f shading_normal;  ///< interpolated from the mesh if it is smooth, else the geometric normal
  Vec3f tangent;         ///< dp/du, not normalised; zero where the shape has no uv, or at a pole
  Vec3f bitangent;       ///< dp/dv, likewise
  Vec2f uv;
  std::uint32_t geometry = kNoId;   ///< index of the geometry in the structure that holds it
  std::uint32_t primitive = kNoId;  ///< index inside the geometry, e.g. the triangle of a mesh
  std::uint32_t user = kNoId;       ///< the geometry's `user`, or that of the outermost instance that has one
  std::uint32_t material_slot = 0;  ///< of a triangle: its entry in TriangleMesh::material_slots
};

}  // namespace oktett
