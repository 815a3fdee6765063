#pragma once
/// \file How a scene is rendered, and what that took.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "core/isa.h"
#include "render/picture.h"
#include "render/scene.h"
#include "render/texture_sampler.h"

namespace oktett {

/// How far a render is; handed to RenderOptions::progress by one thread at a time.
struct RenderProgress {
  std::uint64_t pixels_done = 0, pixels_total = 0;
  std::uint64_t rays = 0;  ///< traced so far, of all kinds
  double seconds = 0;      ///< since tracing began
};

/// A rectangle of finished pixels, in the picture's own coordinates, for live previews.
struct FinishedTile {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

/// The photons that bring caustics, see read_photon_map and write_photon_map.
struct PhotonMap;

/// A picture in progress: sums of finished tiles, in files of their own, see `oktett render --checkpoint`.
class FilmState;

/// The greatest RenderOptions::threads.
inline constexpr unsigned kMostThreads = 4096;

/// How a scene is rendered. The picture depends on `textures` and `data_layers` and, if it is not null, on
/// `film`.
struct RenderOptions {
  Isa isa = default_isa();
  unsigned threads = 0;  ///< at most kMostThreads; 0: as many as the process may use
  const TextureSampler* textures =
      nullptr;  ///< of the scene, e.g. ImageTextures; null: all textures are white
  /// May be null. When it becomes true, tiles not yet begun are left black with alpha 0.
  const std::atomic<bool>* stop = nullptr;
  /// May be empty. Called about ten times a second.
  std::function<void(const RenderProgress&)> progress;
  /// May be empty. Called for each finished tile, by one thread at a time, with the picture so far, of which
  /// only R, G, B and A are filled.
  std::function<void(const Picture&, const FinishedTile&)> tile_finished;
  /// For pictures with caustics: the photons to use, or null to trace some. They must have been made for the
  /// same scene and settings but for camera, film and samples.
  std::shared_ptr<const PhotonMap> photons;
  bool keep_photons = false;  ///< trace photons of all passes, for RenderResult::photons
  /// May be null. Tiles that it has are not rendered again; the others are added, as far as they are of its
  /// share of the picture. The rest is left black with alpha 0.
  FilmState* film = nullptr;
  BuildOptions build;            ///< of the acceleration structures
  std::uint32_t tile_size = 32;  ///< pixels along the edge of a tile, [1, 256]
  bool data_layers = true;       ///< also fill the planes Z, N, P, Albedo, u, v, ids and Variance
};

/// The rays of one bounce, over all tiles: how well they fill what works on many of them at once.
struct BounceReport {
  std::uint64_t rays = 0;         ///< camera rays at bounce 0; without shadow rays
  std::uint64_t shadow_rays = 0;  ///< from the surfaces that these rays meet
  std::uint64_t batches = 0;      ///< in which the rays were traced
  std::uint64_t shaded = 0;       ///< hits that were shaded in lanes
  std::uint64_t lanes = 0;        ///< that this took, idle ones included
};

/// What a render took, and what it met.
struct RenderReport {
  double build_seconds = 0, render_seconds = 0;
  double photon_seconds = 0;  ///< of tracing photons or of checking those given
  std::uint64_t camera_rays = 0, shadow_rays = 0, reflected_rays = 0, refracted_rays = 0;
  std::uint64_t camera_hits = 0;      ///< camera rays that met something
  std::vector<BounceReport> bounces;  ///< of Whitted's integrator and of path tracing
  std::uint64_t bad_samples = 0;      ///< NaN or infinite samples that were left out
  std::uint64_t triangles = 0;        ///< each counted once, however many instances show it
  std::uint64_t primitives = 0;       ///< of all kinds, counted likewise
  std::uint64_t geometry_bytes = 0;   ///< meshes
  std::uint64_t bvh_bytes = 0;        ///< nodes and leaves
  double sah_cost = 0;                ///< AccelStats::sah_cost of the whole scene's structure
  bool stopped = false;               ///< not all tiles were rendered
};

}  // namespace oktett
