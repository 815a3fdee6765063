#include "render/picture/prepared_scene.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <mutex>

#include "core/phase.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/film/cryptomatte.h"
#include "render/film/film.h"
#include "render/film/film_state.h"
#include "render/film/tile.h"
#include "render/light_groups.h"
#include "render/moments.h"
#include "render/photon/caustics.h"

namespace oktett {

// ---- A camera and lights for scenes that state none.

/// Room left around the box, as a fraction of the frame.
static constexpr double kViewMargin = 0.05;

Camera frame_bounds(const Box& bounds, const Camera& given, const Film& film) {
  Box box = bounds;
  if (box.empty() || !is_finite(box.lo) || !is_finite(box.hi)) box = {{-1, -1, -1}, {1, 1, 1}};
  const Vec3d lo(box.lo), hi(box.hi);
  const Vec3d center = (lo + hi) * 0.5;
  Camera camera = given;
  camera.at = center;
  // From the right of the front and slightly above. Until the distance is known, `from` is only a direction.
  const Vec3d front = std::abs(camera.up.z) > std::abs(camera.up.y) ? Vec3d{0, -1, 0} : Vec3d{0, 0, 1};
  const bool lies = std::abs(camera.up.x) > std::max(std::abs(camera.up.y), std::abs(camera.up.z));
  const Vec3d right = lies ? normalize(cross(camera.up, front)) : Vec3d{1, 0, 0};
  camera.from = center + right * 0.55 + camera.up * (0.45 / length(camera.up)) + front;

  const CameraFrame frame = camera_frame(camera, film);
  const double half_height = frame.pixel_size * std::max(film.height, 1u) / 2 * (1 - kViewMargin);
  const double half_width = frame.pixel_size * std::max(film.width, 1u) / 2 * (1 - kViewMargin);
  double distance = 0, size = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p{corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z};
    const Vec3d d = p - center;
    const double across = std::abs(dot(d, frame.right)), along = std::abs(dot(d, frame.up));
    const double nearer = -dot(d, frame.forward);
    size = std::max(size, length(d));
    if (camera.projection == Projection::perspective) {
      distance = std::max(distance, nearer + std::max(across / half_width, along / half_height));
    } else {
      camera.height = std::max(corner == 0 ? 0 : camera.height,
                               2 / (1 - kViewMargin) * std::max(along, across * half_height / half_width));
    }
  }
  if (size == 0) size = 1;
  if (camera.projection == Projection::orthographic) distance = 2 * size;
  if (!(distance > 0)) distance = size;
  if (!(camera.height > 0)) camera.height = 2 * size;
  camera.from = center - frame.forward * distance;
  return camera;
}

std::vector<Light> default_lights(const Camera& camera, const Film& film) {
  const CameraFrame frame = camera_frame(camera, film);
  const auto towards = [&](double right, double up, double forward) {
    return normalize(frame.right * right + frame.up * up + frame.forward * forward);
  };
  return {DirectionalLight{towards(0.6, -0.8, 1), {0.85f, 0.85f, 0.85f}},
          DirectionalLight{towards(-0.9, -0.2, 0.8), {0.25f, 0.25f, 0.25f}}};
}

// ---- The scene.

namespace {

using Clock = std::chrono::steady_clock;

/// Collects the reports of tiles and calls the caller's functions, one thread at a time.
class Monitor {
 public:
  Monitor(const RenderOptions& options, const std::vector<FinishedTile>& tiles, const Picture& picture,
          Clock::time_point start)
      : options_(options), picture_(picture), start_(start) {
    for (std::size_t i = 0; i < tiles.size(); ++i)
      if (options.film == nullptr || options.film->in_share(i))
        progress_.pixels_total += std::uint64_t{tiles[i].width} * tiles[i].height;
  }

  bool stop_wanted() const {
    return options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
  }

  void skip_tile() {
    const std::lock_guard lock(mutex_);
    report_.stopped = true;
  }

  void finish_tile(const FinishedTile& tile, const TileCounts& counts) {
    const std::lock_guard lock(mutex_);
    report_.camera_hits += counts.rays.camera_hits;
    report_.camera_rays += counts.rays.camera, report_.shadow_rays += counts.rays.shadow;
    report_.reflected_rays += counts.rays.reflected, report_.refracted_rays += counts.rays.refracted;
    if (report_.bounces.size() < counts.rays.bounces.size())
      report_.bounces.resize(counts.rays.bounces.size());
    for (std::size_t i = 0; i < counts.rays.bounces.size(); ++i)
      add(counts.rays.bounces[i], report_.bounces[i]);
    report_.bad_samples += counts.bad_samples;
    progress_.rays += counts.rays.total();
    progress_.pixels_done += static_cast<std::uint64_t>(tile.width) * tile.height;
    if (options_.tile_finished) options_.tile_finished(picture_, tile);
    if (options_.progress && seconds_since(last_call_) >= 0.1) tell_progress();
  }

  void tell_progress() {
    if (!options_.progress) return;
    progress_.seconds = seconds_since(start_);
    options_.progress(progress_);
    last_call_ = Clock::now();
  }

  const RenderReport& report() const { return report_; }

 private:
  static void add(const BounceReport& more, BounceReport& sum) {
    sum.rays += more.rays, sum.shadow_rays += more.shadow_rays, sum.batches += more.batches;
    sum.shaded += more.shaded, sum.lanes += more.lanes;
  }

  const RenderOptions& options_;
  const Picture& picture_;
  Clock::time_point start_;
  std::mutex mutex_;
  RenderProgress progress_;
  RenderReport report_;
  Clock::time_point last_call_ = start_;
};

void describe_world(const World& world, RenderReport& report) {
  report.triangles = world.triangles, report.primitives = world.primitives;
  report.geometry_bytes = world.geometry_bytes, report.bvh_bytes = world.bvh_bytes;
  report.sah_cost = world.sah_cost;
}

/// An object that not all rays meet.
const Object* find_hidden(const Scene& scene) {
  const auto is_hidden = [](const Object& object) { return object.visible_to != kAllRays; };
  const auto find = [&](const std::vector<Object>& objects) {
    const auto found = std::ranges::find_if(objects, is_hidden);
    return found != objects.end() ? &*found : nullptr;
  };
  if (const Object* const object = find(scene.objects)) return object;
  for (const Prototype& prototype : scene.prototypes)
    if (const Object* const object = find(prototype.objects)) return object;
  return nullptr;
}

/// Throws Error for what cannot be honoured together.
void check_visibility(const Scene& scene, const World& world, const SceneLights& lights,
                      const LightGroups& groups) {
  if (wants_photons(scene.integrator)) {
    if (const Object* const object = find_hidden(scene))
      throw Error(object->where, "photons of 'caustics' do not know which rays an object is visible to");
    if (!scene.light_lists.empty())
      throw Error(scene.light_lists.front().where, "photons of 'caustics' light all objects");
  }
  const bool catches = world.has_catchers && traits(scene.integrator.kind).bounces();
  if (catches && wants_photons(scene.integrator))
    throw Error("photons of 'caustics' do not know shadow catchers");
  if (catches && groups.any()) throw Error("light groups do not know shadow catchers");
  const std::vector<std::uint32_t>& visible = lights.set().visible();
  const auto is_listed = [&](std::uint32_t emitter) { return lights.set().list(emitter) != kNoLightList; };
  if (groups.any() && visible.size() > 1 && std::ranges::any_of(visible, is_listed))
    throw Error(scene.light_lists.front().where,
                "light groups cannot tell several environments apart if one lights only some objects");
}

/// The contexts of a picture and of its moments, without objects that are neither shadow catchers nor glow.
class BareContexts {
 public:
  /// For contexts that keep the light of catchers apart.
  void share(RenderContext& context, std::span<RenderContext> moments) {
    if (!context.catches) return;
    for (RenderContext& moment : moments) add(moment);
    add(context);
  }

 private:
  void add(RenderContext& context) {
    RenderContext& bare = contexts_.emplace_back(context);
    bare.world = &worlds_.emplace_back(without_others(*context.world));
    bare.data_layers = false, bare.mattes = nullptr, bare.light_groups = nullptr, bare.moments = nullptr;
    set_visibility(bare);
    context.without_others = &bare;
  }

  std::deque<World> worlds_;
  std::deque<RenderContext> contexts_;
};

/// Begins the film, if there is one, and returns the tiles to render.
std::vector<FinishedTile> plan_tiles(const RenderContext& context, const Picture& picture,
                                     const RenderOptions& options) {
  if (options.film == nullptr) return cut_tiles(picture.width, picture.height, options.tile_size);
  options.film->begin(
      {format_of(context), picture.attributes, context.settings.samples, context.moments != nullptr},
      picture.tone);
  std::vector<FinishedTile> tiles;
  for (std::size_t i = 0; i < options.film->tile_count(); ++i) tiles.push_back(options.film->tile(i));
  return tiles;
}

void render_tiles(const RenderContext& context, const std::vector<FinishedTile>& tiles, FilmState* film,
                  Picture& picture, Monitor& monitor) {
  tbb::enumerable_thread_specific<TileWorkspace> workspaces;
  // One tile per task: their costs differ greatly, and stopping should not wait for a block of tiles.
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, tiles.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          if (monitor.stop_wanted()) {
            monitor.skip_tile();
            continue;
          }
          TileWorkspace& work = workspaces.local();
          if (film == nullptr)
            monitor.finish_tile(tiles[i], render_tile(context, tiles[i], picture, work));
          else if (film->in_share(i))
            monitor.finish_tile(tiles[i], render_film_tile(context, *film, i, picture, work));
        }
      },
      tbb::simple_partitioner());
}

/// Gives the context, or those of all moments, the photons that the settings ask for; none if they want none.
std::vector<Caustics> share_photons(Moments& moments, RenderContext& context, const RenderOptions& options) {
  if (!wants_photons(context.settings)) return {};
  const std::uint32_t added = options.film != nullptr ? options.film->added() : 0;
  const PhotonOptions wanted{options.photons, options.keep_photons, added};
  const std::span<RenderContext> all = moments.contexts();
  std::vector<Caustics> caustics =
      moments.things_move() ? make_caustics(all, wanted) : make_caustics({&context, 1}, wanted);
  context.caustics = &caustics.front();
  for (std::size_t m = 0; m < all.size(); ++m) all[m].caustics = &caustics[m % caustics.size()];
  return caustics;
}

}  // namespace

PreparedScene::PreparedScene(Scene scene, const BuildOptions& build)
    : build_(build),
      scene_(std::move(scene)),
      follows_camera_(!scene_.lights_given && scene_.lights.empty()) {
  const Clock::time_point start = Clock::now();
  world_ = build_world(scene_, build_);
  bounds_ = world_.bounds;
  build_seconds_ = seconds_since(start);
}

void PreparedScene::fill_in_camera() {
  if (scene_.camera_given) return;
  scene_.camera = frame_bounds(world_.bounds, scene_.camera, scene_.film);
  scene_.camera_given = true;
}

void PreparedScene::complete() {
  if (scene_.camera_given) return;
  const Moments widened(scene_, world_, build_);
  fill_in_camera();
  world_.bounds = bounds_;
}

void PreparedScene::set(const PictureSettings& settings) {
  scene_.camera = settings.camera, scene_.film = settings.film, scene_.integrator = settings.integrator;
  scene_.camera_given = true;
}

void PreparedScene::fill_in_lights() {
  if (!follows_camera_ && lights_) return;
  if (follows_camera_) scene_.lights = default_lights(scene_.camera, scene_.film);
  lights_.emplace(scene_, world_);
}

RenderResult PreparedScene::render(const RenderOptions& options) {
  RenderResult result;
  const Clock::time_point start = Clock::now();
  world_.bounds = bounds_;
  Moments moments(scene_, world_, build_);
  fill_in_camera();
  const double build_seconds = build_seconds_ + seconds_since(start);

  fill_in_lights();
  RenderContext context = make_context(scene_, world_, *lights_, options.textures, options.isa);
  context.data_layers = options.data_layers;
  const bool wants_mattes = scene_.film.cryptomatte && options.data_layers;
  const Mattes mattes = wants_mattes ? mattes_of(world_) : Mattes{};
  if (wants_mattes) context.mattes = &mattes;
  const LightGroups groups = light_groups(scene_);
  check_visibility(scene_, world_, *lights_, groups);
  if (groups.any() && traits(context.settings.kind).traces_paths && options.data_layers)
    context.light_groups = &groups;
  result.picture = make_picture(format_of(context));
  result.picture.attributes = mattes.attributes;
  moments.share(scene_, context);
  BareContexts bare;
  bare.share(context, moments.contexts());
  const Clock::time_point photons = Clock::now();
  const std::vector<Caustics> caustics = share_photons(moments, context, options);
  if (!caustics.empty()) result.photons = caustics.front().map();
  const double photon_seconds = caustics.empty() ? 0 : seconds_since(photons);
  result.picture.tone = scene_.film.tone;
  const std::vector<FinishedTile> tiles = plan_tiles(context, result.picture, options);
  const Clock::time_point tracing = Clock::now();
  Monitor monitor(options, tiles, result.picture, tracing);
  render_tiles(context, tiles, options.film, result.picture, monitor);
  monitor.tell_progress();

  result.report = monitor.report();
  result.report.build_seconds = build_seconds;
  result.report.photon_seconds = photon_seconds;
  result.report.render_seconds = seconds_since(tracing);
  describe_world(world_, result.report);
  return result;
}

}  // namespace oktett
