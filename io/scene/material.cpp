#include <utility>

#include "io/scene/readers.h"
#include "io/scene/utf8.h"

namespace oktett {
namespace {

/// One number for all axes, [u, v], or [u, v, w].
void read_layout(SceneValues& values, const YamlNode* node, Vec3f& out, bool single_number) {
  if (!node) return;
  double v[3] = {out.x, out.y, out.z};
  if (single_number && node->kind == YamlKind::scalar)
    v[0] = v[1] = v[2] = values.number(*node);
  else
    values.numbers(*node, {v, node->kind == YamlKind::sequence && node->items.size() == 3 ? 3u : 2u});
  out = static_cast<Vec3f>(Vec3d{v[0], v[1], v[2]});
}

/// A file, or a map with the file and how it lies on the surface.
void read_texture(SceneLoad& load, const YamlNode* node, std::uint32_t& out) {
  if (!node) return;
  SceneValues& values = load.values;
  Texture texture;
  if (node->kind != YamlKind::map) {
    texture.path = values.existing_file(*node);
  } else {
    const Fields fields(*node, "a texture", {"file", "scale", "offset", "clamp", "gain", "base"});
    texture.path = values.existing_file(fields.require("file"));
    read_layout(values, fields["scale"], texture.scale, true);
    read_layout(values, fields["offset"], texture.offset, false);
    values.read(fields["clamp"], texture.clamp);
    values.read(fields["gain"], texture.gain, kAnyNumber);
    values.read(fields["base"], texture.base, kAnyNumber);
  }
  out = load.textures.add(texture);
}

std::uint32_t append_material(SceneLoad& load, const YamlNode& node, const std::string& name) {
  const Fields fields(
      node, "a material",
      {"color", "specular_color", "emission", "ambient", "diffuse", "specular", "phong", "reflection",
       "transparency", "ior", "roughness", "metallic", "map_color", "map_specular", "map_emission",
       "map_opacity", "map_bump", "map_normal", "bump_scale"});
  SceneValues& values = load.values;
  Material m;
  m.name = name;
  values.read_color(fields["color"], m.color);
  values.read_color(fields["specular_color"], m.specular_color);
  values.read_color(fields["emission"], m.emission);
  values.read(fields["ambient"], m.ambient, kNonNegative);
  values.read(fields["diffuse"], m.diffuse, kNonNegative);
  values.read(fields["specular"], m.specular, kNonNegative);
  values.read(fields["phong"], m.phong, kNonNegative);
  values.read(fields["reflection"], m.reflection, kUnitInterval);
  values.read(fields["transparency"], m.transparency, kUnitInterval);
  values.read(fields["ior"], m.ior, kPositive);
  values.read(fields["roughness"], m.roughness, kUnitInterval);
  values.read(fields["metallic"], m.metallic, kUnitInterval);
  read_texture(load, fields["map_color"], m.color_texture);
  read_texture(load, fields["map_specular"], m.specular_texture);
  read_texture(load, fields["map_emission"], m.emission_texture);
  read_texture(load, fields["map_opacity"], m.opacity_texture);
  read_texture(load, fields["map_bump"], m.bump_texture);
  read_texture(load, fields["map_normal"], m.normal_texture);
  values.read(fields["bump_scale"], m.bump_scale, kAnyNumber);
  load.scene.materials.push_back(std::move(m));
  return static_cast<std::uint32_t>(load.scene.materials.size() - 1);
}

}  // namespace

void define_materials(SceneLoad& load, const YamlNode& materials) {
  for (const auto& [key, value] : map_entries(materials, "materials")) {
    const auto index = static_cast<std::uint32_t>(load.scene.materials.size());
    load.materials.add(key->text, index, key->where(), "material");
    append_material(load, *value, key->text);
  }
}

std::uint32_t read_material(SceneLoad& load, const YamlNode& node) {
  if (node.kind == YamlKind::map) return append_material(load, node, "");
  if (node.kind != YamlKind::scalar)
    throw Error(node.where(), "expected the name of a material or a map, found " + node.describe());
  const std::string name = load.values.text(node);
  if (const NameTable::Entry* material = load.materials.find(name)) return material->index;
  throw Error(node.where(), "unknown material " + quote(name) + load.materials.suggestion(name));
}

}  // namespace oktett
