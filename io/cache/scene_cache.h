#pragma once
/// \file Meshes and trees that are kept in a folder, so that the next run of the program need not read and
/// build them again.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "accel/build/tree_store.h"
#include "io/cache/cache_file.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett {

// ---- The folder of the cache: names, locks and room.

class CacheFolder {
 public:
  /// Makes the folder if there is none. `tell` gets what goes wrong, one line each. Throws Error if the
  /// folder cannot be made.
  CacheFolder(const std::string& path, std::uint64_t most_bytes,
              std::function<void(const std::string&)> tell);

  /// Held by the process that makes an entry, so that others wait for it instead of making it too.
  class Lock;
  /// Waits for the lock of an entry. If another process keeps it for two minutes, or if there can be no lock,
  /// the entry is made without one: that takes time, but does no harm.
  std::shared_ptr<Lock> lock(const std::string& name) const;

  /// Reads an entry by `read(file)`, if there is one. An entry that is damaged is reported, and counts as
  /// missing. Returns whether it was read.
  bool read(const std::string& name, const std::function<void(const CacheFile&)>& read) const;
  /// Writes an entry and removes those that were not used for the longest time, as far as room is needed.
  /// After the first problem nothing is written any more.
  void write(const std::string& name, std::string_view header, std::span<const CacheSection> sections,
             std::int64_t time);
  /// Tells of a problem, but only once.
  void tell_of(const std::string& message) const;

 private:
  std::string path_of(const std::string& name) const { return path_ + "/" + name; }
  void make_room(std::uint64_t bytes) const;

  std::string path_;
  std::uint64_t most_bytes_;
  std::function<void(const std::string&)> tell_;
  mutable std::mutex mutex_;
  mutable std::set<std::string> told_;
  std::atomic<bool> writes_{true};
};

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
