#include "render/render.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <mutex>
#include <optional>

#include "render/context.h"
#include "render/default_view.h"
#include "render/film/cryptomatte.h"
#include "render/film/film.h"
#include "render/film/film_state.h"
#include "render/film/tile.h"
#include "render/geometry.h"
#include "render/light_groups.h"
#include "render/moments.h"
#include "render/photon/caustics.h"

namespace oktett {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

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

/// Fills in camera and lights where the scene gives none.
void complete_scene(Scene& scene, const Box& bounds) {
  if (!scene.camera_given) scene.camera = frame_bounds(bounds, scene.camera, scene.film);
  if (!scene.lights_given && scene.lights.empty()) scene.lights = default_lights(scene.camera, scene.film);
}

void describe_world(const World& world, RenderReport& report) {
  report.triangles = world.triangles, report.primitives = world.primitives;
  report.geometry_bytes = world.geometry_bytes, report.bvh_bytes = world.bvh_bytes;
  report.sah_cost = world.sah_cost;
}

/// Begins the film, if there is one, and returns the tiles to render.
std::vector<FinishedTile> plan_tiles(const RenderContext& context, const Picture& picture,
                                     const RenderOptions& options) {
  if (options.film == nullptr) return cut_tiles(picture.width, picture.height, options.tile_size);
  options.film->begin({format_of(context), picture.attributes, picture.tone, context.settings.samples,
                       context.moments != nullptr});
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
  const PhotonOptions wanted{options.photons, options.keep_photons};
  const std::span<RenderContext> all = moments.contexts();
  std::vector<Caustics> caustics =
      moments.things_move() ? make_caustics(all, wanted) : make_caustics({&context, 1}, wanted);
  context.caustics = &caustics.front();
  for (std::size_t m = 0; m < all.size(); ++m) all[m].caustics = &caustics[m % caustics.size()];
  return caustics;
}

RenderResult render_here(Scene scene, const RenderOptions& options) {
  RenderResult result;
  const Clock::time_point start = Clock::now();
  World world = build_world(scene, options.build);
  Moments moments(scene, world, options.build);
  complete_scene(scene, world.bounds);
  const double build_seconds = seconds_since(start);

  const SceneLights lights(scene, world);
  RenderContext context = make_context(scene, world, lights, options.textures, options.isa);
  context.data_layers = options.data_layers;
  const bool wants_mattes = scene.film.cryptomatte && options.data_layers;
  const Mattes mattes = wants_mattes ? mattes_of(world) : Mattes{};
  if (wants_mattes) context.mattes = &mattes;
  const LightGroups groups = light_groups(scene);
  if (groups.any() && context.settings.kind == IntegratorKind::path && options.data_layers)
    context.light_groups = &groups;
  result.picture = make_picture(format_of(context));
  result.picture.attributes = mattes.attributes;
  moments.share(scene, context);
  const Clock::time_point photons = Clock::now();
  const std::vector<Caustics> caustics = share_photons(moments, context, options);
  if (!caustics.empty()) result.photons = caustics.front().map();
  const double photon_seconds = caustics.empty() ? 0 : seconds_since(photons);
  result.picture.tone = scene.film.tone;
  const std::vector<FinishedTile> tiles = plan_tiles(context, result.picture, options);
  const Clock::time_point tracing = Clock::now();
  Monitor monitor(options, tiles, result.picture, tracing);
  render_tiles(context, tiles, options.film, result.picture, monitor);
  monitor.tell_progress();

  result.report = monitor.report();
  result.report.build_seconds = build_seconds;
  result.report.photon_seconds = photon_seconds;
  result.report.render_seconds = seconds_since(tracing);
  describe_world(world, result.report);
  result.scene = std::move(scene);
  return result;
}

}  // namespace

RenderResult render(Scene scene, const RenderOptions& options) {
  if (options.threads == 0) return render_here(std::move(scene), options);
  std::optional<tbb::global_control> more;
  // By itself an arena gets at most as many threads as the machine has.
  if (static_cast<int>(options.threads) > tbb::info::default_concurrency())
    more.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  tbb::task_arena arena(static_cast<int>(options.threads));
  return arena.execute([&] { return render_here(std::move(scene), options); });
}

}  // namespace oktett
