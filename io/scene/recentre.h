#pragma once
/// \file Scenes that lie far from the origin. Within io/ only.

#include "render/scene.h"

namespace oktett {

/// If the scene shows a mesh that lies far from the origin (TriangleMesh::origin), moves all of the scene so
/// that this mesh is near it, and sets Scene::origin to the place from which all counts then. Rays are
/// floats: far away they would not find details that the mesh has.
void recentre(Scene& scene);

}  // namespace oktett
