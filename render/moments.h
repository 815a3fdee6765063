#pragma once
/// \file Motion blur: the time in which the shutter is open, cut into moments.
///
/// Between moments things move, at each moment they stand still: it has an acceleration structure, lights and
/// a camera of its own, and everything that traces and shades rays stays as it is. Structures of meshes,
/// prototypes and all that does not move are built once; only the tree over them is built for each moment,
/// and those of meshes that are bent. Samples of a moment are consecutive, so they are spread evenly over the
/// pixel in themselves and together.

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "render/context.h"
#include "render/scene.h"

namespace oktett {

// ---- Cameras and lights that have been moved.

/// The camera at a time.
Camera camera_at(const Camera& camera, double time);

/// A light as a transform moves it. Environments and skies stay.
Light moved_light(const Affine& motion, const Light& light);

// ---- Moments of the shutter.

/// More moments look the same in most pictures, and each takes memory.
inline constexpr std::uint32_t kMostMoments = 64;

/// Most triangles of bent meshes at all moments together: each has trees of its own. For more there are fewer
/// moments, down to kLeastBentMoments.
inline constexpr std::uint64_t kMostBentTriangles = 1u << 23;
inline constexpr std::uint32_t kLeastBentMoments = 8;

/// The first of the `samples` samples of a pixel that belongs to moment `moment`, [0, moments]. `samples` is
/// at least `moments`.
constexpr std::uint32_t first_sample_of_moment(std::uint32_t moment, std::uint32_t moments,
                                               std::uint32_t samples) {
  return static_cast<std::uint32_t>(std::uint64_t{moment} * samples / moments);
}

/// The moments of a scene in which something moves; none for other scenes.
class Moments {
 public:
  /// Chooses times, each at random in the part of the shutter's time that its share of the samples stands
  /// for, and builds the structures. Widens the bounds of `world`, which must outlive this, to all moments.
  Moments(const Scene& scene, World& world, const BuildOptions& build);
  Moments(const Moments&) = delete;
  Moments& operator=(const Moments&) = delete;

  /// Sets context.moments to copies of `context`, which must be complete, with what is different at each
  /// moment. The scene's lights are moved meanwhile.
  void share(Scene& scene, RenderContext& context);

  /// The copies that `share` made.
  std::span<RenderContext> contexts() { return contexts_; }
  /// Whether objects or lights move, not the camera alone.
  bool things_move() const { return things_move_; }

  const std::vector<double>& times() const { return times_; }

 private:
  const World& world_;
  std::vector<double> times_;
  bool things_move_ = false;
  std::vector<World> worlds_;       ///< of each time; empty if no object moves
  std::deque<SceneLights> lights_;  ///< of each time; empty if no light moves
  std::vector<RenderContext> contexts_;
};

}  // namespace oktett
