#pragma once
/// \file Ending a render early when a signal arrives.

#include <atomic>

namespace oktett {

/// While an object of this class exists, the first SIGINT, SIGTERM, SIGHUP or SIGALRM (of --timeout) sets a
/// flag. A second one that is not SIGALRM ends the process at once. Only one object may exist at a time.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  const std::atomic<bool>* flag() const;
  /// The signal that came, or 0.
  int signal() const;
};

}  // namespace oktett
