#pragma once
/// \file Keeps the file of a film up to date while the film is rendered.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "io/film/film_file.h"

namespace oktett {

/// Writes a film to its file every so often, in a thread of its own. A file that cannot be written is a
/// warning: it does not end the render, and is tried again.
class FilmSaver {
 public:
  struct Options {
    std::string path;
    double seconds = 60;   ///< between two files; more if writing one takes more than a tenth of that
    bool at_once = false;  ///< write the first when the film begins, not after `seconds`
  };
  /// Throws Error of kind io if the file cannot be written. `file.metadata` is what is known so far.
  FilmSaver(const Options& options, FilmFile file);
  ~FilmSaver();
  FilmSaver(const FilmSaver&) = delete;
  FilmSaver& operator=(const FilmSaver&) = delete;

  /// The problem since the last call; empty if there was none.
  std::string take_warning();
  /// Whether `problem` was the last that take_warning told.
  bool has_told(const std::string& problem) const { return problem == told_; }
  /// Writes the file for the last time, with the metadata of the finished picture. Throws Error of kind io.
  void finish(const ImageMetadata& metadata);
  const std::string& path() const { return options_.path; }

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  void save();
  void stop();

  Options options_;
  FilmFile file_;
  double seconds_before_;  ///< that the render took before
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopped_ = false;
  std::string warning_, last_warning_, told_;
  std::thread thread_;
};

}  // namespace oktett
