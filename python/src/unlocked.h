#pragma once
/// \file Long work without the interpreter's lock, which Ctrl-C can end.

#include <pybind11/pybind11.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <thread>

#include "python/src/pieces.h"

namespace oktett::python {

/// Runs `work` on a thread of its own while this one waits without the interpreter's lock and calls `poll`,
/// with the lock, about twenty times a second. When a signal handler or `poll` raises, calls `stop` and lets
/// `work` come to its end before the exception goes on. Rethrows what `work` throws.
void run_watched(const std::function<void()>& work, const std::function<void()>& stop = {},
                 const std::function<void()>& poll = {});

/// Lets signal handlers run now and then while the calling thread works without the interpreter's lock.
class SignalWatch {
 public:
  /// Called on any thread between pieces of work. On the one that made the object, which has to be the one
  /// that Python called, it looks for signals about twenty times a second.
  void poll();
  /// True when a handler has raised an exception: the work should come to its end.
  bool stopped() const { return stopped_; }
  /// Throws that exception, if there is one. With the lock.
  void rethrow() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::thread::id thread_ = std::this_thread::get_id();
  Clock::time_point last_ = Clock::now();
  std::atomic<bool> stopped_ = false;
  std::exception_ptr raised_;
};

/// Calls work(k) for k in [0, count) in parallel, without the interpreter's lock. Ctrl-C ends it.
template <class Work>
void run_tasks(std::size_t count, const Work& work) {
  SignalWatch watch;
  {
    const pybind11::gil_scoped_release unlocked;
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      if (watch.stopped()) return;
      work(k);
      watch.poll();
    });
  }
  watch.rethrow();
}

/// Calls work(begin, end) for the pieces of [0, size) likewise.
template <class Work>
void run_in_pieces(std::size_t size, const Work& work) {
  run_tasks(pieces_of(size), [&](std::size_t k) { work(k * kPiece, std::min(size, (k + 1) * kPiece)); });
}

}  // namespace oktett::python
