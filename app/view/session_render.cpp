/// \file The thread of a Session that renders.

#include "app/view/session.h"

#include <algorithm>
#include <cmath>

#include "app/scene_loading.h"
#include "core/phase.h"
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

}  // namespace

bool Session::has_changed(std::uint64_t view) const {
  const std::lock_guard lock(mutex_);
  return stopping_ || reload_wanted_ || status_.view != view;
}

bool Session::is_finished(bool layers) const {
  return finished_ != nullptr && (!layers || finished_->find("Z") != nullptr);
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
      const bool adopted = reload();
      const std::lock_guard lock(mutex_);
      // The edit has ended a pass of the view that is still shown.
      if (!adopted && !failure_ && !is_finished(wants_layers_)) done = 0;
      canvas_.wake();
      continue;
    }
    try {
      render_view(only_last);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      if (status_.view == done) {
        failure_ = Error(reason_of(error));
        status_.settled = finished_ != nullptr;
        changed_.notify_all();
      }
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
  options.data_layers = needs_data(state.layer) || (last && (layers || arguments_.denoise));
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
  if (last && arguments_.denoise) {
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

}  // namespace oktett
