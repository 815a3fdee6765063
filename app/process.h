#pragma once
/// \file How the command meets what the system refuses (memory, threads, large files, closed streams), and
/// signals.

#include <atomic>

namespace oktett {

/// Call first. From then on a file that grows too large or a reader that has gone is an error of the call
/// that writes, not a signal that ends the process; an exception that nobody can catch and a refused stack
/// end the process with one line and a documented status, and without temporary files.
void prepare_process();

/// Starts oneTBB while there is memory for it, or throws std::bad_alloc: where the memory for its first arena
/// is refused, oneTBB 2022.1 throws while it holds a lock that throwing takes, and waits for ever.
void start_tasks();

/// Prints one line about the exception that is being handled. Returns the exit status for it.
int report_current_exception();

/// Flushes standard output. If some of the output was lost, prints one line and
/// returns kExitIo instead of a `status` of 0.
int finish_output(int status);

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
