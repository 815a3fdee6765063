#include "core/phase.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace oktett {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPause = std::chrono::milliseconds(100);

std::atomic<bool> is_watched = false;
/// When a watcher is called again, as a count of the clock.
std::atomic<Clock::rep> next_call = 0;
std::mutex watching;
std::function<void(const PhaseState&)> current_watcher;  ///< guarded by `watching`
const char* last_kind = nullptr;                         ///< likewise

}  // namespace

void watch_phases(std::function<void(const PhaseState&)> watcher) {
  const std::lock_guard lock(watching);
  is_watched = static_cast<bool>(watcher);
  current_watcher = std::move(watcher);
  last_kind = nullptr;
  next_call = 0;
}

Phase::Phase(const char* kind, std::string what, std::uint64_t total)
    : kind_(kind), what_(std::move(what)), total_(total), start_(Clock::now()), is_watched_(is_watched) {
  if (is_watched_) report(0);
}

void Phase::report(std::uint64_t amount) {
  const std::uint64_t done = done_.fetch_add(amount, std::memory_order_relaxed) + amount;
  const Clock::time_point now = Clock::now();
  const bool is_due = now.time_since_epoch().count() >= next_call.load(std::memory_order_relaxed);
  // Of a new kind the beginning is shown, however short it is.
  if (!is_due && done > 0) return;
  const std::unique_lock lock(watching, std::try_to_lock);
  if (!lock || !current_watcher || (!is_due && last_kind == kind_)) return;
  last_kind = kind_;
  next_call = (now + kPause).time_since_epoch().count();
  const std::uint64_t shown = total_ > 0 ? std::min(done, total_) : done;
  current_watcher({kind_, what_, shown, total_, std::chrono::duration<double>(now - start_).count()});
}

}  // namespace oktett
