#pragma once
/// \file How much time has passed.

#include <chrono>

namespace oktett {

/// Seconds from `start` to now, by a clock that nobody sets.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace oktett
