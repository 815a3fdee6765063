#include "python/src/unlocked.h"

#include <condition_variable>
#include <mutex>

namespace oktett::python {

void run_watched(const std::function<void()>& work, const std::function<void()>& stop,
                 const std::function<void()>& poll) {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr failure;
  std::thread worker([&] {
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    done = true;
    ended.notify_one();
  });
  std::exception_ptr raised;
  {
    pybind11::gil_scoped_release unlocked;
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
      lock.unlock();
      if (raised == nullptr) {
        const pybind11::gil_scoped_acquire locked;
        try {
          if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
          if (poll) poll();
        } catch (...) {
          raised = std::current_exception();
          if (stop) stop();
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (raised != nullptr) std::rethrow_exception(raised);
  if (failure != nullptr) std::rethrow_exception(failure);
}

void SignalWatch::poll() {
  if (std::this_thread::get_id() != thread_ || stopped_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(50)) return;
  last_ = now;
  const pybind11::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() == 0) return;
  raised_ = std::make_exception_ptr(pybind11::error_already_set());
  stopped_ = true;
}

void SignalWatch::rethrow() const {
  if (raised_ != nullptr) std::rethrow_exception(raised_);
}

}  // namespace oktett::python
