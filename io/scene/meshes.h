#pragma once
/// \file Meshes that a scene shows: each file is read once. Within io/ only.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "io/mesh/load/load_mesh.h"
#include "render/scene.h"

namespace oktett {

/// One path for all that lead to the same file; `path` itself if there is no such file.
std::string canonical_path(const std::string& path);

/// Images that cannot be read at all are named in the warnings of `file`, where the statement that names
/// them is known. Their textures lose the path, and are white.
void check_textures(MeshFile& file);

/// Appends the materials and textures of `file` to `scene` and returns the new index of each material.
std::vector<std::uint32_t> append_materials(MeshFile& file, Scene& scene);

/// Adds a warning for each texture that shows an attribute which an object of its material has not, where it
/// is white.
void warn_of_attributes(Scene& scene);

class MeshLibrary {
 public:
  struct Entry {
    std::shared_ptr<const TriangleMesh> mesh;
    std::vector<std::uint32_t>
        slot_materials;                ///< index into Scene::materials per slot; empty if the file names none
    std::vector<MeshShape> strokes{};  ///< MeshFile::strokes, those of each slot for itself, without a width

    /// The strokes of this width; of 0: as wide as usual, with a warning that belongs to `where`.
    std::vector<MeshShape> stroke_shapes(double width, const Location& where,
                                         std::vector<Warning>& warnings) const;
  };

  /// The mesh of a file that exists. The first time it is read and its materials, textures and warnings are
  /// appended to `scene`. Throws Error as load_mesh does.
  const Entry& load(const std::string& path, const MeshOptions& options, Scene& scene);

  /// Adds a mesh without a file, which scene files of its scene refer to by a name.
  void add(const std::string& name, std::shared_ptr<const TriangleMesh> mesh);
  /// The one of this name; null if there is none.
  const Entry* find(const std::string& name) const;

  /// What was loaded with this mesh.
  const Entry& entry_of(const TriangleMesh& mesh) const;

  /// What `file` brings to `scene`, where it is not kept in a library.
  static Entry add(MeshFile file, Scene& scene);

 private:
  std::map<std::pair<std::string, bool>, Entry> entries_;  ///< by canonical path and MeshOptions::weld
  std::map<const TriangleMesh*, const Entry*> entry_of_;
};

}  // namespace oktett
