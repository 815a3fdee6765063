#include "render/recentre.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "core/far_mesh.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

/// Boxes around objects, in double.
class ObjectBoxes {
 public:
  /// `some`: of meshes only a few vertices, so the boxes hold a part.
  ObjectBoxes(const std::vector<Prototype>& prototypes, bool some)
      : prototypes_(prototypes), of_prototypes_(prototypes.size()), some_(some) {}

  /// Grows `box` by the image of an object.
  void add(const Object& object, const Affine& outer, WideBox& box) {
    const Affine map = outer * object.transform;
    std::visit([&](const auto& shape) { add_shape(shape, map, box); }, object.shape);
  }

 private:
  static void add_box(const WideBox& own, const Affine& map, WideBox& box) {
    if (own.empty()) return;
    for (int corner = 0; corner < 8; ++corner)
      box.grow(map.point({(corner & 1 ? own.hi : own.lo).x, (corner & 2 ? own.hi : own.lo).y,
                          (corner & 4 ? own.hi : own.lo).z}));
  }
  static void add_box(const Box& own, const Affine& map, WideBox& box) {
    if (!own.empty()) add_box(WideBox{Vec3d(own.lo), Vec3d(own.hi)}, map, box);
  }

  void add_shape(const MeshShape& shape, const Affine& map, WideBox& box) const {
    if (shape.mesh == nullptr || shape.mesh->positions.empty()) return;
    const Column<Vec3f>& positions = shape.mesh->positions;
    if (some_) return add_box(box_of_some(positions), map, box);
    WideBox own;
    for (const Vec3f& p : positions) own.grow(Vec3d(p));
    add_box(own, map, box);
  }
  void add_shape(const CsgShape& shape, const Affine& map, WideBox& box) {
    for (const Object& operand : *shape.operands) add(operand, map, box);
  }
  void add_shape(const InstanceShape& shape, const Affine& map, WideBox& box) {
    if (shape.prototype >= prototypes_.size()) return;
    std::optional<WideBox>& own = of_prototypes_[shape.prototype];
    if (!own) {
      WideBox all;
      for (const Object& object : prototypes_[shape.prototype].objects) add(object, {}, all);
      own = all;
    }
    add_box(*own, map, box);
  }
  void add_shape(const ExactShape& shape, const Affine& map, WideBox& box) const {
    add_box(exact_bounds(shape, {}), map, box);
  }
  template <class S>
  void add_shape(const S& shape, const Affine& map, WideBox& box) const {
    if constexpr (requires { shape.bounds(); }) add_box(shape.bounds(), map, box);
  }

  const std::vector<Prototype>& prototypes_;
  std::vector<std::optional<WideBox>> of_prototypes_;
  const bool some_;
};

using Prototypes = std::vector<Prototype>;

WideBox box_of(const Object& object, ObjectBoxes& boxes) {
  WideBox box;
  boxes.add(object, {}, box);
  return box;
}

/// The centre of all objects and of the camera, if one is given, if they lie far.
std::optional<Vec3d> far_centre_of(const Scene& scene) {
  for (const bool some : {true, false}) {
    ObjectBoxes boxes(scene.prototypes, some);
    WideBox all;
    if (scene.camera_given) all.grow(scene.camera.from), all.grow(scene.camera.at);
    for (const Object& object : scene.objects) {
      boxes.add(object, {}, all);
      if (all.extent() > 0 && surely_near(all)) return std::nullopt;
    }
    // The boxes of most shapes are rounded to floats.
    if (!some) return far_centre(all, 0x1p-22, false);
  }
  return std::nullopt;
}

MotionPointer moved_motion(const MotionPointer& motion, const std::optional<Affine>& before,
                           const std::optional<Affine>& after) {
  if (motion == nullptr) return motion;
  Motion m = *motion;
  if (before) m.factors.insert(m.factors.begin(), {{0, *before}});
  if (after) m.factors.push_back({{0, *after}});
  return std::make_shared<const Motion>(std::move(m));
}

/// The object, whose own space now counts from `place`, stays where it is.
void shift_own_space(const Vec3d& place, Object& object) {
  const Affine there = Affine::translation(place);
  object.transform = object.transform * there;
  object.motion = moved_motion(object.motion, std::nullopt, there);
}

/// Moves spaces from the innermost one out.
class Recentring {
 public:
  explicit Recentring(Prototypes& prototypes) : prototypes_(prototypes), places_(prototypes.size()) {
    for (std::size_t i = 0; i < prototypes.size(); ++i) places_[i] = move(prototypes[i].objects);
  }

  /// Has the objects of a space count from where the first of them stands that is far and holds a mesh that
  /// is far in its file. Returns that place.
  std::optional<Vec3d> move(std::vector<Object>& objects) {
    std::optional<Vec3d> place;
    for (Object& object : objects)
      if (holds_far_mesh(object) && !place && is_far(box_of(object, boxes_)))
        place = object.transform.point({0, 0, 0});
    if (place) move(objects, *place);
    return place;
  }
  static void move(std::vector<Object>& objects, const Vec3d& place) {
    const Affine to = Affine::translation(place * -1.0);
    for (Object& object : objects) {
      object.transform = to * object.transform;
      object.motion = moved_motion(object.motion, to, std::nullopt);
    }
  }

 private:
  /// Moves the space inside of the object first.
  bool holds_far_mesh(Object& object) {
    std::optional<Vec3d> place;
    if (const auto* const mesh = std::get_if<MeshShape>(&object.shape))
      return mesh->mesh != nullptr && !(mesh->mesh->origin == Vec3d{});
    if (auto* const csg = std::get_if<CsgShape>(&object.shape)) {
      std::vector<Object> operands = *csg->operands;
      place = move(operands);
      csg->operands = std::make_shared<const std::vector<Object>>(std::move(operands));
      if (place && csg->windows != nullptr) {
        std::vector<Object> windows = *csg->windows;
        move(windows, *place);
        csg->windows = std::make_shared<const std::vector<Object>>(std::move(windows));
      }
    } else if (const auto* const instance = std::get_if<InstanceShape>(&object.shape)) {
      if (instance->prototype < places_.size()) place = places_[instance->prototype];
    }
    if (place) shift_own_space(*place, object);
    return place.has_value();
  }

  Prototypes& prototypes_;
  // A prototype shows only earlier ones, which have been moved when their boxes are asked for.
  ObjectBoxes boxes_{prototypes_, false};
  std::vector<std::optional<Vec3d>> places_;
};

void move_lights(const Vec3d& origin, const Affine& to, const Affine& from, Scene& scene) {
  for (Light& light : scene.lights) {
    if (auto* const point = std::get_if<PointLight>(&light)) point->position = point->position - origin;
    if (auto* const spot = std::get_if<SpotLight>(&light)) spot->position = spot->position - origin;
    if (auto* const far = std::get_if<DirectionalLight>(&light); far != nullptr && far->from)
      far->from = *far->from - origin;
  }
  for (LightTraits& traits : scene.light_traits) traits.motion = moved_motion(traits.motion, to, from);
}

}  // namespace

void place_mesh(Object& object) {
  const auto* const shape = std::get_if<MeshShape>(&object.shape);
  if (shape != nullptr && shape->mesh != nullptr && !(shape->mesh->origin == Vec3d{}))
    shift_own_space(shape->mesh->origin, object);
}

void recentre(Scene& scene) {
  if (!(scene.origin == Vec3d{})) return;
  std::optional<Vec3d> place = Recentring(scene.prototypes).move(scene.objects);
  if (!place && (place = far_centre_of(scene))) Recentring::move(scene.objects, *place);
  if (!place) return;
  const Vec3d origin = *place;
  const Affine to = Affine::translation(origin * -1.0), from = Affine::translation(origin);
  scene.origin = origin;
  Camera& camera = scene.camera;
  if (scene.camera_given) {
    camera.from = camera.from - origin, camera.at = camera.at - origin;
    camera.mesh_origin = camera.mesh_origin - origin;
    if (camera.focus_at) camera.focus_at = *camera.focus_at - origin;
    camera.motion = moved_motion(camera.motion, to, from);
  }
  move_lights(origin, to, from, scene);
  for (Fog& fog : scene.fogs) fog.offset -= dot(origin, normalize(fog.up));
  for (Medium& medium : scene.media) medium.grid_place = to * medium.grid_place;
}

std::vector<Warning> find_lost_digits(const Scene& scene) {
  // Bits of a float, without those that are to be left of an extent.
  constexpr double kMost = 0x1p17;
  ObjectBoxes some(scene.prototypes, true), whole(scene.prototypes, false);
  std::size_t count = 0;
  const Object* first = nullptr;
  WideBox first_box;
  for (const Object& object : scene.objects) {
    const WideBox part = box_of(object, some);
    if (part.distance() <= part.extent() * kMost) continue;
    const WideBox all = box_of(object, whole);
    if (all.distance() <= all.extent() * kMost || all.extent() == 0) continue;
    if (count++ == 0) first = &object, first_box = all;
  }
  if (first == nullptr) return {};
  const Vec3d& from = scene.origin;
  const std::string who = first->name.empty() ? "an object" : "'" + first->name + "'";
  const std::string others = count == 1   ? ""
                             : count == 2 ? " (and one more)"
                                          : fmt::format(" (and {} more)", count - 1);
  return {{first->where,
           fmt::format(
               "{}{} of the extent {:.3g} lies {:.3g} away from ({:.9g}, {:.9g}, {:.9g}), where the scene "
               "counts from: floats round positions there to {:.2g}, so details are lost",
               who, others, first_box.extent(), first_box.distance(), from.x, from.y, from.z,
               first_box.distance() * 0x1p-23)}};
}

}  // namespace oktett
