#pragma once
/// \file Which objects of a scene have an inside.

#include "kernels/exact_form.h"
#include "render/scene.h"

namespace oktett {

/// Whether the shape has an inside. A mesh that is not closed has none, unless it is `by_winding`; an
/// instance has one if all objects of its prototype have.
bool is_solid(const Shape& shape, const std::vector<Prototype>& prototypes);

}  // namespace oktett
