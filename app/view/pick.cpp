#include "app/view/pick.h"

#include <fmt/format.h>

#include "app/json.h"
#include "app/number_text.h"
#include "core/error.h"
#include "render/camera.h"

namespace oktett {
namespace {

struct NameOfShape {
  std::string operator()(const MeshShape&) const { return "mesh"; }
  std::string operator()(const InstanceShape&) const { return "instance"; }
  std::string operator()(const CsgShape&) const { return "combination"; }
  std::string operator()(const SpheresShape&) const { return "spheres"; }
  std::string operator()(const ExactShape& s) const {
    return std::visit(
        [](const auto& form) -> std::string {
          if constexpr (requires { form.kSurface.key; }) return form.kSurface.key;
          return "exact surface";
        },
        s.form);
  }
  template <class S>
  std::string operator()(const S&) const {
    return S::kSurface.key;
  }
};

/// An object, and its name; that of the combination around it if it has none.
struct FoundObject {
  const Object* object = nullptr;
  std::string name;
};

/// Object number `left` of those that World counts: combinations come before their operands, and those inside
/// of others do not count. If there are fewer, `left` becomes the rest.
FoundObject find_object(const std::vector<Object>& objects, const Object* whole, std::uint32_t& left) {
  for (const Object& object : objects) {
    const auto* combination = std::get_if<CsgShape>(&object.shape);
    if ((combination == nullptr || whole == nullptr) && left-- == 0)
      return {&object, object.name.empty() && whole != nullptr ? whole->name : object.name};
    if (combination == nullptr) continue;
    FoundObject inside = find_object(*combination->operands, whole != nullptr ? whole : &object, left);
    if (inside.object != nullptr) return inside;
  }
  return {};
}

/// The object that SurfaceInteraction::user numbers; see World.
FoundObject object_of(const Scene& scene, std::uint32_t user) {
  for (const Prototype& p : scene.prototypes)
    if (FoundObject found = find_object(p.objects, nullptr, user); found.object != nullptr) return found;
  return find_object(scene.objects, nullptr, user);
}

}  // namespace

std::string pick_json(const PreparedScene& prepared, const Camera& camera, const Film& film, std::uint32_t x,
                      std::uint32_t y, Isa isa) {
  const Scene& scene = prepared.scene();
  const World& world = prepared.world();
  const PixelWindow window = crop_window(film);
  if (x >= window.width() || y >= window.height()) throw Error("the pixel lies outside of the picture");
  const CameraFrame frame = camera_frame(camera, film);
  const Ray ray = camera_ray(frame, window.x0 + x + 0.5, window.y0 + y + 0.5);
  const Hit hit = closest_hit(*world.accel, ray, isa);
  const std::string head =
      fmt::format("{{\"x\": {}, \"y\": {}, \"origin\": {}, \"direction\": {}, \"hit\": {}", x, y,
                  list_text(ray.origin), list_text(ray.direction), hit.valid());
  if (!hit.valid()) return head + "}";
  const SurfaceInteraction s = surface_interaction(*world.accel, ray, hit);
  const Material& material = material_at(world, s);
  const FoundObject object = object_of(scene, s.user);
  const std::string shape = object.object != nullptr ? std::visit(NameOfShape{}, object.object->shape) : "";
  return head + fmt::format(
                    ", \"t\": {}, \"u\": {}, \"v\": {}, \"item\": {}, \"instance\": {}, \"point\": {}, "
                    "\"normal\": {}, "
                    "\"shading_normal\": {}, \"object\": {}, \"object_name\": {}, \"primitive\": {}, "
                    "\"surface\": {}, "
                    "\"material\": {}, \"depth\": {}}}",
                    number_text(hit.t), number_text(hit.u), number_text(hit.v), hit.item, hit.instance,
                    list_text(s.position), list_text(s.geometric_normal), list_text(s.shading_normal), s.user,
                    JsonValue(object.name).text, s.primitive, JsonValue(shape).text,
                    JsonValue(material.name).text, camera_depth(frame, s.position));
}

}  // namespace oktett
