#pragma once
/// \file Meshes that a scene shows: each file is read once. Within io/ only.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "render/scene.h"

namespace oktett {

/// ".obj" of "a.OBJ".
std::string lower_case_extension(const std::string& path);
/// One path for all that lead to the same file; `path` itself if there is no such file.
std::string canonical_path(const std::string& path);

/// True if `path` ends like a mesh file that can be read.
inline bool is_mesh_file(const std::string& path) { return lower_case_extension(path) == ".obj"; }

class MeshLibrary {
 public:
  struct Entry {
    std::shared_ptr<const TriangleMesh> mesh;
    std::vector<std::uint32_t>
        slot_materials;  ///< index into Scene::materials per slot; empty if the file names none
  };

  /// The mesh of a file that exists. The first time it is read and its materials, textures and warnings are
  /// appended to `scene`. Throws Error as load_obj does.
  const Entry& load(const std::string& path, Scene& scene);

 private:
  std::map<std::string, Entry> entries_;  ///< by canonical path
};

}  // namespace oktett
