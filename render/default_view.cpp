#include "render/default_view.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace oktett {

/// Room left around the box, as a fraction of the frame.
static constexpr double kMargin = 0.05;

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
  const double half_height = frame.pixel_size * std::max(film.height, 1u) / 2 * (1 - kMargin);
  const double half_width = frame.pixel_size * std::max(film.width, 1u) / 2 * (1 - kMargin);
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
                               2 / (1 - kMargin) * std::max(along, across * half_height / half_width));
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

}  // namespace oktett
