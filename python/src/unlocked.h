#pragma once
/// \file Long work without the interpreter's lock, which Ctrl-C can end.

#include <pybind11/pybind11.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>

namespace oktett::python {

/// Runs `work` on a thread of its own while this one waits without the interpreter's lock and calls `poll`,
/// with the lock, about twenty times a second. When a signal handler or `poll` raises, calls `stop` and lets
/// `work` come to its end before the exception goes on. Rethrows what `work` throws.
void run_watched(const std::function<void()>& work, const std::function<void()>& stop = {},
                 const std::function<void()>& poll = {});

/// Calls work(begin, end) for consecutive parts of [0, count), without the interpreter's lock, and lets
/// signal handlers run in between. The parts are as large as take about a tenth of a second.
template <class Work>
void run_in_parts(std::size_t count, const Work& work) {
  using Clock = std::chrono::steady_clock;
  pybind11::gil_scoped_release unlocked;
  std::size_t part = std::size_t{1} << 14;
  for (std::size_t begin = 0; begin < count;) {
    const std::size_t end = begin + std::min(part, count - begin);
    const auto start = Clock::now();
    work(begin, end);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (seconds < 0.05)
      part *= 4;
    else if (seconds > 0.2 && part > 4096)
      part /= 2;
    begin = end;
    if (begin == count) return;
    pybind11::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }
}

}  // namespace oktett::python
