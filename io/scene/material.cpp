#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "io/scene/readers.h"
#include "io/scene/utf8.h"
#include "io/text/files.h"
#include "render/bsdf/metals.h"
#include "render/bsdf/principled_parameters.h"

namespace oktett {
namespace {

bool is_texture(const YamlNode* node) { return node != nullptr && node->kind == YamlKind::map; }

/// A number, or a texture that takes its place.
void read_textured(SceneLoad& load, const YamlNode* node, float& out, std::uint32_t& texture,
                   const Range& range) {
  if (!is_texture(node)) return load.values.read(node, out, range);
  out = 1;
  read_texture(load, node, texture);
}

/// A colour, or a texture that takes its place.
void read_textured(SceneLoad& load, const YamlNode* node, Color& out, std::uint32_t& texture) {
  if (!is_texture(node)) return load.values.read_color(node, out);
  out = {1, 1, 1};
  read_texture(load, node, texture);
}

/// A texture that multiplies a value which is no texture itself.
void read_map(SceneLoad& load, const YamlNode* node, std::uint32_t& texture) {
  if (node && texture != kNoId)
    throw Error(node->where(),
                "this texture multiplies a value that is a texture itself; expected one of them");
  read_texture(load, node, texture);
}

/// The complex index of refraction of a metal.
std::optional<Conductor> read_conductor(SceneLoad& load, const Fields& fields, const YamlNode& node,
                                        PrincipledMaterial& principled) {
  const YamlNode *metal_name = fields["metal"], *eta = fields["eta"], *k = fields["k"];
  if (metal_name && (eta || k)) throw Error(node.where(), "expected 'metal' or 'eta' and 'k', not both");
  if (metal_name) return load.values.choice<Conductor>(*metal_name, kMetals);
  if (!eta && !k) return std::nullopt;
  if (!eta || !k) throw Error(node.where(), "a metal's index of refraction needs both 'eta' and 'k'");
  Conductor metal;
  read_textured(load, eta, metal.eta, principled.eta_texture);
  read_textured(load, k, metal.k, principled.k_texture);
  if (!(std::min({metal.eta.x, metal.eta.y, metal.eta.z}) > 0))
    throw Error(eta->where(), "expected numbers greater than 0");
  return metal;
}

void read_principled(SceneLoad& load, const YamlNode& node, Material& m) {
  std::vector<const char*> keys{"base_color", "thin", "sheen_color", "metal", "eta", "k"};
  for (const PrincipledNumber& number : kPrincipledNumbers) keys.push_back(number.name);
  const Fields fields(node, "a principled material", keys);
  PrincipledMaterial principled;
  PrincipledParameters& p = principled.parameters;
  read_textured(load, fields["base_color"], m.color, m.color_texture);
  p.base_color = m.color;
  for (const PrincipledNumber& number : kPrincipledNumbers)
    read_textured(load, fields[number.name], p.*number.value, principled.*number.texture, number.range);
  read_textured(load, fields["sheen_color"], p.sheen_color, principled.sheen_color_texture);
  load.values.read(fields["thin"], p.thin);
  p.conductor = read_conductor(load, fields, node, principled);
  if (p.conductor) {
    if (!fields["metallic"]) p.metallic = 1;
    if (p.metallic == 0)
      load.warn(fields["metallic"]->where(), "without metal, its index of refraction has no effect");
    // What shows no indices of refraction shows this.
    if (!fields["base_color"]) p.base_color = m.color = head_on_color(*p.conductor);
  }
  m.principled = principled;
  resemble_principled(m);
}

/// The keys of Phong's model, and those of all materials.
constexpr const char* kPhongKeys[] = {"color",    "specular_color", "ambient",      "diffuse", "specular",
                                      "phong",    "reflection",     "transparency", "ior",     "roughness",
                                      "metallic", "map_color",      "map_specular"};
constexpr const char* kCommonKeys[] = {
    "principled",  "emits",    "emission",          "map_emission",         "opacity",
    "map_opacity", "map_bump", "map_normal",        "bump_scale",           "surface",
    "interior",    "priority", "attenuation_color", "attenuation_distance", "light_group"};

/// Throws Error if a principled material also has keys of Phong's model.
void refuse_phong_keys(const YamlNode& node) {
  for (const MapEntry& entry : map_entries(node, "a material"))
    if (std::ranges::find(kPhongKeys, entry.key->text) != std::end(kPhongKeys))
      throw Error(entry.key->where(), quote(entry.key->text) + " has no meaning beside 'principled'");
}

/// `roughness` and `metallic` beside Phong's parameters make a principled material of them.
void read_roughness(SceneLoad& load, const YamlNode* roughness, const YamlNode* metallic, Material& m) {
  if (!roughness && !metallic) return;
  PrincipledMaterial& principled = m.principled.emplace(principled_like(m));
  read_textured(load, roughness, principled.parameters.roughness, principled.roughness_texture,
                kUnitInterval);
  read_textured(load, metallic, principled.parameters.metallic, principled.metallic_texture, kUnitInterval);
}

/// Throws Error if the normals are those of a pattern.
void refuse_normal_pattern(const SceneLoad& load, const YamlNode* node, const Material& m) {
  if (m.normal_texture != kNoId && load.scene.textures[m.normal_texture].pattern)
    throw Error(
        node->where(),
        "a pattern holds no normals; expected an image, or 'map_bump', which takes a pattern as heights");
}

/// Warns of the keys that change nothing, given the others.
void warn_of_unused_keys(SceneLoad& load, const Fields& fields, const Material& m) {
  const bool dark = !glows(m);
  load.warn_if_unused(fields, "map_emission", dark, "'emission', which it multiplies, is black");
  load.warn_if_unused(fields, "emits", dark, "'emission' is black");
  load.warn_if_unused(fields, "light_group", dark, "'emission' is black");
  const bool shines = m.principled || m.specular > 0 || m.reflection > 0 || m.transparency > 0;
  load.warn_if_unused(fields, "map_specular", !shines, "'specular', 'reflection' and 'transparency' are 0");
  load.warn_if_unused(fields, "bump_scale", m.bump_texture == kNoId, "there is no 'map_bump'");
}

std::uint32_t append_material(SceneLoad& load, const YamlNode& node, const std::string& name) {
  std::vector<const char*> keys(std::begin(kPhongKeys), std::end(kPhongKeys));
  keys.insert(keys.end(), std::begin(kCommonKeys), std::end(kCommonKeys));
  const Fields fields(node, "a material", keys);
  SceneValues& values = load.values;
  Material m;
  m.name = name;
  read_textured(load, fields["color"], m.color, m.color_texture);
  read_textured(load, fields["specular_color"], m.specular_color, m.specular_texture);
  read_textured(load, fields["emission"], m.emission, m.emission_texture);
  for (const PhongNumber& number : kPhongNumbers)
    read_textured(load, fields[number.name], m.*number.value, m.*number.texture, number.range);
  read_textured(load, fields["ior"], m.ior, m.ior_texture, kPositive);
  read_textured(load, fields["opacity"], m.opacity, m.opacity_texture, kUnitInterval);
  read_roughness(load, fields["roughness"], fields["metallic"], m);
  if (const YamlNode* emits = fields["emits"])
    m.emits_behind = values.choice<bool>(*emits, {{"both", true}, {"front", false}});
  if (const YamlNode* group = fields["light_group"]) m.light_group = read_light_group(load, *group);
  read_map(load, fields["map_color"], m.color_texture);
  read_map(load, fields["map_specular"], m.specular_texture);
  read_map(load, fields["map_emission"], m.emission_texture);
  read_map(load, fields["map_opacity"], m.opacity_texture);
  read_texture(load, fields["map_bump"], m.bump_texture);
  read_texture(load, fields["map_normal"], m.normal_texture);
  refuse_normal_pattern(load, fields["map_normal"], m);
  values.read(fields["bump_scale"], m.bump_scale, kAnyNumber);
  if (const YamlNode* principled = fields["principled"]) {
    refuse_phong_keys(node);
    read_principled(load, *principled, m);
  }
  read_interior(load, fields, node, m);
  warn_of_unused_keys(load, fields, m);
  load.scene.material_places.resize(load.scene.materials.size());
  load.scene.material_places.push_back(node.where());
  load.scene.materials.push_back(std::move(m));
  return static_cast<std::uint32_t>(load.scene.materials.size() - 1);
}

}  // namespace

void define_materials(SceneLoad& load, const YamlNode& materials) {
  for (const auto& [key, value] : map_entries(materials, "materials")) {
    const auto index = static_cast<std::uint32_t>(load.scene.materials.size());
    attempt(*key, [&, k = key] { load.materials.add(k->text, index, k->where(), "material"); });
    attempt(*value, [&, k = key, v = value] { append_material(load, *v, k->text); });
    // The names of those that are wrong are known.
    load.scene.materials.resize(std::size_t{index} + 1);
    load.scene.material_places.resize(std::size_t{index} + 1);
  }
}

/// Whether a file defines one material after the other for other programs, and is often made by one: of such
/// a file one warning is enough.
static bool is_library(const std::string& file) {
  const std::string extension = lower_case_extension(file);
  return extension != ".yaml" && extension != ".yml";
}

void warn_of_energy(Scene& scene) {
  if (!traits(scene.integrator.kind).traces_paths) return;
  // What exceeds 1 by rounding is not meant.
  constexpr float kMost = 1.001f;
  std::map<std::string, std::pair<Warning, int>> of_libraries;  // with the number of other materials
  const std::size_t count = std::min(scene.materials.size(), scene.material_places.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Material& m = scene.materials[i];
    const Location& place = scene.material_places[i];
    if (m.principled || place.file.empty()) continue;
    const float albedo = greatest_albedo(m, scene.textures);
    if (!(albedo > kMost)) continue;
    const Warning warning{place,
                          fmt::format("this material may give back {:.3g} times the light that it receives, "
                                      "so paths grow brighter with each bounce",
                                      albedo)};
    if (!is_library(place.file))
      scene.warnings.push_back(warning);
    else if (const auto [found, is_new] = of_libraries.try_emplace(place.file, warning, 0); !is_new)
      ++found->second.second;
  }
  for (auto& [file, found] : of_libraries) {
    auto& [warning, others] = found;
    if (others > 0) warning.message += fmt::format("; so may {} more of this file", others);
    scene.warnings.push_back(std::move(warning));
  }
}

std::uint32_t read_material(SceneLoad& load, const YamlNode& node) {
  if (node.kind == YamlKind::map) return append_material(load, node, "");
  if (node.kind != YamlKind::scalar)
    throw Error(node.where(), "expected the name of a material or a map, found " + node.describe());
  const std::string name = load.values.text(node);
  if (const NameTable::Entry* material = load.materials.find(name)) return material->index;
  load.materials.fail_unknown(name, node.where(), "material");
}

}  // namespace oktett
