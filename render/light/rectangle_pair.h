#pragma once
/// \file Rectangles that meshes hold as two triangles.

#include <optional>

#include "render/light/emitter.h"

namespace oktett {

/// The rectangle that two triangles of the same light cover, within a millionth of its size. As one emitter
/// it is sampled with less noise and in lanes.
std::optional<RectangleEmitter> rectangle_of(const TriangleEmitter& a, const TriangleEmitter& b);

}  // namespace oktett
