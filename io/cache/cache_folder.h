#pragma once
/// \file The folder of the cache: names, locks and room. Within io/ only.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "io/cache/cache_file.h"

namespace oktett {

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

  /// Reads an entry by `read(file)`, if there is one. An entry that is damaged is told of, and counts as
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

}  // namespace oktett
