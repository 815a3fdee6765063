#include "bench/peer_timing.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <mutex>
#include <stop_token>
#include <thread>

namespace oktett::bench {

static double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds(const std::function<void()>& f) {
  const double start = now();
  f();
  return now() - start;
}

double thread_seconds(const std::function<void()>& f) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  f();
  return now() - start;
}

Quartiles quartiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double fraction) {
    const double place = fraction * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - std::floor(place)) * (values[above] - values[below]);
  };
  return {at(0.25), at(0.5), at(0.75)};
}

void on_threads(int threads, const std::function<void()>& f) {
  // The limit also holds for peers with an arena of their own.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute(f);
}

void flush_denormals() {
#if defined(__SSE2__)
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

namespace {

/// Threads that wait for work between measurements. The stack and the memory of a new thread come in by page
/// faults, which would count against the program that uses more of it.
class Helpers {
 public:
  /// Runs `work` in `count` helpers and in the calling thread at the same time.
  void run(std::size_t count, const std::function<void()>& work) {
    while (threads_.size() < count)
      threads_.emplace_back([this, number = threads_.size()](std::stop_token stop) { serve(number, stop); });
    {
      const std::scoped_lock lock(mutex_);
      work_ = &work, wanted_ = running_ = count, ++round_;
    }
    changed_.notify_all();
    work();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return running_ == 0; });
  }

 private:
  void serve(std::size_t number, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    for (std::uint64_t seen = 0;;) {
      if (!changed_.wait(lock, stop, [&] { return round_ != seen && number < wanted_; })) return;
      seen = round_;
      const std::function<void()>& work = *work_;
      lock.unlock();
      work();
      lock.lock();
      if (--running_ == 0) changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  const std::function<void()>* work_ = nullptr;
  std::size_t wanted_ = 0, running_ = 0;
  std::uint64_t round_ = 0;
  std::vector<std::jthread> threads_;  ///< the last member, so that they end first
};

}  // namespace

void in_pieces(int threads, std::size_t size, const std::function<void(std::size_t, std::size_t)>& f) {
  static Helpers helpers;
  constexpr std::size_t kPiece = 4096;
  std::atomic<std::size_t> next{0};
  helpers.run(static_cast<std::size_t>(threads - 1), [&] {
    flush_denormals();
    for (std::size_t b; (b = next.fetch_add(kPiece)) < size;) f(b, std::min(kPiece, size - b));
  });
}

Rounds::Rounds(double budget, int least, int most)
    : budget_(budget), start_(now()), least_(least), most_(std::max(least, most)) {}

bool Rounds::next() {
  if (done_ >= most_ || (done_ >= least_ && now() - start_ > budget_)) return false;
  ++done_;
  return true;
}

}  // namespace oktett::bench
