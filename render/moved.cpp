#include "render/moved.h"

#include "core/math.h"
#include "render/light/aimed_profile.h"

namespace oktett {

/// Turns the profile of a lamp, aimed along `down`, as a transform turns what is seen of it: down and where
/// horizontal angles count from.
static void turn_profile(const Affine& motion, Vec3d& down, double& rotation) {
  const Vec3d zero = motion.vector(aim(nullptr, down, rotation).zero);
  down = motion.vector(down);
  const AimedProfile unturned = aim(nullptr, down, 0);
  rotation =
      portable::atan2(dot(zero, cross(unturned.zero, unturned.down)), dot(zero, unturned.zero)) / kDegree;
}

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
  if (auto* point = std::get_if<PointLight>(&moved)) {
    point->position = motion.point(point->position);
    if (point->profile != nullptr) turn_profile(motion, point->down, point->rotation);
  }
  if (auto* spot = std::get_if<SpotLight>(&moved)) {
    spot->position = motion.point(spot->position);
    if (spot->profile != nullptr)
      turn_profile(motion, spot->direction, spot->rotation);
    else
      spot->direction = motion.vector(spot->direction);
  }
  if (auto* far = std::get_if<DirectionalLight>(&moved)) far->direction = motion.vector(far->direction);
  return moved;
}

}  // namespace oktett
