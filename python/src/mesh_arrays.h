#pragma once
/// \file Meshes made of arrays, and arrays made of meshes.

#include <memory>

#include "core/mesh.h"
#include "python/src/arrays.h"
#include "python/src/scene_store.h"

namespace oktett::python {

/// What Python gives for a mesh; all but the first two may be None.
struct MeshArrays {
  py::object vertices, faces;
  py::object normals = py::none(), uvs = py::none(), colors = py::none(), attributes = py::none();
};

/// A mesh of copies of the arrays. Throws ValueError for other shapes and types, and for indices out of
/// range.
std::shared_ptr<const TriangleMesh> make_mesh(const MeshArrays& arrays);

/// The new positions and normals (None: none) of vertices from number `first` on. Throws ValueError.
MeshChange make_change(const py::object& vertices, std::size_t first, const py::object& normals);

/// All columns of a mesh, for pickles; and the mesh again.
py::tuple columns_of(const TriangleMesh& mesh);
std::shared_ptr<const TriangleMesh> mesh_of(const py::tuple& columns);

}  // namespace oktett::python
