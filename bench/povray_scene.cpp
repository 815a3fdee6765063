#include "bench/povray_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/random.h"

namespace oktett::bench {

namespace {

constexpr double kEdge = 24;        // of the field
constexpr double kHorizontal = 50;  // degrees of view
const Vec3d kEye{0, 14, -22}, kTarget{0, 0, -2}, kLight{-20, 40, -20};

/// Gives all operands of a combination the material of the whole.
void set_material(Object& object, std::uint32_t material) {
  object.material = material;
  auto* csg = std::get_if<CsgShape>(&object.shape);
  if (csg == nullptr) return;
  std::vector<Object> operands = *csg->operands;
  for (Object& operand : operands) set_material(operand, material);
  csg->operands = std::make_shared<const std::vector<Object>>(std::move(operands));
}

}  // namespace

std::string field_head(bool ids) {
  const auto v = [](const Vec3d& p) { return fmt::format("<{}, {}, {}>", p.x, p.y, p.z); };
  return fmt::format(
      "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level 5 }}\n"
      "camera {{ location {} right x*image_width/image_height angle {} look_at {} }}\n{}"
      "background {{ rgb {} }}\n#default {{ finish {{ {} }} }}\n",
      v(kEye), kHorizontal, v(kTarget), ids ? "" : fmt::format("light_source {{ {} rgb 1 }}\n", v(kLight)),
      ids ? 0 : 0.1, ids ? "ambient 1 diffuse 0" : "ambient 0.1 diffuse 0.7 phong 0.3 phong_size 40");
}

/// Object `id` in a colour that encodes the number; 0 is the background.
std::string id_color(std::uint32_t id) {
  return fmt::format("rgb <{}/255, {}/255, {}/255>", id & 255, id >> 8 & 255, id >> 16);
}

Material field_material(const Color& color) {
  Material m;
  m.color = color;
  m.ambient = 0.1f, m.diffuse = 0.7f, m.specular = 0.3f, m.phong = 40;
  return m;
}

Scene empty_field(std::uint32_t width, std::uint32_t height) {
  Scene scene;
  scene.camera.from = kEye, scene.camera.at = kTarget, scene.camera_given = true;
  const double half = std::tan(kHorizontal * std::numbers::pi / 360) * height / width;
  scene.camera.fov = std::atan(half) * 360 / std::numbers::pi;
  scene.film.width = width, scene.film.height = height;
  scene.integrator.samples = 1, scene.integrator.depth = 5;
  scene.background = {0.1f, 0.1f, 0.1f};
  scene.lights = {PointLight{kLight}};
  scene.lights_given = true;
  return scene;
}

Field make_field(const FieldKind& kind, std::uint32_t width, std::uint32_t height) {
  Field field{empty_field(width, height), field_head(false), field_head(true), {}, {}, {}};
  const int side = static_cast<int>(std::lround(std::sqrt(kind.count)));
  const double pitch = kEdge / side, size = pitch * 0.45;
  std::uint32_t dimension = 0;
  const auto random = [&] {
    // Four decimals, so that both programs read the same numbers.
    return std::floor(random_float(7, 0, dimension++) * 1e4) / 1e4;
  };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      double r[6];
      for (double& x : r) x = random();
      FieldObject object = kind.make(r);
      const auto id = static_cast<std::uint32_t>(field.objects.size());
      const Color color{static_cast<float>(0.3 + 0.7 * r[0]), static_cast<float>(0.3 + 0.7 * r[1]),
                        static_cast<float>(0.3 + 0.7 * r[2])};
      const Vec3d turn{360 * r[3], 360 * r[4], 360 * r[5]};
      const Vec3d place{(i - side / 2.0 + 0.5) * pitch, size * 1.2, (j - side / 2.0 + 0.5) * pitch};
      const auto text = [&](const std::string& pigment) {
        return fmt::format(
            "object {{ {} pigment {{ {} }} rotate <{}, {}, {}> scale {} translate <{}, {}, {}> }}\n",
            object.pov, pigment, turn.x, turn.y, turn.z, size, place.x, place.y, place.z);
      };
      field.pov += text(fmt::format("rgb <{}, {}, {}>", color.x, color.y, color.z));
      field.pov_ids += text(id_color(id + 1));
      Object& o = field.scene.objects.emplace_back();
      o.shape = object.shape;
      set_material(o, static_cast<std::uint32_t>(field.scene.materials.size()));
      o.transform = Affine::translation(place) * Affine::scaling({size, size, size}) * Affine::rotation(turn);
      field.scene.materials.push_back(field_material(color));
      field.objects.push_back(std::move(object));
    }
  field.pov += "plane { y, 0 pigment { rgb <.6, .6, .65> } }\n";
  field.pov_ids +=
      "plane { y, 0 pigment { " + id_color(static_cast<std::uint32_t>(field.objects.size()) + 1) + " } }\n";
  Object& floor = field.scene.objects.emplace_back();
  floor.shape = PlaneShape{};
  floor.material = static_cast<std::uint32_t>(field.scene.materials.size());
  field.scene.materials.push_back(field_material({0.6f, 0.6f, 0.65f}));
  return field;
}

}  // namespace oktett::bench
