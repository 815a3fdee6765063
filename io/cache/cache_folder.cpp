#include "io/cache/cache_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"

namespace oktett {

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

}  // namespace oktett
