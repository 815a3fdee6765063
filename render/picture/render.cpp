#include "render/picture/render.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <optional>

#include "core/error.h"
#include "render/picture/prepared_scene.h"

namespace oktett {

static RenderResult render_here(Scene scene, const RenderOptions& options) {
  PreparedScene prepared(std::move(scene), options.build);
  RenderResult result = prepared.render(options);
  result.scene = prepared.take_scene();
  return result;
}

RenderResult render(Scene scene, const RenderOptions& options) {
  if (options.threads == 0) return render_here(std::move(scene), options);
  if (options.threads > kMostThreads)
    throw Error(fmt::format("{} threads are out of range; expected 0 to {}", options.threads, kMostThreads));
  std::optional<tbb::global_control> more;
  // By itself an arena gets at most as many threads as the machine has.
  if (static_cast<int>(options.threads) > tbb::info::default_concurrency())
    more.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  tbb::task_arena arena(static_cast<int>(options.threads));
  return arena.execute([&] { return render_here(std::move(scene), options); });
}

}  // namespace oktett
