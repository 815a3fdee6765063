#include "render/moved.h"

namespace oktett {

Camera camera_at(const Camera& camera, double time) {
  if (camera.motion == nullptr) return camera;
  const Affine motion = camera.motion->at(time);
  Camera moved = camera;
  moved.from = motion.point(camera.from), moved.at = motion.point(camera.at);
  moved.up = motion.vector(camera.up);
  if (camera.focus_at) moved.focus_at = motion.point(*camera.focus_at);
  return moved;
}

Light moved_light(const Affine& motion, const Light& light) {
  Light moved = light;
  if (auto* point = std::get_if<PointLight>(&moved)) point->position = motion.point(point->position);
  if (auto* spot = std::get_if<SpotLight>(&moved)) {
    spot->position = motion.point(spot->position);
    spot->direction = motion.vector(spot->direction);
  }
  if (auto* far = std::get_if<DirectionalLight>(&moved)) far->direction = motion.vector(far->direction);
  return moved;
}

}  // namespace oktett
