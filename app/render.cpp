#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/checkpoint.h"
#include "app/command_line.h"
#include "app/json.h"
#include "app/picture_warnings.h"
#include "app/process.h"
#include "app/progress.h"
#include "app/render_options.h"
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
#include "io/text/files.h"
#include "kernels/exact/march.h"
#include "render/asked_textures.h"
#include "render/film/denoise.h"
#include "render/picture/render.h"

namespace oktett {

// ---- What `oktett render` tells at its end: times, and counts with --stats.

/// Wall-clock seconds of the stages of the command, and what is known of no other report.
struct StageTimes {
  double load = 0, build = 0, render = 0, denoise = 0, write = 0;
  std::uint64_t given_up = 0;  ///< searches for a hit that would have taken too many steps
};

namespace {

std::uint64_t rays_of(const RenderReport& r) {
  return r.camera_rays + r.shadow_rays + r.reflected_rays + r.refracted_rays;
}

double rays_per_second(const RenderReport& report) {
  return report.render_seconds > 0 ? static_cast<double>(rays_of(report)) / report.render_seconds : 0;
}

double bytes_per_triangle(const RenderReport& report) {
  const double bytes = static_cast<double>(report.geometry_bytes) + static_cast<double>(report.bvh_bytes);
  return report.triangles > 0 ? bytes / static_cast<double>(report.triangles) : 0;
}

/// "load 0.012 s, build 0.345 s, render 1.23 s (12.3 Mrays/s), write 0.056 s".
std::string times_text(const StageTimes& times, const RenderReport& report) {
  const std::string photons =
      report.photon_seconds > 0 ? fmt::format("photons {}, ", duration_text(report.photon_seconds)) : "";
  const std::string denoised =
      times.denoise > 1e-3 ? fmt::format(", denoise {}", duration_text(times.denoise)) : "";
  return fmt::format("load {}, build {}, {}render {} ({}rays/s){}, write {}", duration_text(times.load),
                     duration_text(times.build), photons, duration_text(times.render),
                     with_prefix(rays_per_second(report)), denoised, duration_text(times.write));
}

/// part / whole, 0 for 0 / 0.
double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// A number for each bounce.
template <class Of>
std::vector<double> by_bounce(const RenderReport& report, const Of& of) {
  std::vector<double> values;
  for (const BounceReport& b : report.bounces) values.push_back(of(b));
  return values;
}

/// A table of counts, one per line.
std::string stats_text(const StageTimes& times, const RenderReport& report) {
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<20}{:>16}\n", name, value);
  };
  line("rays", grouped(rays_of(report)));
  line("  camera", grouped(report.camera_rays));
  line("  shadow", grouped(report.shadow_rays));
  line("  reflected", grouped(report.reflected_rays));
  line("  refracted", grouped(report.refracted_rays));
  for (std::size_t i = 0; i < report.bounces.size(); ++i) {
    const BounceReport& b = report.bounces[i];
    text += fmt::format("  bounce {:<11}{:>16} in batches of {:.0f}, {} shadow rays", i, grouped(b.rays),
                        share(b.rays, b.batches), grouped(b.shadow_rays));
    text += b.lanes > 0 ? fmt::format(", {:.0f} % of shading lanes filled\n", 100 * share(b.shaded, b.lanes))
                        : "\n";
  }
  line("triangles", grouped(report.triangles));
  line("primitives", grouped(report.primitives));
  line("geometry", bytes_text(report.geometry_bytes));
  line("bvh", bytes_text(report.bvh_bytes));
  line("bytes per triangle", fmt::format("{:.1f}", bytes_per_triangle(report)));
  line("sah cost", fmt::format("{:.2f}", report.sah_cost));
  line("bad samples", grouped(report.bad_samples));
  line("given up", grouped(times.given_up));
  return text;
}

/// The same counts and the times as one JSON object on one line. `output` is the picture that was written.
std::string stats_json(const StageTimes& times, const RenderReport& report, const std::string& output) {
  const JsonObject seconds{
      {"load", times.load}, {"build", times.build}, {"render", times.render}, {"write", times.write}};
  const JsonObject rays{{"camera", report.camera_rays},
                        {"shadow", report.shadow_rays},
                        {"reflected", report.reflected_rays},
                        {"refracted", report.refracted_rays},
                        {"total", rays_of(report)}};
  const auto number = [](std::uint64_t BounceReport::*count) {
    return [count](const BounceReport& b) { return static_cast<double>(b.*count); };
  };
  const JsonObject bounces{
      {"rays", by_bounce(report, number(&BounceReport::rays))},
      {"shadow_rays", by_bounce(report, number(&BounceReport::shadow_rays))},
      {"batches", by_bounce(report, number(&BounceReport::batches))},
      {"lanes_filled", by_bounce(report, [](const BounceReport& b) { return share(b.shaded, b.lanes); })}};
  const JsonObject all{{"output", output},
                       {"seconds", seconds},
                       {"rays", rays},
                       {"rays_per_second", rays_per_second(report)},
                       {"bounces", bounces},
                       {"triangles", report.triangles},
                       {"primitives", report.primitives},
                       {"geometry_bytes", report.geometry_bytes},
                       {"bvh_bytes", report.bvh_bytes},
                       {"bytes_per_triangle", bytes_per_triangle(report)},
                       {"sah_cost", report.sah_cost},
                       {"bad_samples", report.bad_samples},
                       {"given_up", times.given_up},
                       {"stopped", report.stopped}};
  return all.text();
}

}  // namespace

/// Prints the times, what --stats asks for, and warnings about samples and searches that failed. `output` is
/// the picture that was written; empty: none.
static void print_summary(const RenderArguments& arguments, const StageTimes& times,
                          const RenderReport& report, const std::string& output) {
  const bool json = arguments.stats == "json";
  if (arguments.stats == "text") fmt::print("{}", stats_text(times, report));
  if (json) fmt::print("{}\n", stats_json(times, report, output));
  const std::string end = fmt::format("{}\n{}", times_text(times, report),
                                      output.empty() ? "" : fmt::format("wrote {}\n", output));
  // With --stats=json standard output holds nothing but JSON.
  if (!arguments.quiet && json) say("{}", end);
  if (!arguments.quiet && !json) fmt::print("{}", end);
  std::fflush(stdout);
  if (report.bad_samples > 0)
    say("warning: {} samples were NaN or infinite and were left out\n", report.bad_samples);
  if (times.given_up > 0)
    say("warning: {} times, finding where a ray meets a surface took too many steps and was given up\n",
        times.given_up);
}

// ---- The files that a render writes must not replace each other.

/// A file of a run: the option that names it, or what it is, and its path; an empty path: there is none.
struct NamedFile {
  std::string name, path;
};

/// Throws Error if two of the files are the same: what is written last would replace the other.
static void check_files_differ(const std::vector<NamedFile>& files) {
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (!files[i].path.empty() && !files[k].path.empty() && is_same_output(files[i].path, files[k].path))
        throw Error(
            fmt::format("{} and {} name the same file '{}'; expected two files, since one would replace "
                        "the other",
                        files[k].name, files[i].name, files[i].path));
}

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
  options.data_layers = data_layers || arguments.denoise;
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

void write_picture(const RenderArguments& arguments, const std::string& path, bool depth_units,
                   const Picture& picture, const ImageMetadata& metadata) {
  if (!depth_units)
    return arguments.bits == "16" ? write_image16(path, picture, metadata)
                                  : write_image(path, picture, metadata);
  const double unit = depth_unit_of(arguments).value_or(depth_unit(picture));
  write_depth(path, picture, unit, metadata);
  if (!arguments.quiet) say("depth: steps of {} units of the scene, 0 where nothing is\n", unit);
}

/// Says that a signal stopped the render; the exit status.
int say_stopped(int signal, double percent, const Checkpoint& checkpoint) {
  const std::string rest = checkpoint.path().empty()
                               ? "the rest is black"
                               : "go on with: oktett render --resume " + checkpoint.path();
  say("stopped by {}: {:.1f}% of the picture is finished, {}\n", signal_name(signal), percent, rest);
  return signal == SIGALRM ? kExitTimeout : 128 + signal;
}

int run_render(const CommandLine& line, RenderArguments arguments);

/// One picture after the other, each as by --time.
int run_frames(const CommandLine& line, const RenderArguments& arguments) {
  const Frames frames = frames_of(arguments.frames);
  if (arguments.scene.empty()) return line.missing("scene");
  const CheckpointArguments& kept = arguments.checkpoints;
  if (!kept.checkpoint.empty() || !kept.resume.empty() || !kept.shard.empty())
    throw Error("--frames writes several pictures; it does not go with --checkpoint, --resume and --shard");
  GltfWords words = arguments.gltf;
  if (words.time.empty()) words.time = "0";
  const double start = *gltf_options(words).time;
  const std::string output = output_path(arguments);
  for (int i = frames.first; i <= frames.last; ++i) {
    RenderArguments one = arguments;
    one.frames = {};
    one.gltf.time = fmt::format("{}", start + i / frames.rate);
    if (!output.empty()) one.outfile = frame_path(output, i);
    if (const int status = run_render(line, std::move(one)); status != 0) return status;
  }
  return 0;
}

int run_render(const CommandLine& line, RenderArguments arguments) {
  if (!arguments.frames.frames.empty()) return run_frames(line, arguments);
  if (!arguments.frames.rate.empty()) throw Error("--fps needs --frames");
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
  check_bits(arguments.bits, writes_picture ? output : "");
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
  const ImageTextures textures(asked_textures(scene, options.data_layers), scene.texture_places);
  print_warnings(textures.warnings(), most_warnings);
  options.textures = &textures;
  if (arguments.verbose && !arguments.quiet) print_plan(scene, options, output);
  times.load = watch.lap();
  const bool depth_units = writes_picture && shows_depth_units(arguments, scene);
  options.data_layers = options.data_layers || depth_units;
  if (depth_unit_of(arguments) && !depth_units)
    throw Error("--depth-unit is for --integrator depth with --bits 16 and a PNG file");

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
  // A film may be a share of the picture, or its rest.
  const std::string nothing = checkpoint.target().empty() ? why_nothing_is_seen(result) : "";
  if (!nothing.empty()) say("warning: {}\n", nothing);
  const std::optional<Error> lost_photons = try_to([&] { photons.keep(result); });
  times.build = result.report.build_seconds;
  times.render = result.report.render_seconds;
  watch.lap();
  // The rest of a picture that was stopped is black.
  const bool is_seen = writes_picture || (preview && !writes_film);
  if (arguments.denoise && is_seen && !result.report.stopped) denoise(result.picture);
  times.denoise = watch.lap();
  ImageMetadata metadata = metadata_of(line, arguments, result);
  checkpoint.complete(metadata);
  const std::optional<Error> unsaved = try_to([&] { checkpoint.finish(metadata); });
  // The library that writes images takes as much memory as a large scene: free the scene before it is loaded.
  result.scene = Scene{};
  if (writes_picture) write_picture(arguments, output, depth_units, result.picture, metadata);
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
