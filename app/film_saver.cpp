#include "app/film_saver.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

#include "io/image/output.h"

namespace oktett {

/// How often the thread looks whether it is time.
constexpr std::chrono::milliseconds kTick{20};
/// Writing takes at most one part in so many of the time.
constexpr int kPause = 10;

FilmSaver::FilmSaver(const Options& options, FilmFile file)
    : options_(options), file_(std::move(file)), seconds_before_(file_.metadata.render_seconds) {
  // Throws now rather than after the first minute.
  { const OutputFile writable(options_.path); }
  thread_ = std::thread([this] { run(); });
}

FilmSaver::~FilmSaver() { stop(); }

void FilmSaver::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void FilmSaver::run() {
  const auto pause =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.seconds));
  Clock::time_point due = options_.at_once ? Clock::now() : Clock::now() + pause;
  std::uint64_t saved = std::numeric_limits<std::uint64_t>::max();
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kTick, [&] { return stopped_; })) {
    if (!file_.film->has_begun() || Clock::now() < due || file_.film->version() == saved) continue;
    lock.unlock();
    const Clock::time_point begin = Clock::now();
    saved = file_.film->version();
    std::string problem;
    try {
      save();
    } catch (const std::exception& error) {
      problem = error.what();
    }
    due = Clock::now() + std::max(pause, kPause * (Clock::now() - begin));
    lock.lock();
    if (problem != last_warning_) warning_ = problem;
    last_warning_ = problem;
    if (!problem.empty()) saved = std::numeric_limits<std::uint64_t>::max();
  }
}

void FilmSaver::save() {
  file_.metadata.render_seconds =
      seconds_before_ + std::chrono::duration<double>(Clock::now() - start_).count();
  write_film(options_.path, file_);
}

std::string FilmSaver::take_warning() {
  const std::lock_guard lock(mutex_);
  if (!warning_.empty()) told_ = warning_;
  return std::exchange(warning_, {});
}

void FilmSaver::finish(const ImageMetadata& metadata) {
  stop();
  file_.metadata = metadata;
  write_film(options_.path, file_);
}

}  // namespace oktett
