#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/checkpoint.h"
#include "app/command_line.h"
#include "app/interrupt.h"
#include "app/output_files.h"
#include "app/progress.h"
#include "app/render_options.h"
#include "app/render_stats.h"
#include "app/scene_loading.h"
#include "app/terminal/preview.h"
#include "app/text.h"
#include "app/unused_options.h"
#include "core/error.h"
#include "core/isa.h"
#include "io/display/display.h"
#include "io/image/image.h"
#include "io/image/output.h"
#include "io/image/texture.h"
#include "io/photon/photon_map_file.h"
#include "io/scene/scene_file.h"
#include "io/text/files_read.h"
#include "kernels/exact/march.h"
#include "render/film/denoise.h"
#include "render/picture/render.h"

namespace oktett {
namespace {

class Stopwatch {
 public:
  /// Seconds since construction or the last lap.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check_stats(const std::string& stats) {
  if (!stats.empty() && stats != "text" && stats != "json" && stats != "false")
    throw Error("--stats: unknown format '" + stats + "'; expected --stats or --stats=json");
}

void print_plan(const Scene& scene, const RenderOptions& options, const std::string& output) {
  say("{}: {} objects, {} materials, {} lights\n", scene.source, scene.objects.size(), scene.materials.size(),
      scene.lights.size());
  say("{} x {} pixels, {} samples each, integrator {}, {}, {} threads, to {}\n", scene.film.width,
      scene.film.height, scene.integrator.samples, to_string(scene.integrator.kind), to_string(options.isa),
      options.threads == 0 ? "all" : std::to_string(options.threads), output);
}

ImageMetadata metadata_of(const CommandLine& line, const RenderArguments& arguments,
                          const RenderResult& result) {
  ImageMetadata metadata = first_metadata(line.text(), arguments, result.scene);
  metadata.render_seconds = result.report.render_seconds;
  metadata.camera =
      camera_matrices(result.scene.camera, result.picture.full_width, result.picture.full_height);
  return metadata;
}

/// What is shown while tracing: the progress line and, if asked for, the live preview.
class Watch {
 public:
  Watch(const RenderArguments& arguments, Checkpoint& checkpoint, RenderOptions& options)
      : checkpoint_(checkpoint),
        phases_(arguments.quiet),
        line_(arguments.quiet      ? ProgressLine::Mode::never
              : arguments.progress ? ProgressLine::Mode::always
                                   : ProgressLine::Mode::automatic) {
    options.progress = [this](const RenderProgress& progress) {
      last_ = progress;
      phases_.end();
      print_warning(checkpoint_.take_warning());
      line_.show(progress);
    };
    if (arguments.display_server.empty()) return;
    const std::string title = std::filesystem::path(arguments.scene).filename().string();
    display_ = std::make_unique<Display>(arguments.display_server, title);
    options.tile_finished = [this](const Picture& picture, const FinishedTile& tile) {
      display_->update(picture, tile);
      print_warning(display_->take_warning());
    };
  }

  void finish() {
    if (display_) {
      display_->finish();
      print_warning(display_->take_warning());
    }
    phases_.end();
    print_warning(checkpoint_.take_warning());
    line_.finish();
  }

  /// Finished share of the pixels, by the last progress report.
  double percent_done() const {
    if (last_.pixels_total == 0) return 0;
    return 100 * static_cast<double>(last_.pixels_done) / static_cast<double>(last_.pixels_total);
  }

 private:
  void print_warning(const std::string& warning) {
    if (warning.empty()) return;
    line_.clear();
    say("warning: {}\n", warning);
  }

  Checkpoint& checkpoint_;
  PhaseLine phases_;  ///< of building
  ProgressLine line_;
  std::unique_ptr<Display> display_;
  RenderProgress last_;
};

/// The file of --photon-map: read before rendering if it is there, else written after.
class PhotonFile {
 public:
  PhotonFile(const RenderArguments& arguments, const Scene& scene, RenderOptions& options)
      : path_(arguments.photon_map) {
    if (path_.empty()) return;
    if (!traits(scene.integrator.kind).traces_paths) throw Error("--photon-map needs the integrator 'path'");
    if (std::filesystem::exists(path_)) {
      options.photons = read_photon_map(path_);
      path_.clear();
    } else {
      // Throws now rather than after the picture if it cannot be written.
      const OutputFile writable(path_);
      options.keep_photons = true;
    }
  }

  void keep(const RenderResult& result) const {
    if (!path_.empty() && result.photons != nullptr) write_photon_map(path_, *result.photons);
  }

 private:
  std::string path_;  ///< to write; empty: none
};

const char* signal_name(int signal) {
  return signal == SIGALRM   ? "--timeout"
         : signal == SIGHUP  ? "SIGHUP"
         : signal == SIGTERM ? "SIGTERM"
                             : "SIGINT";
}

/// What prints the picture where the summary will be printed, if that is asked for.
std::optional<TerminalPreview> preview_of(const RenderArguments& arguments) {
  if (arguments.show.empty()) return std::nullopt;
  return TerminalPreview(arguments.show, arguments.stats == "json" ? stderr : stdout);
}

RenderOptions options_of(const RenderArguments& arguments, bool data_layers) {
  RenderOptions options;
  options.isa = choose_isa(arguments.isa);
  options.threads = arguments.threads;
  options.build = parse_bvh_option(arguments.bvh);
  options.data_layers = data_layers || arguments.film.denoise;
  return options;
}

/// Calls `write`. What goes wrong is returned, since there may be a picture to write, too.
template <class Write>
std::optional<Error> try_to(const Write& write) {
  try {
    write();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// Tells the user unless that was done before; the exit status.
int say_unsaved(const Error& error, const Checkpoint& checkpoint) {
  if (!checkpoint.has_told(error.what())) throw Error(error);
  return kExitIo;
}

/// Says that a signal stopped the render; the exit status.
int say_stopped(int signal, double percent, const Checkpoint& checkpoint) {
  const std::string rest = checkpoint.path().empty()
                               ? "the rest is black"
                               : "go on with: oktett render --resume " + checkpoint.path();
  say("stopped by {}: {:.1f}% of the picture is finished, {}\n", signal_name(signal), percent, rest);
  return signal == SIGALRM ? kExitTimeout : 128 + signal;
}

int run_render(const CommandLine& line, RenderArguments arguments) {
  check_stats(arguments.stats);
  Checkpoint checkpoint(line, arguments);
  if (arguments.scene.empty()) return line.missing("scene");
  const std::optional<TerminalPreview> preview = preview_of(arguments);
  apply_limits(arguments.limits);
  check_threads(arguments.threads);
  // Loading shares its work among threads, too, and one thread asked for is none that can be refused.
  std::optional<tbb::global_control> threads;
  if (arguments.threads > 0) threads.emplace(tbb::global_control::max_allowed_parallelism, arguments.threads);
  const bool writes_film = !checkpoint.film_output().empty();
  const std::string output = writes_film ? checkpoint.film_output() : output_path(arguments);
  const bool writes_picture = !writes_film && !output.empty();
  check_target_options(arguments, {writes_picture ? output : "", writes_film});
  check_files_differ({{"the scene", arguments.scene},
                      {"--outfile", writes_picture ? output : ""},
                      {writes_film ? "--outfile" : "--checkpoint", checkpoint.target()},
                      {"--photon-map", arguments.photon_map}});
  if (writes_picture) check_output(output);
  RenderOptions options = options_of(arguments, writes_film || (writes_picture && keeps_all_planes(output)));

  Stopwatch watch;
  StageTimes times;
  const FilesRead files;
  const std::unique_ptr<SceneCache> cache = open_cache(arguments.cache);
  std::optional<PhaseLine> loading(std::in_place, arguments.quiet);
  Scene scene = load_as_asked(arguments);
  loading.reset();
  const std::size_t most_warnings = arguments.verbose ? std::numeric_limits<std::size_t>::max() : 20;
  print_warnings(scene.warnings, most_warnings);
  const ImageTextures textures(scene.textures, scene.texture_places);
  print_warnings(textures.warnings(), most_warnings);
  options.textures = &textures;
  if (arguments.verbose && !arguments.quiet) print_plan(scene, options, output);
  times.load = watch.lap();

  checkpoint.start(scene, files.paths(), arguments, first_metadata(line.text(), arguments, scene), options);
  PhotonFile photons(arguments, scene, options);

  // A first signal ends the tracing, not the writing.
  const StopOnSignal interrupt;
  options.stop = interrupt.flag();
  Watch shown(arguments, checkpoint, options);
  const std::uint64_t given_up_before = interval::uncertified_count();
  RenderResult result = render(std::move(scene), options);
  times.given_up = interval::uncertified_count() - given_up_before;
  shown.finish();
  const std::optional<Error> lost_photons = try_to([&] { photons.keep(result); });
  times.build = result.report.build_seconds;
  times.render = result.report.render_seconds;
  watch.lap();
  // The rest of a picture that was stopped is black.
  const bool is_seen = writes_picture || (preview && !writes_film);
  if (arguments.film.denoise && is_seen && !result.report.stopped) denoise(result.picture);
  times.denoise = watch.lap();
  ImageMetadata metadata = metadata_of(line, arguments, result);
  checkpoint.complete(metadata);
  const std::optional<Error> unsaved = try_to([&] { checkpoint.finish(metadata); });
  // The library that writes images takes as much memory as a large scene: free the scene before it is loaded.
  result.scene = Scene{};
  if (writes_picture) write_image(output, result.picture, metadata);
  times.write = watch.lap();
  if (preview) preview->print(result.picture);
  if (unsaved && !writes_picture) return say_unsaved(*unsaved, checkpoint);
  print_summary(arguments, times, result.report, output);
  if (lost_photons) throw Error(*lost_photons);
  if (unsaved) return say_unsaved(*unsaved, checkpoint);
  return result.report.stopped ? say_stopped(interrupt.signal(), shown.percent_done(), checkpoint) : 0;
}

}  // namespace

void add_render_command(CommandLine& line) {
  const auto arguments = std::make_shared<RenderArguments>();
  Verb verb = line.add_verb("render", "Render a scene file or a mesh to a picture",
                            [&line, arguments] { return run_render(line, *arguments); });
  add_render_options(verb, *arguments);
}

}  // namespace oktett
