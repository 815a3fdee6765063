#pragma once
/// \file What an image file says about how it was made.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "render/scene.h"

namespace oktett {

/// A 4x4 matrix, row-major, for row vectors: p' = [x y z 1] M, the translation stands in the last row. This
/// is the convention of RenderMan and OpenEXR.
using Matrix4 = std::array<float, 16>;

/// The camera as OpenEXR's standard attributes of the same names state it.
struct CameraMatrices {
  /// World to camera space: left-handed, origin at the camera, x to the right, y up, z the viewing direction.
  Matrix4 world_to_camera{};
  /// World to normalised device coordinates: after division by w, (0, 0) is the upper left and (1, 1) the
  /// lower right corner of the full frame; z is 1 - 1 / depth for perspective, depth for orthographic, and of
  /// no further meaning.
  Matrix4 world_to_ndc{};
};

/// The matrices of a camera that fills a frame of `width` x `height` pixels; nothing for a camera whose view
/// direction or `up` is degenerate, and for curved projections, which no matrix describes.
std::optional<CameraMatrices> camera_matrices(const Camera& camera, std::uint32_t width,
                                              std::uint32_t height);

/// What is stored with a picture: everything in EXR, the texts in PNG and TIFF. Empty and zero members are
/// left out.
struct ImageMetadata {
  std::string software;       ///< "oktett 1.2.3"; attribute `Software`
  std::string command_line;   ///< attribute `commandLine`
  std::string scene;          ///< path as the user gave it; attribute `scene`
  std::uint32_t samples = 0;  ///< per pixel; attribute `samples`
  double render_seconds = 0;  ///< attribute `renderSeconds`
  std::optional<CameraMatrices> camera;
  Vec3d origin;  ///< Scene::origin, from which `camera` and the planes of positions count; attribute `origin`
};

}  // namespace oktett
