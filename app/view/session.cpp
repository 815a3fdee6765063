#include "app/view/session.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/scene_loading.h"
#include "app/text.h"
#include "app/view/pick.h"
#include "app/view/private_folder.h"
#include "core/elapsed.h"
#include "io/image/image.h"
#include "io/text/files_read.h"
#include "render/film/denoise.h"

namespace oktett {
namespace {

using Clock = std::chrono::steady_clock;

/// How long a first coarse picture may take, so that dragging feels immediate.
constexpr double kCoarseSeconds = 0.035;

/// Edges of tiles for so many samples: a tile is done soon, since a render stops between tiles only.
std::uint32_t tile_edge(std::uint32_t samples) {
  std::uint32_t edge = 32;
  while (edge > 1 && std::uint64_t{edge} * edge * samples > 32768) edge /= 2;
  return edge;
}

/// Gives a scene other settings, and its own back at the end of its life.
class SettingsForOnePicture {
 public:
  SettingsForOnePicture(PreparedScene& scene, const PictureSettings& settings)
      : scene_(scene), own_(scene.settings()) {
    scene_.set(settings);
  }
  ~SettingsForOnePicture() { scene_.set(own_); }
  SettingsForOnePicture(const SettingsForOnePicture&) = delete;
  SettingsForOnePicture& operator=(const SettingsForOnePicture&) = delete;

 private:
  PreparedScene& scene_;
  const PictureSettings own_;
};

/// Line `where.line` of its file, without what would not fit on a page.
std::string line_of(const Location& where) {
  std::ifstream file(where.file);
  std::string line;
  for (int k = 0; k < where.line && std::getline(file, line); ++k) continue;
  return where.line > 0 ? line.substr(0, 200) : "";
}

std::string content(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

}  // namespace

Session::Session(const RenderArguments& arguments, std::string command_line)
    : arguments_(arguments), command_line_(std::move(command_line)), isa_(choose_isa(arguments.isa)) {
  cache_ = open_cache(arguments_.cache);
  std::vector<std::string> files;
  adopt(load(files));
  files_.watch(files);
  loaded_.files = files;
  print_warnings(loaded_.prepared->scene().warnings);
  print_warnings(loaded_.textures->warnings());
  worker_ = std::thread([this] { work(); });
  watcher_ = std::thread([this] { watch(); });
}

Session::~Session() { stop(); }

void Session::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true, cancel_ = true;
  }
  changed_.notify_all();
  canvas_.wake();
  for (std::thread* thread : {&worker_, &watcher_})
    if (thread->joinable()) thread->join();
}

Session::Loaded Session::load(std::vector<std::string>& files) const {
  const FilesRead read;
  struct Note {
    const FilesRead& read;
    std::vector<std::string>& files;
    ~Note() { files = read.paths(); }
  } const note{read, files};
  Loaded loaded;
  Scene scene = load_as_asked(arguments_);
  loaded.textures = std::make_unique<ImageTextures>(scene.textures);
  loaded.prepared = std::make_shared<PreparedScene>(std::move(scene), parse_bvh_option(arguments_.bvh));
  loaded.prepared->complete();
  return loaded;
}

void Session::adopt(Loaded loaded) {
  const Scene& scene = loaded.prepared->scene();
  const ViewState home{scene.camera, scene.film.tone, "beauty"};
  const Box& bounds = loaded.prepared->world().bounds;
  const std::scoped_lock lock(using_scene_, mutex_);
  const bool first = loaded_.prepared == nullptr;
  // Who has turned the view keeps it, unless the file's own view was edited.
  if (first || !(home.camera == status_.home.camera)) status_.state.camera = home.camera;
  if (first || !(home.tone == status_.home.tone)) status_.state.tone = home.tone;
  status_.home = home;
  const std::vector<std::string>& layers = status_.layers = layer_names(scene);
  ++status_.edits;
  if (std::ranges::find(layers, status_.state.layer) == layers.end()) status_.state.layer = "beauty";
  if (!bounds.empty()) {
    status_.center = (Vec3d(bounds.lo) + Vec3d(bounds.hi)) * 0.5;
    status_.radius = std::max(1e-30, length(Vec3d(bounds.hi) - Vec3d(bounds.lo)) / 2);
  }
  film_ = scene.film;
  const PixelWindow window = crop_window(scene.film);
  status_.width = window.width(), status_.height = window.height();
  status_.wanted_samples = scene.integrator.samples;
  status_.error.reset();
  status_.settled = false, finished_.reset(), wants_layers_ = false;
  ++status_.view;
  loaded_ = std::move(loaded);
}

void Session::reload() {
  std::vector<std::string> files;
  std::optional<Error> failure;
  try {
    adopt(load(files));
  } catch (const Error& error) {
    failure = error;
  } catch (const std::bad_alloc&) {
    failure = Error("out of memory", ErrorKind::io);
  }
  const std::lock_guard lock(mutex_);
  if (failure) {
    status_.error = failure;
    status_.error_line = line_of(failure->where());
    // Files that the broken scene no longer names may be named again.
    for (const std::string& path : loaded_.files) files.push_back(path);
  }
  loaded_.files = files;
  files_.watch(files);
}

void Session::watch() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    changed_.wait_for(lock, std::chrono::milliseconds(100));
    if (stopping_ || !files_.have_changed()) continue;
    // Editors write in several steps.
    for (int quiet = 0; quiet < 1 && !stopping_; ++quiet) {
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
      lock.lock();
      if (files_.have_changed()) quiet = -1;
    }
    reload_wanted_ = true, cancel_ = true;
    changed_.notify_all();
  }
}

bool Session::has_changed(std::uint64_t view) const {
  const std::lock_guard lock(mutex_);
  return stopping_ || reload_wanted_ || status_.view != view;
}

void Session::work() {
  std::uint64_t done = 0;
  bool with_layers = false;
  while (true) {
    bool reads = false, only_last = false;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] {
        return stopping_ || reload_wanted_ || status_.view != done || (wants_layers_ && !with_layers);
      });
      if (stopping_) return;
      reads = std::exchange(reload_wanted_, false);
      cancel_ = false;
      only_last = status_.view == done;
      done = status_.view, with_layers = wants_layers_;
    }
    if (reads) {
      reload();
      canvas_.wake();
      continue;
    }
    try {
      render_view(only_last);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      status_.error = Error(error.what());
      status_.error_line.clear();
    }
    canvas_.wake();
  }
}

void Session::render_view(bool only_last) {
  ViewState state;
  std::uint64_t view = 0;
  {
    const std::lock_guard lock(mutex_);
    state = status_.state, view = status_.view;
    status_.settled = false;
  }
  const std::lock_guard use(using_scene_);
  const Scene& scene = loaded_.prepared->scene();
  const PixelWindow window = crop_window(scene.film);
  const double pixels = double{1} * window.width() * window.height();
  const double affordable = kCoarseSeconds / seconds_per_pixel_;
  const auto scale = static_cast<std::uint32_t>(
      std::clamp(std::ceil(std::sqrt(pixels / std::max(affordable, 1.0))), 1.0, 16.0));
  const std::uint32_t wanted = scene.integrator.samples;
  if (!only_last && (wanted > 1 || scale > 1)) render_pass(state, view, scale, 1, false);
  for (std::uint32_t samples = only_last ? wanted : scale > 1 ? 1 : 4; samples < wanted; samples *= 4)
    if (has_changed(view) || !render_pass(state, view, 1, samples, false)) return;
  if (!has_changed(view)) render_pass(state, view, 1, wanted, true);
}

bool Session::render_pass(const ViewState& state, std::uint64_t view, std::uint32_t scale,
                          std::uint32_t samples, bool last) {
  PreparedScene& prepared = *loaded_.prepared;
  const PictureSettings full = prepared.settings();
  PictureSettings settings = full;
  settings.camera = state.camera, settings.film.tone = state.tone;
  settings.film.width = std::max(1u, full.film.width / scale);
  settings.film.height = std::max(1u, full.film.height / scale);
  if (!last) settings.integrator.samples = samples, settings.integrator.error = 0;
  if (!last) settings.integrator.caustics.photons = 0;
  bool layers = false;
  {
    const std::lock_guard lock(mutex_);
    layers = wants_layers_;
  }
  RenderOptions options;
  options.isa = isa_, options.textures = loaded_.textures.get();
  options.tile_size = tile_edge(samples);
  options.data_layers = needs_data(state.layer) || (last && (layers || arguments_.film.denoise));
  // The coarse pass ends even if the view changes meanwhile: else nothing would be seen during a drag.
  if (scale == 1) options.stop = &cancel_;
  Layer layer{state.layer, state.tone, 0, 1, prepared.world().bounds};
  const Vec3d middle = status_.center;
  const double distance = length(state.camera.from - middle), radius = status_.radius;
  layer.near = std::max(0.0, distance - radius), layer.far = distance + radius;
  const PixelWindow window = crop_window(settings.film);
  canvas_.begin(view, window.width(), window.height(), scale > 1);
  if (scale == 1)
    options.tile_finished = [&](const Picture& picture, const FinishedTile& tile) {
      canvas_.show(picture, tile, layer);
    };
  const Clock::time_point start = Clock::now();
  if (last) options.photons = loaded_.photons, options.keep_photons = true;
  RenderResult result = [&] {
    const SettingsForOnePicture changed(prepared, settings);
    return prepared.render(options);
  }();
  if (last && result.photons != nullptr) loaded_.photons = result.photons;
  if (result.report.stopped) return false;
  const FinishedTile whole{0, 0, result.picture.width, result.picture.height};
  if (samples == 1)
    seconds_per_pixel_ =
        std::max(1e-9, seconds_since(start) / (double{1} * result.picture.width * result.picture.height));
  if (scale > 1) canvas_.show(result.picture, whole, layer);
  if (last && arguments_.film.denoise) {
    denoise(result.picture);
    canvas_.show(result.picture, whole, layer);
  }
  const std::lock_guard lock(mutex_);
  if (status_.view != view) return false;
  status_.samples = samples;
  if (!last) return true;
  status_.settled = true;
  metadata_ = first_metadata(command_line_, arguments_, prepared.scene());
  metadata_.render_seconds = result.report.render_seconds;
  metadata_.camera = camera_matrices(state.camera, result.picture.full_width, result.picture.full_height);
  finished_ = std::make_shared<const Picture>(std::move(result.picture));
  changed_.notify_all();
  return true;
}

std::uint64_t Session::change(const std::string& lines) {
  std::uint64_t view = 0;
  {
    const std::lock_guard lock(mutex_);
    ViewState state = parse_view(lines, status_.state);
    if (state.layer != status_.state.layer) {
      if (std::ranges::find(status_.layers, state.layer) == status_.layers.end())
        throw Error("layer: unknown");
    }
    status_.state = std::move(state);
    status_.settled = false, finished_.reset(), wants_layers_ = false;
    view = ++status_.view;
    cancel_ = true;
  }
  changed_.notify_all();
  return view;
}

SessionStatus Session::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::string Session::pick(std::uint32_t x, std::uint32_t y) {
  Camera camera;
  Film film;
  std::shared_ptr<const PreparedScene> prepared;
  {
    const std::lock_guard lock(mutex_);
    camera = status_.state.camera, film = film_, prepared = loaded_.prepared;
  }
  return pick_json(*prepared, camera, film, x, y, isa_);
}

std::string Session::camera() const {
  const std::lock_guard lock(mutex_);
  return camera_yaml(status_.state.camera);
}

std::string Session::save(const std::string& extension) {
  std::shared_ptr<const Picture> picture;
  ImageMetadata metadata;
  {
    std::unique_lock lock(mutex_);
    const std::uint64_t view = status_.view;
    const bool layers = extension == ".exr";
    const auto complete = [&] {
      return finished_ != nullptr && (!layers || finished_->find("Z") != nullptr);
    };
    if (layers && !complete()) wants_layers_ = true, changed_.notify_all();
    changed_.wait(lock, [&] { return stopping_ || status_.view != view || complete(); });
    if (stopping_ || status_.view != view)
      throw Error("the view has changed before the picture was finished");
    picture = finished_, metadata = metadata_;
  }
  const PrivateFolder folder;
  const std::filesystem::path path = folder.path() / ("picture" + extension);
  write_image(path.string(), *picture, metadata);
  return content(path);
}

}  // namespace oktett
