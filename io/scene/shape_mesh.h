#pragma once
/// \file Meshes of shapes that are made of triangles, or nearly. Within io/ only.

#include <cstdint>
#include <optional>
#include <string>

#include "core/mesh.h"
#include "render/scene.h"

namespace oktett {

/// What messages call a shape, such as "torus".
std::string shape_name(const Shape& shape);

/// The mesh of a triangle, a box, a disk, whose circles become polygons of `around` corners on them, or a
/// polygon without holes, in the shape's own space, with normals; nothing for all others.
std::optional<TriangleMesh> plain_mesh(const Shape& shape, std::uint32_t around);

/// Leaves out what is smaller than a cell of a grid with `cells` along the shape: the last generations of
/// fractals, of operands of combinations, too.
void leave_out_details(Shape& shape, std::uint32_t cells);

}  // namespace oktett
