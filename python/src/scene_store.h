#pragma once
/// \file What a Scene of Python holds: a scene, what it was read from, and the structure that answers
/// queries.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"
#include "python/src/files.h"
#include "render/geometry.h"
#include "render/picture/render.h"
#include "render/scene.h"

namespace oktett::python {

/// A mesh that was added from arrays.
struct AddedMesh {
  std::shared_ptr<const TriangleMesh> mesh;
  Affine transform;
  std::string name;
  std::string material_name{};  ///< of a material in the scene; empty for none
  /// A scene file of one material, named kMaterialFile, and files that it names; empty for none.
  FileContents material_files{};
  std::vector<std::string> material_paths{};  ///< files that it names on the disk

  static constexpr const char* kMaterialFile = "<material>.yaml";
  /// The first with the second. Throws Error of kind io.
  FileContents material_contents() const;
};

/// What is traced, the place from which it counts (Scene::origin), and what find_lost_digits warns of.
struct PlacedWorld : World {
  Vec3d origin;
  std::vector<Warning> lost_digits;
};

/// Images of some textures of a scene, from its texture number `first` on.
struct TexturePart {
  std::size_t first;
  std::shared_ptr<const TextureSampler> images;
};
using TextureParts = std::vector<TexturePart>;

/// A scene to which meshes can be added. The acceleration structure is built when it is first needed. Any
/// number of threads may use one object.
class SceneStore {
 public:
  SceneStore() = default;

  /// Reads the scene file or mesh `path` by `reader`, with `files` in place of the files of their names.
  static std::shared_ptr<SceneStore> load(const Files& reader, const std::string& path,
                                          const Definitions& definitions, FileContents files);

  /// Adds an object and returns its number. The structure is built anew by the next query. `reader` is asked
  /// for what reads the material, if there is one to read. Throws Error, also if there is no material of that
  /// name.
  std::uint32_t add(AddedMesh added, const Files& (*reader)());

  /// Waits while another thread builds.
  std::shared_ptr<const PlacedWorld> world();
  /// Null if it has to be built. Never waits.
  std::shared_ptr<const PlacedWorld> built_world() const;
  /// The images of the scene's textures, read by the first call; null if the scene was not read from files.
  std::shared_ptr<const TextureSampler> textures();
  /// With all that was added, and near the place from which it counts if it lies far from the origin.
  Scene scene() const;
  /// Those of reading.
  std::vector<Warning> warnings() const;
  /// The texts of `warnings` that were not returned before.
  std::vector<std::string> take_unsaid(const std::vector<Warning>& warnings);
  std::uint32_t object_count() const;

  /// What load() has to be given so that it makes the same scene, whatever becomes of the files. Throws Error
  /// if one of them has changed since.
  FileContents contents() const;
  const std::string& path() const { return path_; }
  const Definitions& definitions() const { return definitions_; }
  std::vector<AddedMesh> added() const;
  void set_quality(BuildQuality quality);
  BuildQuality quality() const;

 private:
  /// A file as it was when it was read.
  struct FileState {
    std::int64_t modified = 0;  ///< ns
    std::uint64_t size = 0;
    bool operator==(const FileState&) const = default;
  };
  static FileState state_of(const std::string& path);
  /// Adds a material that was read alone; returns its number.
  std::uint32_t append_material(SceneRead read);

  std::mutex building_;        ///< held while textures are read or a structure is built; before mutex_
  mutable std::mutex mutex_;   ///< of all members below, held for moments only
  std::uint64_t changes_ = 0;  ///< of what the structure depends on
  Scene scene_;
  const Files* reader_ = nullptr;  ///< null: the scene was not read
  std::string path_;               ///< empty likewise
  Definitions definitions_;
  FileContents files_;                     ///< those that were given, by path
  std::map<std::string, FileState> read_;  ///< those that were read from the disk
  std::vector<AddedMesh> added_;
  BuildQuality quality_ = BuildQuality::balanced;
  std::shared_ptr<const PlacedWorld> world_;  ///< null: to be built
  std::shared_ptr<const TextureSampler> textures_;
  std::size_t own_textures_ = 0;  ///< those that were read with the scene
  TextureParts added_textures_;   ///< of materials that were added
  std::set<std::string> said_;    ///< of the warnings of lost digits
};

/// How many numbers build_world gives to the objects of `scene`.
std::uint32_t object_count(const Scene& scene);

}  // namespace oktett::python
