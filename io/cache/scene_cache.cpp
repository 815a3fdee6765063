#include "io/cache/scene_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/bytes.h"
#include "core/error.h"
#include "io/cache/entries.h"
#include "io/mesh/load/parse_mesh.h"
#include "io/mesh/vertices.h"
#include "io/text/file_content.h"
#include "io/text/files.h"

namespace oktett {

// ---- The folder of the cache: names, locks and room.

namespace fs = std::filesystem;

namespace {

constexpr const char* kLockExtension = ".lock";
constexpr std::chrono::seconds kLongestWait{120};

bool is_entry(const fs::path& path) { return path.extension() == ".mesh" || path.extension() == ".tree"; }

}  // namespace

class CacheFolder::Lock {
 public:
  explicit Lock(const std::string& path)
      : file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666)) {
    const auto end = std::chrono::steady_clock::now() + kLongestWait;
    while (file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK &&
           std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ~Lock() {
    if (file_ >= 0) close(file_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int file_;
};

CacheFolder::CacheFolder(const std::string& path, std::uint64_t most_bytes,
                         std::function<void(const std::string&)> tell)
    : path_(path), most_bytes_(most_bytes), tell_(std::move(tell)) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path))
    throw Error(Location{path}, "no folder for the cache: " + (error ? error.message() : "is a file"),
                ErrorKind::io);
}

std::shared_ptr<CacheFolder::Lock> CacheFolder::lock(const std::string& name) const {
  return std::make_shared<Lock>(path_of(name) + kLockExtension);
}

void CacheFolder::tell_of(const std::string& message) const {
  const std::lock_guard guard(mutex_);
  if (told_.insert(message).second && tell_) tell_(message);
}

bool CacheFolder::read(const std::string& name, const std::function<void(const CacheFile&)>& read) const {
  const std::string path = path_of(name);
  if (access(path.c_str(), F_OK) != 0) return false;
  try {
    const CacheFile file(path);
    read(file);
    return true;
  } catch (const Error& error) {
    tell_of(std::string(error.what()) + "; not used");
    return false;
  }
}

void CacheFolder::make_room(std::uint64_t bytes) const {
  struct Entry {
    fs::file_time_type time;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uint64_t total = bytes;
  std::error_code error;
  for (fs::directory_iterator it(path_, error), end; !error && it != end; it.increment(error)) {
    if (!is_entry(it->path())) continue;
    std::error_code gone;
    const std::uint64_t size = it->file_size(gone);
    const fs::file_time_type time = it->last_write_time(gone);
    if (gone) continue;
    entries.push_back({time, size, it->path()});
    total += size;
  }
  std::ranges::sort(entries, {}, &Entry::time);
  for (const Entry& entry : entries) {
    if (total <= most_bytes_) return;
    fs::remove(entry.path, error);
    fs::remove(entry.path.string() + kLockExtension, error);
    total -= entry.bytes;
  }
}

void CacheFolder::write(const std::string& name, std::string_view header,
                        std::span<const CacheSection> sections, std::int64_t time) {
  if (!writes_) return;
  const std::uint64_t bytes = cache_file_bytes(header, sections);
  if (bytes > most_bytes_) return;
  try {
    make_room(bytes);
    write_cache_file(path_of(name), header, sections, time);
  } catch (const Error& error) {
    writes_ = false;
    tell_of(std::string(error.what()) + "; the cache is not written");
  }
}

namespace {

std::atomic<SceneCache*> current_cache{nullptr};

/// File systems may give two changes within this time the same time.
constexpr std::int64_t kTick = 2'000'000'000;

/// Nanoseconds since 1970.
std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_REALTIME, &time);
  return nanoseconds(time);
}

/// The stamp of a file that may be read; nothing for all others.
std::optional<FileStamp> stamp_of(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return std::nullopt;
  struct stat s {};
  const bool good = fstat(file, &s) == 0 && why_unreadable(file).empty();
  close(file);
  if (!good) return std::nullopt;
  return FileStamp{static_cast<std::uint64_t>(s.st_size), static_cast<std::uint64_t>(s.st_ino),
                   nanoseconds(s.st_mtim), nanoseconds(s.st_ctim)};
}

std::uint64_t content_checksum(const std::string& path) { return checksum(MappedFile(path).text()); }

/// Fills in what the cache holds of the file with the path and stamp of `entry`; false if that is nothing.
bool read_mesh(const CacheFolder& folder, const std::string& name, const std::string& path,
               MeshEntry& entry) {
  bool found = false;
  folder.read(name, [&](const CacheFile& file) {
    const std::int64_t start = now();
    MeshEntry kept = read_mesh_header(file);
    if (kept.path != entry.path || kept.stamp != entry.stamp) return;
    // The file may have changed again, at the same time by its file system's clock, after it was read.
    const bool settled = file.time() >= kept.stamp.status_time + kTick;
    if (!settled && content_checksum(path) != kept.checksum) return;
    read_mesh_columns(file, kept);
    if (start >= kept.stamp.status_time + kTick) file.touch();
    entry = std::move(kept);
    found = true;
  });
  return found;
}

std::string tree_name(std::uint64_t key) { return fmt::format("{:016x}.tree", key); }

}  // namespace

SceneCache::SceneCache(const std::string& folder, SceneCacheOptions options)
    : options_(std::move(options)), folder_(folder, options_.most_bytes, options_.tell) {
  current_cache = this;
  set_tree_store(this);
}

SceneCache::~SceneCache() {
  set_tree_store(nullptr);
  current_cache = nullptr;
}

SceneCache* SceneCache::current() { return current_cache; }

MeshFile SceneCache::load_mesh(const std::string& path, const MeshOptions& options) {
  const std::optional<FileStamp> stamp = stamp_of(path);
  // What is wrong with the file is said by load_mesh.
  if (!stamp || stamp->size < options_.least_file_bytes || !can_parse_mesh(path))
    return oktett::load_mesh(path, options);
  MeshEntry entry;
  std::error_code error;
  entry.path = std::filesystem::canonical(path, error).string();
  entry.stamp = *stamp;
  const std::string name = fmt::format("{:016x}.mesh", checksum(entry.path + "\n" OKTETT_VERSION));
  bool found = read_mesh(folder_, name, path, entry);
  if (!found) {
    const std::shared_ptr<CacheFolder::Lock> lock = folder_.lock(name);
    found = read_mesh(folder_, name, path, entry);
    if (!found) {
      const std::int64_t start = now();
      entry.parsed = parse_mesh(path);
      entry.checksum = content_checksum(path);
      if (stamp_of(path) == stamp) folder_.write(name, mesh_header(entry), mesh_sections(entry), start);
    }
  }
  note_file_read(path);
  if (found) note_content(path, entry.checksum);
  MeshFile file = finish_mesh(path, std::move(entry.parsed));
  if (options.weld) weld_positions(file.mesh);
  return file;
}

bool SceneCache::load(std::uint64_t key, Accel& accel, ItemOrder& order) {
  const std::string name = tree_name(key);
  const auto read = [&] {
    return folder_.read(name, [&](const CacheFile& file) {
      read_tree(file, key, accel, order);
      file.touch();
    });
  };
  if (read()) return true;
  std::shared_ptr<CacheFolder::Lock> lock = folder_.lock(name);
  if (read()) return true;
  const std::lock_guard guard(mutex_);
  building_[key] = std::move(lock);
  return false;
}

void SceneCache::refuse(std::uint64_t key, const std::string& why) {
  folder_.tell_of(tree_name(key) + " in the cache: " + why + "; not used");
}

void SceneCache::keep(std::uint64_t key, const Accel& accel, const ItemOrder& order) {
  std::vector<std::uint32_t> items;
  const std::vector<CacheSection> sections = tree_sections(accel, order, items);
  folder_.write(tree_name(key), tree_header(key, accel, order), sections, now());
  const std::lock_guard guard(mutex_);
  building_.erase(key);
}

}  // namespace oktett
