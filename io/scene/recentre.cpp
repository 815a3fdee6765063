#include "io/scene/recentre.h"

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>

namespace oktett {
namespace {

/// Where the first mesh that lies far from the origin stands, among `objects` and the prototypes that they
/// show.
std::optional<Vec3d> far_place(std::span<const Object> objects, const std::vector<Prototype>& prototypes) {
  for (const Object& object : objects) {
    if (const auto* const mesh = std::get_if<MeshShape>(&object.shape)) {
      if (!(mesh->mesh->origin == Vec3d{})) return object.transform.point({0, 0, 0});
    } else if (const auto* const csg = std::get_if<CsgShape>(&object.shape)) {
      if (const std::optional<Vec3d> place = far_place(*csg->operands, prototypes))
        return object.transform.point(*place);
    } else if (const auto* const instance = std::get_if<InstanceShape>(&object.shape)) {
      if (const std::optional<Vec3d> place = far_place(prototypes[instance->prototype].objects, prototypes))
        return object.transform.point(*place);
    }
  }
  return std::nullopt;
}

MotionPointer moved(const MotionPointer& motion, const Affine& before, const std::optional<Affine>& after) {
  if (motion == nullptr) return motion;
  Motion m = *motion;
  m.factors.insert(m.factors.begin(), {{0, before}});
  if (after) m.factors.push_back({{0, *after}});
  return std::make_shared<const Motion>(std::move(m));
}

void move_lights(const Vec3d& origin, const Affine& to, const Affine& from, Scene& scene) {
  for (Light& light : scene.lights) {
    if (auto* const point = std::get_if<PointLight>(&light)) point->position = point->position - origin;
    if (auto* const spot = std::get_if<SpotLight>(&light)) spot->position = spot->position - origin;
  }
  for (LightTraits& traits : scene.light_traits) traits.motion = moved(traits.motion, to, from);
}

}  // namespace

void recentre(Scene& scene) {
  const std::optional<Vec3d> place = far_place(scene.objects, scene.prototypes);
  if (!place || *place == Vec3d{}) return;
  const Vec3d origin = *place;
  const Affine to = Affine::translation(origin * -1.0), from = Affine::translation(origin);
  scene.origin = origin;
  Camera& camera = scene.camera;
  if (scene.camera_given) {
    camera.from = camera.from - origin, camera.at = camera.at - origin;
    if (camera.focus_at) camera.focus_at = *camera.focus_at - origin;
    camera.motion = moved(camera.motion, to, from);
  }
  move_lights(origin, to, from, scene);
  for (Object& object : scene.objects) {
    object.transform = to * object.transform;
    object.motion = moved(object.motion, to, std::nullopt);
  }
  for (Medium& medium : scene.media) medium.grid_place = to * medium.grid_place;
}

}  // namespace oktett
