#pragma once
/// \file What a Scene of Python holds: a scene, what it was read from, and the structure that answers
/// queries.

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "accel/dynamic_accel.h"
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

/// Whether a vector given as a normal is one: finite, and of any length but zero.
inline bool is_normal(const Vec3f& n) {
  const float square = dot(n, n);
  return square > 0 && std::isfinite(square);
}

/// New positions and normals of the vertices of a mesh from number `first` on.
struct MeshChange {
  std::size_t first = 0;
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;  ///< one for each of the positions, or none
  bool are_floats = false;     ///< the positions were given in float32
};

/// Images of some textures of a scene, from its texture number `first` on.
struct TexturePart {
  std::size_t first;
  std::shared_ptr<const TextureSampler> images;
};
using TextureParts = std::vector<TexturePart>;

/// A scene to which meshes can be added, and whose objects can be changed. The acceleration structure is
/// brought up to date when it is next needed: that of the objects that were read is built anew if one of them
/// has changed, and meshes that were added have trees of their own (DynamicAccel). Any number of threads may
/// use one object.
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

  // Changes of an object by its number. They wait while another thread builds, and throw Error if there is no
  // such object, if it was removed, or if it stands in a prototype or a combination.

  /// Replaces the transform that the object was added or described with.
  void set_transform(std::uint32_t number, const Affine& transform);
  /// Moves vertices of a mesh that was added.
  void set_vertices(std::uint32_t number, const MeshChange& change);
  /// Rays, points and pictures meet an object while it is enabled.
  void set_enabled(std::uint32_t number, bool enabled);
  /// For good. The numbers of the others stay.
  void remove(std::uint32_t number);
  /// What rays meet a mesh that was added, see DynamicAccel::set_mask.
  void set_mask(std::uint32_t number, std::uint32_t mask);

  /// For rays with this mask. Waits while another thread builds.
  std::shared_ptr<const PlacedWorld> world(std::uint32_t mask = ~0u);
  /// For rays with each of these masks, all of the same state of the scene. Throws Error if more than
  /// kMostMasks of them see different things.
  std::vector<std::shared_ptr<const PlacedWorld>> worlds(const std::vector<std::uint32_t>& masks);
  static constexpr std::size_t kMostMasks = 64;
  /// While it is held changes wait.
  std::unique_lock<std::mutex> hold() { return std::unique_lock(building_); }
  /// Null if it has to be built. Never waits.
  std::shared_ptr<const PlacedWorld> built_world(std::uint32_t mask = ~0u) const;
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
  /// What has become of an object, beside the vertices and the transform of one that was added.
  struct Change {
    std::uint32_t number;
    bool enabled, removed;
    std::uint32_t mask;
    std::optional<Affine> transform;  ///< of one that was read, if it was set
  };
  /// Those of the objects that are not as they were.
  std::vector<Change> changes() const;
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

  /// What an object has become since it was read or added.
  struct ObjectState {
    bool enabled = true, removed = false;
    std::uint32_t mask = ~0u;
    std::optional<Affine> transform{};  ///< of one that was read, if it was set
  };
  /// The index of the object among those of the scene. Throws Error.
  std::size_t find(std::uint32_t number) const;
  AddedMesh& find_added(std::uint32_t number, const char* what);
  /// Where the object of a mesh that was added stands.
  void place(const AddedMesh& added, Object& object) const;
  /// With a positions of its own, as it is after a change. Nothing if no new centre has to be found.
  std::shared_ptr<const TriangleMesh> replaced(const AddedMesh& added, const MeshChange& change) const;
  /// One of the masks that see the same as this one: the same for all of them.
  std::uint32_t least_mask(std::uint32_t mask) const;
  void note_change(std::size_t object);
  /// Without what is not shown.
  Scene shown_scene() const;
  World build(const Scene& scene, std::uint32_t mask);
  std::shared_ptr<const PlacedWorld> world_while_held(std::uint32_t mask);
  /// Whether places of the object's own space are not those that it was described with.
  bool is_shifted(const Object& object) const;

  std::mutex building_;  ///< held while textures are read or a structure is built; before mutex_
  /// The structure of the meshes that were added, and the numbers that they have in it; number 0 is an
  /// instance of `others_`, the world of what was read. Used while `building_` is held.
  std::optional<DynamicAccel> top_;
  std::vector<std::uint32_t> in_top_;
  std::shared_ptr<const World> others_;
  std::uint64_t others_changes_ = 0;
  Vec3d others_origin_;

  mutable std::mutex mutex_;        ///< of all members below, held for moments only
  std::uint64_t changes_ = 0;       ///< of what the structure depends on
  std::uint64_t read_changes_ = 0;  ///< of objects that were read, and of materials
  Scene scene_;
  std::size_t read_objects_ = 0;        ///< the first ones of the scene; the others were added
  std::vector<ObjectState> states_;     ///< of the objects of the scene
  std::vector<std::uint32_t> numbers_;  ///< likewise, ascending
  const Files* reader_ = nullptr;       ///< null: the scene was not read
  std::string path_;                    ///< empty likewise
  Definitions definitions_;
  FileContents files_;                     ///< those that were given, by path
  std::map<std::string, FileState> read_;  ///< those that were read from the disk
  std::vector<AddedMesh> added_;
  BuildQuality quality_ = BuildQuality::balanced;
  std::map<std::uint32_t, std::shared_ptr<const PlacedWorld>> worlds_;  ///< those that are built, by mask
  std::shared_ptr<const TextureSampler> textures_;
  std::size_t own_textures_ = 0;  ///< those that were read with the scene
  TextureParts added_textures_;   ///< of materials that were added
  std::set<std::string> said_;    ///< of the warnings of lost digits
};

/// How many numbers build_world gives to the objects of `scene`.
std::uint32_t object_count(const Scene& scene);

}  // namespace oktett::python
