#include "app/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/render_options.h"
#include "app/setting_options.h"
#include "app/text.h"
#include "core/error.h"
#include "io/film/film_file.h"
#include "io/image/output.h"

namespace oktett {

// ---- Keeps the file of a film up to date while the film is rendered.

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

// ---- What the bits of a picture depend on.

namespace {

/// The settings of a scene that the sums of its picture depend on, from their descriptions: a new one belongs
/// to them unless it is left out here.
class SettingList : public ParameterVisitor<SettingList> {
 public:
  explicit SettingList(FilmFingerprint::Entries& list) : list_(list) {}

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    const std::string_view key = parameter.key;
    // Tone curves are applied to the finished picture, and --size stands for both of its sides.
    const bool left_out =
        key == "tone" || key == "exposure" || key == "gamma" || key == "width" || key == "height";
    if (left_out) return false;
    if constexpr (requires { value.describe(*this); })
      value.describe(*this);
    else
      list_.emplace_back(name_of(key), text(value));
    return false;
  }

 private:
  /// The option of the command line, if there is one.
  static std::string name_of(std::string_view key) {
    if (const char* const option = option_of_setting(key)) return option;
    return fmt::format("'{}'", key);
  }

  template <class T>
  requires std::is_arithmetic_v<T>
  static std::string text(T value) { return fmt::format("{}", value); }
  static std::string text(std::span<const double> values) {
    return fmt::format("{}", fmt::join(values, ","));
  }
  static std::string text(const CausticSettings::Radius& radius) { return text(radius.value); }
  template <class T>
  static std::string text(const ChoiceOf<T>& choice) {
    return std::ranges::find(choice.choices, choice.value, &Choice<T>::value)->name;
  }

  FilmFingerprint::Entries& list_;
};

}  // namespace

/// What the sums of a picture depend on: settings, and the files that were read for the scene.
static FilmFingerprint fingerprint_of(const Scene& scene, const std::vector<std::string>& files,
                                      const RenderArguments& arguments, bool data_layers) {
  FilmFingerprint fingerprint;
  const auto add = [&](const std::string& name, const auto& value) {
    fingerprint.settings.emplace_back(name, fmt::format("{}", value));
  };
  Film film = scene.film;
  IntegratorSettings integrator = scene.integrator;
  add("the version", program_version());
  add("--size", fmt::format("{}x{}", film.width, film.height));
  SettingList settings(fingerprint.settings);
  film.describe(settings);
  integrator.describe(settings);
  add("the use of data layers", data_layers);
  add("--look", arguments.look.empty() ? "default" : arguments.look);
  add("--up", arguments.up.empty() ? "default" : arguments.up);
  add("--view", arguments.viewpoint.empty() ? "default" : arguments.viewpoint);
  for (const auto& [name, value] : parse_definitions(arguments.definitions)) add("-D " + name, value);
  fingerprint.files = hash_files(files, std::filesystem::path(arguments.scene).parent_path().string());
  return fingerprint;
}

namespace {

FilmShare parse_share(std::string_view text) {
  FilmShare share;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, share.number);
  const bool slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, share.count) : first;
  if (!slash || second.ec != std::errc{} || second.ptr != end || share.number < 1 ||
      share.number > share.count || share.count > FilmShare::kMost)
    throw Error(fmt::format("--shard: '{}' is not of the form k/n with 1 <= k <= n <= {}, e.g. 3/7", text,
                            FilmShare::kMost));
  return share;
}

/// In the place of a picture.
std::string film_path(const RenderArguments& arguments, const FilmShare& share) {
  if (is_film_name(arguments.outfile)) return arguments.outfile;
  if (share.count == 1) return {};
  if (!arguments.outfile.empty())
    throw Error(fmt::format("--shard renders a part of a picture, which goes to a film; expected -o FILE{}",
                            kFilmExtension));
  return fmt::format("{}-{}-of-{}{}", std::filesystem::path(arguments.scene).stem().string(), share.number,
                     share.count, kFilmExtension);
}

}  // namespace

void add_checkpoint_options(Verb& verb, CheckpointArguments& a) {
  verb.option("--checkpoint", &a.checkpoint, "FILE", "Keep what is finished in FILE, for --resume");
  verb.option("--every", &a.every, "SECONDS", "Time between two checkpoints; default: 60");
  verb.option("--resume", &a.resume, "FILE", "Go on with the picture of a checkpoint or share");
  verb.option("--add-spp", &a.added_samples, "N", "More samples per pixel than the picture was begun with");
  verb.option("--shard", &a.shard, "k/n", "Render the k-th of n parts of the picture, for oktett merge");
}

bool is_film_name(const std::string& path) {
  return std::filesystem::path(path).extension() == kFilmExtension;
}

RenderArguments resumed_arguments(const CommandLine& line, const RenderArguments& arguments,
                                  const FilmFile& film) {
  RenderArguments all;
  if (film.words.empty() || film.words.front() != "render")
    throw Error(Location{arguments.checkpoints.resume}, "holds no command line of oktett render");
  read_render_words(film.words, all);
  all.threads = 0;
  for (std::string* word : {&all.isa, &all.stats, &all.display_server, &all.show, &all.photon_map})
    word->clear();
  all.cache = {};
  all.quiet = all.verbose = all.progress = false;
  // The film may have been moved, and is its own checkpoint.
  const bool film_only = is_film_name(all.outfile) || !all.checkpoints.shard.empty();
  if (film_only) all.outfile = arguments.checkpoints.resume;
  all.checkpoints = {};
  read_render_words(line.words(), all);
  return all;
}

Checkpoint::Checkpoint(const CommandLine& line, RenderArguments& arguments) {
  const CheckpointArguments given = arguments.checkpoints;
  if (!given.every.empty()) seconds_ = parse_amount("--every", given.every, "seconds", 1e-3, 86400);
  FilmShare share = given.shard.empty() ? FilmShare{} : parse_share(given.shard);
  if (given.added_samples && (*given.added_samples < 1 || *given.added_samples > kMostAddedSamples))
    throw Error(fmt::format("--add-spp: {} is out of range; expected 1 to {}", *given.added_samples,
                            kMostAddedSamples));
  added_ = given.added_samples.value_or(0);
  if (!given.resume.empty()) {
    resumed_ = true;
    file_ = read_film(given.resume);
    arguments = resumed_arguments(line, arguments, file_);
    if (!given.shard.empty() && !(share == file_.film->share()))
      throw Error(Location{given.resume},
                  fmt::format("is share {}/{}", file_.film->share().number, file_.film->share().count));
    share = file_.film->share();
  } else {
    file_.words = line.words();
    file_.film = std::make_shared<FilmState>(share, added_);
  }
  film_output_ = film_path(arguments, share);
  if (!film_output_.empty() && !given.checkpoint.empty())
    throw Error(fmt::format("--checkpoint: '{}' is a checkpoint itself", film_output_));
  path_ = !film_output_.empty() ? film_output_ : !given.checkpoint.empty() ? given.checkpoint : given.resume;
  if (path_.empty() && !given.every.empty()) throw Error("--every needs --checkpoint or --resume");
}

void Checkpoint::start(const Scene& scene, const std::vector<std::string>& files,
                       const RenderArguments& arguments, const ImageMetadata& metadata,
                       RenderOptions& options) {
  if (path_.empty() && added_ == 0) return;
  if (resumed_) options.data_layers = file_.film->plan().format.data_layers;
  const FilmFingerprint now = fingerprint_of(scene, files, arguments, options.data_layers);
  if (resumed_) {
    const std::string other = difference(file_.fingerprint, now);
    if (!other.empty())
      throw Error(Location{arguments.checkpoints.resume}, "is of another picture: " + other);
    file_.film->add_samples(added_);
  } else {
    file_.metadata = metadata;
  }
  file_.fingerprint = now;
  options.film = file_.film.get();
  if (path_.empty()) return;
  const bool at_once = added_ > 0 || !std::filesystem::exists(path_);
  saver_ = std::make_unique<FilmSaver>(FilmSaver::Options{path_, seconds_, at_once}, file_);
}

std::string Checkpoint::take_warning() { return saver_ ? saver_->take_warning() : std::string(); }

void Checkpoint::complete(ImageMetadata& metadata) const {
  if (file_.film->has_begun()) metadata.samples += file_.film->added();
  if (!resumed_) return;
  metadata.render_seconds += file_.metadata.render_seconds;
  metadata.command_line = file_.metadata.command_line, metadata.scene = file_.metadata.scene;
}

void Checkpoint::finish(const ImageMetadata& metadata) {
  if (saver_) saver_->finish(metadata);
}

std::string Checkpoint::path() const { return saver_ ? path_ : std::string(); }

}  // namespace oktett
