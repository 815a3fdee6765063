#pragma once
/// \file Scenes that lie far from the origin. Rays are floats: far away they would not find details that
/// objects have.

#include <vector>

#include "core/error.h"
#include "render/scene.h"

namespace oktett {

/// Makes the place from which the positions of the object's mesh count (TriangleMesh::origin) a part of its
/// transform, and of its motion.
void place_mesh(Object& object);

/// Moves a scene that lies far from the origin near to it, and sets Scene::origin to the place from which all
/// counts then: where the first object stands that is far and holds a mesh that is far in its file; if there
/// is none but all that has bounds lies far (far_centre), with the camera if one is given, the centre of
/// that. Combinations and prototypes that hold such meshes are moved in their own spaces, and the transforms
/// of what shows them the other way. Does nothing to a scene that has an origin.
void recentre(Scene& scene);

/// A warning of the objects whose details rays cannot find, since they lie so far from where the scene counts
/// that floats keep fewer than 7 bits of their extent; empty if there are none.
std::vector<Warning> find_lost_digits(const Scene& scene);

}  // namespace oktett
