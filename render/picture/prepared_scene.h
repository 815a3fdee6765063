#pragma once
/// \file A scene whose acceleration structures are kept, for many pictures of it.

#include <memory>
#include <optional>
#include <vector>

#include "core/box.h"
#include "render/geometry.h"
#include "render/picture/render.h"
#include "render/scene.h"
#include "render/scene_lights.h"

namespace oktett {

// ---- A camera and lights for scenes that state none.

/// A camera that looks at the centre of `bounds` from a three-quarter view, as near as it can be with all of
/// the box in the frame. Field of view, projection and up direction are those of `given`. Empty or non-finite
/// bounds count as the box from -1 to 1.
Camera frame_bounds(const Box& bounds, const Camera& given, const Film& film);

/// A key light from above left of the camera and a weaker fill light from its right.
std::vector<Light> default_lights(const Camera& camera, const Film& film);

// ---- The scene.

/// What of a scene may change from picture to picture.
struct PictureSettings {
  Camera camera;
  Film film;
  IntegratorSettings integrator;  ///< `kind` and `light_samples` must stay those of the scene
};

/// Builds the acceleration structures of a scene once and renders it any number of times. Each picture has
/// the bits that render() gives for the same scene with the same settings. One thread at a time may use it.
class PreparedScene {
 public:
  /// Throws std::bad_alloc if memory runs out.
  PreparedScene(Scene scene, const BuildOptions& build);
  PreparedScene(const PreparedScene&) = delete;
  PreparedScene& operator=(const PreparedScene&) = delete;

  /// The scene given. After the first picture with camera and lights filled in if it had none.
  const Scene& scene() const { return scene_; }
  const World& world() const { return world_; }
  /// Takes the scene out; nothing else may be called then.
  Scene take_scene() { return std::move(scene_); }

  /// Fills in the camera if the scene gives none, before the first picture does.
  void complete();
  PictureSettings settings() const { return {scene_.camera, scene_.film, scene_.integrator}; }
  /// For all pictures from now on. Lights that the scene does not give follow the camera.
  void set(const PictureSettings& settings);

  /// Renders, with as many threads as the caller's arena has; `threads` and `build` of the options do not
  /// count. RenderResult::scene stays empty. Throws as render() does.
  RenderResult render(const RenderOptions& options);

 private:
  void fill_in_camera();
  void fill_in_lights();

  BuildOptions build_;
  Scene scene_;
  bool follows_camera_;  ///< the lights do, as the scene has none
  double build_seconds_ = 0;
  World world_;
  Box bounds_;                         ///< of the world, when nothing has moved
  std::optional<SceneLights> lights_;  ///< of the last picture
};

}  // namespace oktett
