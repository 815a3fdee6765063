#pragma once
/// \file What takes long, while it is done, for whoever shows how far the program is; and how much time has
/// passed.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace oktett {

/// How far a phase is.
struct PhaseState {
  const char* kind = "";    ///< "reading", "building"
  std::string what;         ///< "bunny.obj", "1,234 triangles"
  std::uint64_t done = 0;   ///< bytes or items
  std::uint64_t total = 0;  ///< 0: not known
  double seconds = 0;       ///< since it began
};

/// From here on, `watcher` is called when a phase begins and about ten times a second while it goes on, by
/// one thread at a time; empty: nobody watches. For the whole process. Phases that exist are not watched.
void watch_phases(std::function<void(const PhaseState&)> watcher);

/// Exists while something takes long. Without a watcher it costs nothing.
class Phase {
 public:
  /// `kind` must live as long as the program.
  Phase(const char* kind, std::string what, std::uint64_t total);

  /// So much more is done. Threads may call it at the same time, but not for less than takes microseconds.
  void add(std::uint64_t amount) {
    if (is_watched_) report(amount);
  }

 private:
  void report(std::uint64_t amount);

  const char* const kind_;
  const std::string what_;
  const std::uint64_t total_;
  const std::chrono::steady_clock::time_point start_;
  const bool is_watched_;
  std::atomic<std::uint64_t> done_{0};
};

/// Seconds from `start` to now, by a clock that nobody sets.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace oktett
