#pragma once
/// \file Meshes and trees that are kept in a folder, so that the next run of the program need not read and
/// build them again.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "accel/build/tree_store.h"
#include "io/cache/cache_folder.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett {

struct SceneCacheOptions {
  std::uint64_t most_bytes = std::uint64_t{16} << 30;   ///< in the folder
  std::size_t least_file_bytes = std::size_t{1} << 20;  ///< smaller meshes are read again
  std::size_t least_triangles = std::size_t{1} << 15;   ///< smaller trees are built again
  std::function<void(const std::string&)> tell;         ///< gets problems, one line each; may be empty
};

/// While an object of this class exists, load_scene and build_accel use the cache in its folder. Only one may
/// exist at a time. Any number of processes may use the same folder.
///
/// An entry of a mesh holds what parse_mesh makes of a file. It counts while the file has the same path,
/// size, number of the inode and times of its last change; materials are read from their files each time. An
/// entry of a tree is found by a hash of all that the tree depends on. What an entry says is checked before
/// it is used.
class SceneCache final : public TreeStore {
 public:
  /// Throws Error if there is no such folder and none can be made.
  explicit SceneCache(const std::string& folder, SceneCacheOptions options = {});
  ~SceneCache() override;
  SceneCache(const SceneCache&) = delete;
  SceneCache& operator=(const SceneCache&) = delete;

  /// The one that exists, or null.
  static SceneCache* current();

  /// As oktett::load_mesh.
  MeshFile load_mesh(const std::string& path, const MeshOptions& options = {});

  std::size_t least_triangles() const override { return options_.least_triangles; }
  bool load(std::uint64_t key, Accel& accel, ItemOrder& order) override;
  void refuse(std::uint64_t key, const std::string& why) override;
  void keep(std::uint64_t key, const Accel& accel, const ItemOrder& order) override;

 private:
  SceneCacheOptions options_;
  CacheFolder folder_;
  std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<CacheFolder::Lock>> building_;  ///< trees, by key
};

}  // namespace oktett
