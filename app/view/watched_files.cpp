#include "app/view/watched_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

namespace oktett {

/// What changes with each edit, whether a file is written in place or replaced; empty if there is none.
static std::string look_at(const std::string& path) {
  struct stat s {};
  if (stat(path.c_str(), &s) != 0) return "";
  return fmt::format("{} {} {} {}", s.st_mtim.tv_sec, s.st_mtim.tv_nsec, s.st_size, s.st_ino);
}

void WatchedFiles::watch(const std::vector<std::string>& paths) {
  seen_.clear();
  for (const std::string& path : paths) seen_[path] = look_at(path);
}

bool WatchedFiles::have_changed() {
  bool changed = false;
  for (auto& [path, seen] : seen_) {
    std::string now = look_at(path);
    changed |= now != seen;
    seen = std::move(now);
  }
  return changed;
}

}  // namespace oktett
