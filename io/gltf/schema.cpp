#include "io/gltf/schema.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/mesh/reading.h"

namespace oktett {
namespace {

using nlohmann::json;

enum class GltfType : std::uint8_t {
  text,
  flag,
  number,
  whole,
  numbers,
  wholes,
  texts,
  whole_map,
  object,
  objects
};
enum class Need : std::uint8_t { optional, required };

/// A property: the object that has it, its name, its type. `of`: what objects it holds; `size`: how many
/// numbers.
struct GltfProperty {
  std::string_view owner, key;
  GltfType type;
  std::string_view of = {};
  std::uint32_t size = 0;
  Need need = Need::optional;
};

constexpr GltfType kText = GltfType::text, kFlag = GltfType::flag, kNumber = GltfType::number,
                   kWhole = GltfType::whole, kNumbers = GltfType::numbers, kWholes = GltfType::wholes,
                   kTexts = GltfType::texts, kWholeMap = GltfType::whole_map, kObject = GltfType::object,
                   kObjects = GltfType::objects;
constexpr Need kNeeded = Need::required;

// An owner that ends in + is the `extensions` of that object.
constexpr GltfProperty kGltfSchema[] = {
    {"file", "asset", kObject, "asset", 0, kNeeded},
    {"file", "scene", kWhole},
    {"file", "extensionsUsed", kTexts},
    {"file", "extensionsRequired", kTexts},
    {"file", "accessors", kObjects, "accessor"},
    {"file", "animations", kObjects, "animation"},
    {"file", "buffers", kObjects, "buffer"},
    {"file", "bufferViews", kObjects, "view"},
    {"file", "cameras", kObjects, "camera"},
    {"file", "images", kObjects, "image"},
    {"file", "materials", kObjects, "material"},
    {"file", "meshes", kObjects, "mesh"},
    {"file", "nodes", kObjects, "node"},
    {"file", "samplers", kObjects, "sampler"},
    {"file", "scenes", kObjects, "scene"},
    {"file", "skins", kObjects, "skin"},
    {"file", "textures", kObjects, "texture"},
    {"file+", "KHR_lights_punctual", kObject, "lights"},
    {"file+", "KHR_materials_variants", kObject, "variants"},
    {"asset", "version", kText},
    {"asset", "minVersion", kText},
    {"asset", "generator", kText},
    {"asset", "copyright", kText},
    {"accessor", "bufferView", kWhole},
    {"accessor", "byteOffset", kWhole},
    {"accessor", "componentType", kWhole, {}, 0, kNeeded},
    {"accessor", "count", kWhole, {}, 0, kNeeded},
    {"accessor", "type", kText, {}, 0, kNeeded},
    {"accessor", "normalized", kFlag},
    {"accessor", "min", kNumbers},
    {"accessor", "max", kNumbers},
    {"accessor", "name", kText},
    {"accessor", "sparse", kObject, "sparse"},
    {"sparse", "count", kWhole, {}, 0, kNeeded},
    {"sparse", "indices", kObject, "sparse indices", 0, kNeeded},
    {"sparse", "values", kObject, "sparse values", 0, kNeeded},
    {"sparse indices", "bufferView", kWhole, {}, 0, kNeeded},
    {"sparse indices", "byteOffset", kWhole},
    {"sparse indices", "componentType", kWhole, {}, 0, kNeeded},
    {"sparse values", "bufferView", kWhole, {}, 0, kNeeded},
    {"sparse values", "byteOffset", kWhole},
    {"animation", "name", kText},
    {"animation", "channels", kObjects, "channel", 0, kNeeded},
    {"animation", "samplers", kObjects, "animation sampler", 0, kNeeded},
    {"channel", "sampler", kWhole, {}, 0, kNeeded},
    {"channel", "target", kObject, "target", 0, kNeeded},
    {"target", "node", kWhole},
    {"target", "path", kText, {}, 0, kNeeded},
    {"animation sampler", "input", kWhole, {}, 0, kNeeded},
    {"animation sampler", "output", kWhole, {}, 0, kNeeded},
    {"animation sampler", "interpolation", kText},
    {"buffer", "uri", kText},
    {"buffer", "byteLength", kWhole, {}, 0, kNeeded},
    {"buffer", "name", kText},
    {"view", "buffer", kWhole, {}, 0, kNeeded},
    {"view", "byteOffset", kWhole},
    {"view", "byteLength", kWhole, {}, 0, kNeeded},
    {"view", "byteStride", kWhole},
    {"view", "target", kWhole},
    {"view", "name", kText},
    {"view+", "EXT_meshopt_compression", kObject, "packing"},
    {"packing", "buffer", kWhole},
    {"packing", "byteOffset", kWhole},
    {"packing", "byteLength", kWhole},
    {"packing", "byteStride", kWhole},
    {"packing", "count", kWhole},
    {"packing", "mode", kText},
    {"packing", "filter", kText},
    {"camera", "type", kText, {}, 0, kNeeded},
    {"camera", "name", kText},
    {"camera", "perspective", kObject, "perspective"},
    {"camera", "orthographic", kObject, "orthographic"},
    {"perspective", "aspectRatio", kNumber},
    {"perspective", "yfov", kNumber, {}, 0, kNeeded},
    {"perspective", "znear", kNumber, {}, 0, kNeeded},
    {"perspective", "zfar", kNumber},
    {"orthographic", "xmag", kNumber, {}, 0, kNeeded},
    {"orthographic", "ymag", kNumber, {}, 0, kNeeded},
    {"orthographic", "znear", kNumber, {}, 0, kNeeded},
    {"orthographic", "zfar", kNumber, {}, 0, kNeeded},
    {"image", "uri", kText},
    {"image", "mimeType", kText},
    {"image", "bufferView", kWhole},
    {"image", "name", kText},
    {"material", "name", kText},
    {"material", "pbrMetallicRoughness", kObject, "pbr"},
    {"material", "normalTexture", kObject, "normal texture"},
    {"material", "occlusionTexture", kObject, "occlusion texture"},
    {"material", "emissiveTexture", kObject, "texture use"},
    {"material", "emissiveFactor", kNumbers, {}, 3},
    {"material", "alphaMode", kText},
    {"material", "alphaCutoff", kNumber},
    {"material", "doubleSided", kFlag},
    {"pbr", "baseColorFactor", kNumbers, {}, 4},
    {"pbr", "baseColorTexture", kObject, "texture use"},
    {"pbr", "metallicFactor", kNumber},
    {"pbr", "roughnessFactor", kNumber},
    {"pbr", "metallicRoughnessTexture", kObject, "texture use"},
    {"texture use", "index", kWhole, {}, 0, kNeeded},
    {"texture use", "texCoord", kWhole},
    {"texture use+", "KHR_texture_transform", kObject, "transform"},
    {"normal texture", "index", kWhole, {}, 0, kNeeded},
    {"normal texture", "texCoord", kWhole},
    {"normal texture", "scale", kNumber},
    {"normal texture+", "KHR_texture_transform", kObject, "transform"},
    {"occlusion texture", "index", kWhole, {}, 0, kNeeded},
    {"occlusion texture", "texCoord", kWhole},
    {"occlusion texture", "strength", kNumber},
    {"occlusion texture+", "KHR_texture_transform", kObject, "transform"},
    {"transform", "offset", kNumbers, {}, 2},
    {"transform", "rotation", kNumber},
    {"transform", "scale", kNumbers, {}, 2},
    {"transform", "texCoord", kWhole},
    {"material+", "KHR_materials_anisotropy", kObject, "anisotropy"},
    {"anisotropy", "anisotropyStrength", kNumber},
    {"anisotropy", "anisotropyRotation", kNumber},
    {"anisotropy", "anisotropyTexture", kObject, "texture use"},
    {"material+", "KHR_materials_clearcoat", kObject, "coat"},
    {"coat", "clearcoatFactor", kNumber},
    {"coat", "clearcoatTexture", kObject, "texture use"},
    {"coat", "clearcoatRoughnessFactor", kNumber},
    {"coat", "clearcoatRoughnessTexture", kObject, "texture use"},
    {"coat", "clearcoatNormalTexture", kObject, "normal texture"},
    {"material+", "KHR_materials_dispersion", kObject, "dispersion"},
    {"dispersion", "dispersion", kNumber},
    {"material+", "KHR_materials_emissive_strength", kObject, "strength"},
    {"strength", "emissiveStrength", kNumber},
    {"material+", "KHR_materials_ior", kObject, "ior"},
    {"ior", "ior", kNumber},
    {"material+", "KHR_materials_iridescence", kObject, "iridescence"},
    {"iridescence", "iridescenceFactor", kNumber},
    {"iridescence", "iridescenceTexture", kObject, "texture use"},
    {"iridescence", "iridescenceIor", kNumber},
    {"iridescence", "iridescenceThicknessMinimum", kNumber},
    {"iridescence", "iridescenceThicknessMaximum", kNumber},
    {"iridescence", "iridescenceThicknessTexture", kObject, "texture use"},
    {"material+", "KHR_materials_pbrSpecularGlossiness", kObject, "gloss"},
    {"gloss", "diffuseFactor", kNumbers, {}, 4},
    {"gloss", "diffuseTexture", kObject, "texture use"},
    {"gloss", "specularFactor", kNumbers, {}, 3},
    {"gloss", "glossinessFactor", kNumber},
    {"gloss", "specularGlossinessTexture", kObject, "texture use"},
    {"material+", "KHR_materials_sheen", kObject, "sheen"},
    {"sheen", "sheenColorFactor", kNumbers, {}, 3},
    {"sheen", "sheenColorTexture", kObject, "texture use"},
    {"sheen", "sheenRoughnessFactor", kNumber},
    {"sheen", "sheenRoughnessTexture", kObject, "texture use"},
    {"material+", "KHR_materials_specular", kObject, "specular"},
    {"specular", "specularFactor", kNumber},
    {"specular", "specularTexture", kObject, "texture use"},
    {"specular", "specularColorFactor", kNumbers, {}, 3},
    {"specular", "specularColorTexture", kObject, "texture use"},
    {"material+", "KHR_materials_transmission", kObject, "transmission"},
    {"transmission", "transmissionFactor", kNumber},
    {"transmission", "transmissionTexture", kObject, "texture use"},
    {"material+", "KHR_materials_unlit", kObject, "unlit"},
    {"material+", "KHR_materials_volume", kObject, "volume"},
    {"volume", "thicknessFactor", kNumber},
    {"volume", "thicknessTexture", kObject, "texture use"},
    {"volume", "attenuationDistance", kNumber},
    {"volume", "attenuationColor", kNumbers, {}, 3},
    {"mesh", "name", kText},
    {"mesh", "primitives", kObjects, "primitive", 0, kNeeded},
    {"mesh", "weights", kNumbers},
    {"primitive", "attributes", kWholeMap, {}, 0, kNeeded},
    {"primitive", "indices", kWhole},
    {"primitive", "material", kWhole},
    {"primitive", "mode", kWhole},
    {"primitive", "targets", kObjects, "morph target"},
    {"primitive+", "KHR_draco_mesh_compression", kObject, "draco"},
    {"primitive+", "KHR_materials_variants", kObject, "mappings"},
    {"draco", "bufferView", kWhole, {}, 0, kNeeded},
    {"draco", "attributes", kWholeMap, {}, 0, kNeeded},
    {"mappings", "mappings", kObjects, "mapping", 0, kNeeded},
    {"mapping", "material", kWhole, {}, 0, kNeeded},
    {"mapping", "variants", kWholes, {}, 0, kNeeded},
    {"mapping", "name", kText},
    {"node", "name", kText},
    {"node", "camera", kWhole},
    {"node", "children", kWholes},
    {"node", "mesh", kWhole},
    {"node", "skin", kWhole},
    {"node", "matrix", kNumbers, {}, 16},
    {"node", "rotation", kNumbers, {}, 4},
    {"node", "scale", kNumbers, {}, 3},
    {"node", "translation", kNumbers, {}, 3},
    {"node", "weights", kNumbers},
    {"node+", "EXT_mesh_gpu_instancing", kObject, "instances"},
    {"node+", "KHR_lights_punctual", kObject, "light use"},
    {"instances", "attributes", kWholeMap, {}, 0, kNeeded},
    {"light use", "light", kWhole, {}, 0, kNeeded},
    {"lights", "lights", kObjects, "light", 0, kNeeded},
    {"light", "name", kText},
    {"light", "type", kText, {}, 0, kNeeded},
    {"light", "color", kNumbers, {}, 3},
    {"light", "intensity", kNumber},
    {"light", "range", kNumber},
    {"light", "spot", kObject, "spot"},
    {"spot", "innerConeAngle", kNumber},
    {"spot", "outerConeAngle", kNumber},
    {"sampler", "name", kText},
    {"sampler", "magFilter", kWhole},
    {"sampler", "minFilter", kWhole},
    {"sampler", "wrapS", kWhole},
    {"sampler", "wrapT", kWhole},
    {"scene", "name", kText},
    {"scene", "nodes", kWholes},
    {"skin", "name", kText},
    {"skin", "inverseBindMatrices", kWhole},
    {"skin", "skeleton", kWhole},
    {"skin", "joints", kWholes, {}, 0, kNeeded},
    {"texture", "name", kText},
    {"texture", "sampler", kWhole},
    {"texture", "source", kWhole},
    {"texture+", "EXT_texture_webp", kObject, "texture source"},
    {"texture+", "KHR_texture_basisu", kObject, "texture source"},
    {"texture source", "source", kWhole},
    {"variants", "variants", kObjects, "variant", 0, kNeeded},
    {"variant", "name", kText, {}, 0, kNeeded},
};

/// A whole number beyond it is not exact in a double.
constexpr double kMostExact = 0x1p53;
constexpr std::size_t kMostShown = 40;

/// Where a value stands: below a key or a number of its parent.
struct GltfStep {
  const GltfStep* parent = nullptr;
  std::string_view key;
  std::size_t index = 0;  ///< counts if there is no key

  std::string text() const {
    const std::string before = parent == nullptr ? "" : parent->text();
    if (key.empty()) return before + "[" + std::to_string(index) + "]";
    return before.empty() ? std::string(key) : before + "." + std::string(key);
  }
};

std::string found_text(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "a list";
  if (value.is_string()) return quote_name(value.get<std::string>().substr(0, kMostShown));
  return value.dump();
}

/// The pass over a file.
class TypeCheck {
 public:
  explicit TypeCheck(const std::string& path) : path_(path) {}

  void object(json& value, std::string_view kind, const GltfStep* at) const {
    const auto of_kind = rows().find(kind);
    if (of_kind == rows().end()) return;
    for (const GltfProperty* property : of_kind->second) {
      const auto found = value.find(property->key);
      const GltfStep step{at, property->key};
      if (found != value.end())
        check(*found, *property, step);
      else if (property->need == kNeeded)
        throw Error(Location{path_}, (at == nullptr ? "" : at->text() + ": ") + "'" +
                                         std::string(property->key) + "' is missing");
    }
    if (kind.ends_with('+')) return;
    const auto extensions = value.find("extensions");
    if (extensions == value.end()) return;
    const GltfStep step{at, "extensions"};
    if (!extensions->is_object()) fail(step, "an object", *extensions);
    for (const auto& [name, extension] : extensions->items())
      if (!extension.is_object()) fail(GltfStep{&step, name}, "an object", extension);
    object(*extensions, std::string(kind) + "+", &step);
  }

 private:
  using Rows = std::map<std::string, std::vector<const GltfProperty*>, std::less<>>;

  static const Rows& rows() {
    static const Rows rows = [] {
      Rows made;
      for (const GltfProperty& property : kGltfSchema) made[std::string(property.owner)].push_back(&property);
      return made;
    }();
    return rows;
  }

  [[noreturn]] void fail(const GltfStep& at, const std::string& expected, const json& found) const {
    throw Error(Location{path_}, at.text() + ": expected " + expected + ", found " + found_text(found));
  }

  void check(json& value, const GltfProperty& p, const GltfStep& at) const {
    switch (p.type) {
      case GltfType::text:
        return text(value, at);
      case GltfType::flag:
        if (!value.is_boolean()) fail(at, "true or false", value);
        return;
      case GltfType::number:
        return number(value, at);
      case GltfType::whole:
        return whole(value, at);
      case GltfType::numbers:
        items(value, at, "a list of numbers", [this](json& v, const GltfStep& s) { number(v, s); });
        if (p.size != 0 && value.size() != p.size)
          throw Error(Location{path_}, at.text() + ": expected " + std::to_string(p.size) +
                                           " numbers, found " + std::to_string(value.size()));
        return;
      case GltfType::wholes:
        return items(value, at, "a list of whole numbers",
                     [this](json& v, const GltfStep& s) { whole(v, s); });
      case GltfType::texts:
        return items(value, at, "a list of texts", [this](json& v, const GltfStep& s) { text(v, s); });
      case GltfType::whole_map:
        return whole_map(value, at);
      case GltfType::object:
        if (!value.is_object()) fail(at, "an object", value);
        return object(value, p.of, &at);
      case GltfType::objects:
        return items(value, at, "a list of objects", [this, &p](json& v, const GltfStep& s) {
          if (!v.is_object()) fail(s, "an object", v);
          p.of == "morph target" ? whole_map(v, s) : object(v, p.of, &s);
        });
    }
  }

  template <class Check>
  void items(json& value, const GltfStep& at, const char* expected, const Check& check) const {
    if (!value.is_array()) fail(at, expected, value);
    for (std::size_t i = 0; i < value.size(); ++i) check(value[i], GltfStep{&at, {}, i});
  }

  void text(const json& value, const GltfStep& at) const {
    if (!value.is_string()) fail(at, "a text", value);
  }
  void number(const json& value, const GltfStep& at) const {
    if (!value.is_number()) fail(at, "a number", value);
  }
  void whole_map(json& value, const GltfStep& at) const {
    if (!value.is_object()) fail(at, "an object", value);
    for (auto& [key, item] : value.items()) whole(item, GltfStep{&at, key});
  }

  /// 36.0 and 3.6e1 are the whole number 36.
  void whole(json& value, const GltfStep& at) const {
    if (value.is_number_float()) {
      const double x = value.get<double>();
      if (x >= 0 && x <= kMostExact && x == std::floor(x)) value = static_cast<std::uint64_t>(x);
    }
    if (!value.is_number_unsigned()) fail(at, "a whole number of 0 or more", value);
  }

  const std::string& path_;
};

}  // namespace

void check_gltf_types(const std::string& path, json& root) { TypeCheck(path).object(root, "file", nullptr); }

}  // namespace oktett
