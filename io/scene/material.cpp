#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "core/math.h"
#include "io/mesh/reading.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"
#include "render/bsdf/metals.h"
#include "render/bsdf/principled_parameters.h"
#include "render/solids.h"

namespace oktett {
namespace {

constexpr std::uint32_t kMostPriority = 1'000'000;

/// A map of the principled model. Its colour is that of the material.
struct PrincipledKeys {
  Material& m;
  PrincipledMaterial principled{};
  Conductor named{}, measured{};

  static constexpr const char* kMap = "a principled material";
  void describe(auto& p) {
    PrincipledParameters& values = principled.parameters;
    p.field("base_color", Textured<Color>{m.color, m.color_texture},
            "of metal head-on, of diffuse light, and of light that passes glass");
    p.field("thin", values.thin, "glass is thin walls, which do not bend light");
    for (const PrincipledColor& color : kPrincipledColors)
      p.field(color.name, Textured<Color>{values.*color.value, principled.*color.texture}, color.meaning);
    p.optional("metal", ChoiceOf<Conductor>{named, kMetals}, "instead of `eta` and `k`: those of this metal");
    p.optional("eta", Textured<Color>{measured.eta, principled.eta_texture},
               "index of refraction of the metal");
    p.optional("k", Textured<Color>{measured.k, principled.k_texture}, "how the metal absorbs");
    for (const PrincipledNumber& number : kPrincipledNumbers)
      p.field(number.name, Textured<float>{values.*number.value, principled.*number.texture}, number.range,
              number.meaning);
    p.field("anisotropy_rotation", principled.anisotropy_rotation, kAngle,
            "of the direction along which facets are wider, from that of u towards v");
    p.optional("map_anisotropy", TextureMap{principled.anisotropy_direction_texture},
               "an image whose red and green are that direction");
    p.optional("map_coat_normal", TextureMap{principled.coat_normal_texture},
               "an image of tangent-space normals of the coat");
    p.field("coat_normal_scale", principled.coat_normal_scale, "multiplies the tilt of `map_coat_normal`");
    p.field("even_coat", principled.even_coat, "`map_bump` and `map_normal` do not bend the coat");
    p.not_both("map_coat_normal", "even_coat", "expected 'map_coat_normal' or 'even_coat', not both");
    for (const char* key : {"eta", "k"})
      p.not_both("metal", key, "expected 'metal' or 'eta' and 'k', not both");
  }
};

/// The complex index of refraction of the metal, if it is given.
std::optional<Conductor> conductor_of(const Fields& fields, const YamlNode& node,
                                      const PrincipledKeys& keys) {
  const YamlNode *eta = fields["eta"], *k = fields["k"];
  if (fields["metal"]) return keys.named;
  if (!eta && !k) return std::nullopt;
  if (!eta || !k) throw Error(node.where(), "a metal's index of refraction needs both 'eta' and 'k'");
  if (!(std::min({keys.measured.eta.x, keys.measured.eta.y, keys.measured.eta.z}) > 0))
    throw Error(eta->where(), "expected numbers greater than 0");
  return keys.measured;
}

/// Throws Error if the normals are those of a pattern or an attribute.
void refuse_normal_pattern(const SceneLoad& load, const YamlNode* node, std::uint32_t texture) {
  if (texture == kNoId) return;
  const Texture& t = load.scene.textures[texture];
  if (!t.pattern && t.attribute.empty()) return;
  const std::string what = t.pattern ? "a pattern" : "an attribute";
  throw Error(node->where(), what + " holds no normals; expected an image, or 'map_bump', which takes " +
                                 what + " as heights");
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, PrincipledKeys& keys) {
  const Fields fields = read_described(load, node, keys.kMap, keys);
  Material& m = keys.m;
  PrincipledParameters& p = keys.principled.parameters;
  p.base_color = m.color;
  p.conductor = conductor_of(fields, node, keys);
  if (p.conductor) {
    if (!fields["metallic"]) p.metallic = 1;
    if (p.metallic == 0)
      load.warn(fields["metallic"]->where(), "without metal, its index of refraction has no effect");
    // What shows no indices of refraction shows this.
    if (!fields["base_color"]) p.base_color = m.color = head_on_color(*p.conductor);
  }
  const PrincipledMaterial& made = keys.principled;
  refuse_normal_pattern(load, fields["map_coat_normal"], made.coat_normal_texture);
  load.warn_if_unused(fields, "coat_normal_scale", made.coat_normal_texture == kNoId,
                      "there is no 'map_coat_normal'");
  refuse_normal_pattern(load, fields["map_anisotropy"], made.anisotropy_direction_texture);
  for (const char* key : {"map_anisotropy", "anisotropy_rotation"})
    load.warn_if_unused(fields, key, made.parameters.anisotropy == 0, "'anisotropy' is 0");
  for (const char* key : {"iridescence_ior", "iridescence_thickness"})
    load.warn_if_unused(fields, key, made.parameters.iridescence == 0, "'iridescence' is 0");
  load.warn_if_unused(fields, "dispersion", made.parameters.transmission == 0 || made.parameters.thin,
                      "only glass that is no thin wall bends light");
  m.principled = made;
  resemble_principled(m);
}

/// Material::reflection_falloff: a number greater than 0, or `fresnel`.
struct ReflectionFalloff {
  float& power;
};
constexpr Range kFalloffs{0, 1000, true};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, ReflectionFalloff& falloff) {
  falloff.power = 0;
  if (load.values.text(node) != "fresnel") falloff.power = load.values.single(node, kFalloffs);
}

std::string schema_of(Schema&, const Range&, const ReflectionFalloff&) {
  return Schema::any_of({Schema::words({"fresnel"}), Schema::number(kFalloffs)});
}

/// The keys of Phong's model.
struct PhongKeys {
  Material& m;
  PrincipledMaterial rough{};  ///< with `roughness` and `metallic`
  Color filter{1, 1, 1};
  std::uint32_t filter_texture = kNoId;
  Color reflection_color{1, 1, 1};
  std::uint32_t reflection_color_texture = kNoId;

  void describe(auto& p) {
    p.field("color", Textured<Color>{m.color, m.color_texture}, "of diffuse and ambient light");
    p.optional("filter", Textured<Color>{filter, filter_texture},
               "colour of light that passes through; `color` if left out");
    p.field("specular_color", Textured<Color>{m.specular_color, m.specular_texture},
            "of highlights and mirror reflections");
    p.optional("reflection_color", Textured<Color>{reflection_color, reflection_color_texture},
               "of mirror reflections; `specular_color` if left out");
    for (const PhongNumber& number : kPhongNumbers)
      p.field(number.name, Textured<float>{m.*number.value, m.*number.texture}, number.range, number.meaning);
    p.field("ior", Textured<float>{m.ior, m.ior_texture}, kPositive,
            "index of refraction inside relative to outside");
    p.optional("reflection_falloff", ReflectionFalloff{m.reflection_falloff},
               "power of 1 - cosine by which reflection grows to that at grazing angles; or `fresnel`");
    p.field("fresnel", m.fresnel, "`whitted`: light that passes is less what Fresnel's equations mirror");
    p.field("conserve_energy", m.conserve_energy, "`whitted`: light that passes is less what is mirrored");
    p.field("specular_fades", m.specular_fades,
            "`whitted`: highlights turn white towards grazing angles, as those of metals do");
    p.field("reflection_fades", m.reflection_fades, "`whitted`: so does the colour of mirrored light");
    p.optional("roughness", Textured<float>{rough.parameters.roughness, rough.roughness_texture},
               kUnitInterval, "makes `path` use a principled material of this colour");
    p.optional("metallic", Textured<float>{rough.parameters.metallic, rough.metallic_texture}, kUnitInterval,
               "likewise");
    p.optional("map_color", TextureMap{m.color_texture, true}, "multiplies `color`");
    p.optional("map_specular", TextureMap{m.specular_texture, true}, "multiplies `specular_color`");
  }
};

/// The index into Scene::materials by the name of one that is known already.
struct MaterialName {
  std::uint32_t& index;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, MaterialName& material) {
  if (node.kind != YamlKind::scalar)
    throw Error(node.where(), "expected the name of a material, found " + node.describe());
  const std::string name = load.values.text(node);
  const NameTable::Entry* const entry = load.materials.find(name);
  if (entry == nullptr) load.materials.fail_unknown(name, node.where(), "material");
  if (entry->index >= load.scene.materials.size())
    throw Error(node.where(), "material " + quote(name) + " must stand before what it is the back of");
  if (load.scene.materials[entry->index].back != kNoId)
    throw Error(node.where(), "material " + quote(name) + " has a back itself");
  material.index = entry->index;
}

std::string schema_of(Schema&, const Range&, const MaterialName&) { return Schema::text(); }

/// The keys of all materials.
struct CommonKeys {
  Material& m;
  std::uint32_t priority = 0;
  MaterialName back{m.back};
  Color attenuation{1, 1, 1};
  double distance = 1;

  void describe(auto& p) {
    p.optional("principled", PrincipledKeys{m}, "instead of the keys of Phong's model");
    p.choice("emits", m.emits_behind, {{"both", true}, {"front", false}}, "which sides glow");
    p.field("emission", Textured<Color>{m.emission, m.emission_texture}, "radiance given off");
    p.optional("map_emission", TextureMap{m.emission_texture, true}, "multiplies `emission`");
    p.field("opacity", Textured<float>{m.opacity, m.opacity_texture}, kUnitInterval,
            "the part of the surface that is there");
    p.optional("map_opacity", TextureMap{m.opacity_texture, true}, "multiplies `opacity`");
    p.optional("map_bump", TextureMap{m.bump_texture}, "heights");
    p.optional("map_normal", TextureMap{m.normal_texture}, "an image of tangent-space normals");
    p.field("normal_scale", m.normal_scale, "multiplies the tilt of `map_normal`");
    p.field("bump_scale", m.bump_scale, "multiplies the heights of `map_bump`");
    p.field("surface", m.surface, "false: an invisible boundary of the interior");
    p.optional("interior", MediumName{m.interior}, "the medium in solids of this material");
    p.optional("back", back, "name of a material further up: what the other side shows");
    p.optional("priority", priority, whole(0, kMostPriority),
               "where solids overlap, the highest fills the space");
    p.optional("attenuation_color", attenuation, "instead of `interior`: what is left of white light");
    p.optional("attenuation_distance", distance, kPositiveLength, "after this distance");
    p.optional("light_group", LightGroupName{m.light_group}, "layer for the light of `emission`");
    for (const char* key : {"attenuation_color", "attenuation_distance"})
      p.not_both("interior", key, "a material has either an 'interior' or an attenuation", key);
  }
};

struct MaterialKeys {
  PhongKeys phong;
  CommonKeys common;

  static constexpr const char* kMap = "a material";
  void describe(auto& p) {
    phong.describe(p);
    common.describe(p);
  }
};

/// Throws Error if a principled material also has keys of Phong's model.
void refuse_phong_keys(const YamlNode& node, const PhongKeys& phong) {
  const KeyList list(phong);
  for (const MapEntry& entry : map_entries(node, MaterialKeys::kMap))
    if (std::ranges::find(list.keys, entry.key->text) != list.keys.end())
      throw Error(entry.key->where(), quote(entry.key->text) + " has no meaning beside 'principled'");
}

/// Throws Error if a material without a surface has keys that describe one.
void refuse_surface_keys(const YamlNode& node) {
  constexpr const char* kAllowed[] = {"surface", "interior", "priority"};
  for (const MapEntry& entry : map_entries(node, MaterialKeys::kMap))
    if (std::ranges::find(kAllowed, entry.key->text) == std::end(kAllowed))
      throw Error(entry.key->where(), quote(entry.key->text) + " has no meaning beside 'surface: false'");
}

/// `roughness` and `metallic` beside Phong's parameters make a principled material of them.
void finish_roughness(const Fields& fields, const PrincipledMaterial& rough, Material& m) {
  if (!fields["roughness"] && !fields["metallic"]) return;
  PrincipledMaterial& principled = m.principled.emplace(principled_like(m));
  if (fields["roughness"]) {
    principled.parameters.roughness = rough.parameters.roughness;
    principled.roughness_texture = rough.roughness_texture;
  }
  principled.parameters.metallic = rough.parameters.metallic;
  principled.metallic_texture = rough.metallic_texture;
}

/// The medium that leaves `attenuation_color` of white light after `attenuation_distance`, as in glTF.
std::uint32_t add_attenuation(SceneLoad& load, const Fields& fields, const CommonKeys& keys) {
  const YamlNode *color = fields["attenuation_color"], *distance = fields["attenuation_distance"];
  if (!color || !distance)
    throw Error((color ? color : distance)->where(),
                "expected both 'attenuation_color' and 'attenuation_distance'");
  Medium medium;
  for (int c = 0; c < 3; ++c) {
    const float left = keys.attenuation[c];
    if (!(left > 0 && left <= 1))
      throw Error(color->where(), "expected numbers greater than 0 and at most 1");
    medium.absorption[c] = std::min(
        kMostCoefficient, static_cast<float>(-portable::log(static_cast<double>(left)) / keys.distance));
  }
  load.scene.media.push_back(medium);
  return static_cast<std::uint32_t>(load.scene.media.size() - 1);
}

/// What is inside of solids of the material.
void finish_interior(SceneLoad& load, const Fields& fields, const YamlNode& node, const CommonKeys& keys) {
  Material& m = keys.m;
  if (!m.surface) {
    refuse_surface_keys(node);
    m.ambient = m.diffuse = 0;
    m.transparency = 1;
    m.ior = 1;
    m.color = {1, 1, 1};
  }
  const YamlNode *interior = fields["interior"], *priority = fields["priority"];
  const YamlNode* color = fields["attenuation_color"];
  if (color || fields["attenuation_distance"]) m.interior = add_attenuation(load, fields, keys);
  if (priority) m.priority = static_cast<std::int32_t>(keys.priority);
  const YamlNode* given = interior ? interior : color ? color : priority;
  if (given && m.transparency == 0)
    throw Error(given->where(),
                "no light enters this material; expected 'transparency', 'transmission' or 'surface: false' "
                "beside what is inside");
  if (given && m.principled && m.principled->parameters.thin)
    throw Error(given->where(), "thin glass has no inside");
}

/// Warns of the keys that change nothing, given the others.
void warn_of_unused_keys(SceneLoad& load, const Fields& fields, const Material& m) {
  const bool dark = !glows(m);
  load.warn_if_unused(fields, "map_emission", dark, "'emission', which it multiplies, is black");
  load.warn_if_unused(fields, "emits", dark, "'emission' is black");
  load.warn_if_unused(fields, "light_group", dark, "'emission' is black");
  const bool mirrors = m.reflection > 0 || m.reflection_varies;
  const bool shines = m.principled || m.specular > 0 || m.specular_blinn > 0 || mirrors || m.transparency > 0;
  load.warn_if_unused(fields, "reflection_falloff", !m.reflection_varies, "there is no 'reflection_grazing'");
  load.warn_if_unused(fields, "reflection_color", !mirrors, "'reflection' is 0");
  load.warn_if_unused(fields, "blinn", m.specular_blinn == 0, "'specular_blinn' is 0");
  load.warn_if_unused(fields, "film_thickness", m.film == 0, "'film' is 0");
  load.warn_if_unused(fields, "reflection_fades", !mirrors, "'reflection' is 0");
  load.warn_if_unused(fields, "map_specular", !shines, "'specular', 'reflection' and 'transparency' are 0");
  load.warn_if_unused(fields, "normal_scale", m.normal_texture == kNoId, "there is no 'map_normal'");
  load.warn_if_unused(fields, "bump_scale", m.bump_texture == kNoId, "there is no 'map_bump'");
}

std::uint32_t append_material(SceneLoad& load, const YamlNode& node, const std::string& name) {
  Material m;
  m.name = name;
  MaterialKeys keys{{m}, {m}};
  const Fields fields = read_described(load, node, keys.kMap, keys);
  if (fields["filter"]) m.filter = keys.phong.filter, m.filter_texture = keys.phong.filter_texture;
  if (fields["reflection_color"])
    m.reflection_color = keys.phong.reflection_color,
    m.reflection_color_texture = keys.phong.reflection_color_texture;
  m.reflection_varies = fields["reflection_grazing"] != nullptr;
  finish_roughness(fields, keys.phong.rough, m);
  refuse_normal_pattern(load, fields["map_normal"], m.normal_texture);
  if (fields["principled"]) refuse_phong_keys(node, keys.phong);
  finish_interior(load, fields, node, keys.common);
  warn_of_unused_keys(load, fields, m);
  load.scene.material_places.resize(load.scene.materials.size());
  load.scene.material_places.push_back(node.where());
  load.scene.materials.push_back(std::move(m));
  return static_cast<std::uint32_t>(load.scene.materials.size() - 1);
}

std::string material_map_schema(Schema& schema) {
  Material usual;
  return schema.map(MaterialKeys::kMap, MaterialKeys{{usual}, {usual}});
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

std::string materials_schema(Schema& schema) { return Schema::entries(material_map_schema(schema)); }

std::string material_schema(Schema& schema) {
  return Schema::any_of({Schema::text(), material_map_schema(schema)});
}

void warn_of_energy(Scene& scene) {
  if (!traits(scene.integrator.kind).traces_paths) return;
  // What exceeds 1 by rounding is not meant.
  constexpr float kMost = 1.001f;
  const std::size_t count = std::min(scene.materials.size(), scene.material_places.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Material& m = scene.materials[i];
    const Location& place = scene.material_places[i];
    if (m.principled || place.file.empty()) continue;
    const float albedo = greatest_albedo(m, scene.textures);
    if (!(albedo > kMost)) continue;
    scene.warnings.push_back({place, fmt::format("this material may give back {:.3g} times the light that it "
                                                 "receives, so paths grow brighter with each bounce",
                                                 albedo)});
  }
}

void warn_of_insides(Scene& scene) {
  const auto warn_of = [&](const Object& object) {
    const auto* const shape = std::get_if<MeshShape>(&object.shape);
    if (shape == nullptr || object.material != kNoId) return;
    const auto attenuates = [&](std::uint32_t m) {
      return m < scene.materials.size() && scene.materials[m].interior != kNoId;
    };
    const auto found = std::ranges::find_if(shape->slot_materials, attenuates);
    if (found == shape->slot_materials.end() || has_inside(object, scene)) return;
    scene.warnings.push_back(
        {object.where, "material " + quote_name(scene.materials[*found].name) +
                           " attenuates light, but object " + quote_name(object.name) +
                           " is not closed where light enters it; nothing is attenuated"});
  };
  for (const Prototype& prototype : scene.prototypes) std::ranges::for_each(prototype.objects, warn_of);
  std::ranges::for_each(scene.objects, warn_of);
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
