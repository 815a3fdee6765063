#pragma once
/// \file Which objects of a scene have an inside, and which of these light enters.

#include <cstdint>
#include <vector>

#include "core/error.h"
#include "render/scene.h"

namespace oktett {

/// Whether the shape has an inside. A mesh that is not closed has none, unless it is `by_winding`; an
/// instance has one if all objects of its prototype have.
bool is_solid(const Shape& shape, const std::vector<Prototype>& prototypes);

/// Whether light that enters the object is inside of something: the object is solid, or those triangles of
/// its mesh are closed by themselves whose materials let light in, such as a glass with its label.
bool has_inside(const Object& object, const Scene& scene);

/// Whether the object bounds an inside that light enters.
bool is_entered(const Object& object, const Scene& scene);

/// Throws Error at `where` if light enters the object, or what it shows, of this outer material; kNoId: of
/// its own.
void check_not_entered(const Object& object, std::uint32_t outer, const Scene& scene, const Location& where);

/// Whether paths must know which solids they are in.
bool needs_dielectrics(const Scene& scene);

/// Whether fog or media fill the ways of rays in Whitted's model.
bool needs_insides(const Scene& scene);

}  // namespace oktett
