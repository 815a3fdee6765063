#pragma once
/// \file Options of `oktett render` for pictures that are rendered in several runs: checkpoints and shares.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/command_line.h"
#include "io/film/film_file.h"
#include "render/picture/render.h"

namespace oktett {

// ---- Keeps the file of a film up to date while the film is rendered.

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
  /// Whether `problem` was the last that take_warning reported.
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

struct RenderArguments;

/// The words of the command line, not checked yet. Empty: not given.
struct CheckpointArguments {
  std::string checkpoint, every, resume, shard;
  std::optional<std::uint32_t> added_samples;
};

void add_checkpoint_options(Verb& verb, CheckpointArguments& arguments);

/// The extension of film files.
inline constexpr const char* kFilmExtension = ".film";
/// Whether the file is a film by its name.
bool is_film_name(const std::string& path);

/// What `arguments` and the film that --resume names ask for together: words that say how a picture looks
/// count as when it was begun, unless they are given again. Words that only say how it is computed are those
/// of now. `line` holds the words of now.
RenderArguments resumed_arguments(const CommandLine& line, const RenderArguments& arguments,
                                  const FilmFile& film);

/// The film of a render and its file.
class Checkpoint {
 public:
  /// Reads the film that --resume names and replaces `arguments` by resumed_arguments. Throws Error for
  /// options that do not go together.
  Checkpoint(const CommandLine& line, RenderArguments& arguments);

  /// Where the film goes in the place of a picture; empty: a picture is written.
  const std::string& film_output() const { return film_output_; }
  /// Where the film will be written to; empty: nowhere.
  const std::string& target() const { return path_; }
  /// Sets options.film and, of a film that was begun before, options.data_layers, and lets the film be
  /// written from now on. Throws Error if the film that was begun is of another scene. `files` were read for
  /// the scene.
  void start(const Scene& scene, const std::vector<std::string>& files, const RenderArguments& arguments,
             const ImageMetadata& metadata, RenderOptions& options);
  /// A problem since the last call, for the user; empty if there was none.
  std::string take_warning();
  /// Whether the user knows of that problem.
  bool has_told(const std::string& problem) const { return saver_ && saver_->has_told(problem); }
  /// Adds what earlier runs took, and keeps the words of the first.
  void complete(ImageMetadata& metadata) const;
  /// Writes the film for the last time. Throws Error of kind io.
  void finish(const ImageMetadata& metadata);
  /// Where the film is written to; empty: nowhere.
  std::string path() const;

 private:
  FilmFile file_;
  bool resumed_ = false;
  std::uint32_t added_ = 0;
  std::string path_, film_output_;
  double seconds_ = 60;
  std::unique_ptr<FilmSaver> saver_;
};

}  // namespace oktett
