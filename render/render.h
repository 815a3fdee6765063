#pragma once
/// \file From a scene to a picture in one call.

#include <atomic>
#include <cstdint>
#include <functional>

#include "accel/accel.h"
#include "core/isa.h"
#include "render/picture.h"
#include "render/scene.h"
#include "render/texture_sampler.h"

namespace oktett {

/// How far a render is; handed to RenderOptions::progress from one thread at a time.
struct RenderProgress {
  std::uint64_t pixels_done = 0, pixels_total = 0;
  std::uint64_t rays = 0;  ///< rays traced so far, of all kinds
  double seconds = 0;      ///< since tracing began
};

/// A rectangle of finished pixels, in the picture's own coordinates, for live previews.
struct FinishedTile {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

struct RenderOptions {
  Isa isa = Isa::scalar;                     ///< callers usually pass default_isa()
  unsigned threads = 0;                      ///< 0 = all that the process may use
  const TextureSampler* textures = nullptr;  ///< null: textures are white
  const std::atomic<bool>* stop =
      nullptr;  ///< when it becomes true, tiles not yet begun are left black and alpha 0
  std::function<void(const RenderProgress&)> progress;  ///< may be empty; called about ten times a second
  /// May be empty; called for each finished tile, one at a time, with the picture as it stands (colour planes
  /// only).
  std::function<void(const Picture&, const FinishedTile&)> tile_finished;
  BuildOptions build;  ///< of the acceleration structures; the picture does not depend on it
  std::uint32_t tile_size =
      32;                   ///< pixels along the edge of a tile, [1, 256]; the picture does not depend on it
  bool data_layers = true;  ///< also fill Z, N, P, Albedo, u, v, ids and Variance planes
};

/// What a render took and met.
struct RenderReport {
  double build_seconds = 0, render_seconds = 0;
  std::uint64_t camera_rays = 0, shadow_rays = 0, reflected_rays = 0, refracted_rays = 0;
  std::uint64_t bad_samples = 0;     ///< NaN or infinite samples that were left out
  std::uint64_t triangles = 0;       ///< unique, before instancing
  std::uint64_t primitives = 0;      ///< unique primitives of all kinds
  std::uint64_t geometry_bytes = 0;  ///< meshes
  std::uint64_t bvh_bytes = 0;       ///< nodes and leaves
  double sah_cost = 0;
  bool stopped = false;  ///< not all tiles were rendered
};

struct RenderResult {
  Picture picture;
  RenderReport report;
  Scene scene;  ///< with camera and lights filled in where the scene gave none
};

/// Builds the acceleration structure and renders. The picture depends on the scene alone: not on threads,
/// instruction set or timing. Never throws for what a scene can hold; throws std::bad_alloc when memory runs
/// out.
RenderResult render(Scene scene, const RenderOptions& options);

}  // namespace oktett
