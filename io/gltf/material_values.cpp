#include <cmath>

#include "io/gltf/tiny_model.h"
#include "io/mesh/failure.h"

namespace oktett {
namespace {

using tinygltf::Value;

constexpr double kMost = 1e30;

/// The reading of one material.
class MaterialReader {
 public:
  MaterialReader(const std::string& path, const tinygltf::Material& in, std::size_t i, std::size_t textures,
                 std::vector<std::string>& warnings)
      : path_(path), in_(in), textures_(textures), warnings_(warnings), where_(gltf_place("materials", i)) {}

  GltfMaterial run() {
    const tinygltf::PbrMetallicRoughness& pbr = in_.pbrMetallicRoughness;
    out_.name = in_.name;
    out_.base_color = color(pbr.baseColorFactor, 1);
    out_.alpha = number(pbr.baseColorFactor.back(), 1, "baseColorFactor");
    out_.metallic = number(pbr.metallicFactor, 1, "metallicFactor");
    out_.roughness = number(pbr.roughnessFactor, 1, "roughnessFactor");
    out_.emission = color(in_.emissiveFactor, kMost);
    out_.base_texture = texture(pbr.baseColorTexture);
    out_.metallic_roughness_texture = texture(pbr.metallicRoughnessTexture);
    out_.normal_texture = texture(in_.normalTexture);
    out_.emission_texture = texture(in_.emissiveTexture);
    if (in_.normalTexture.index >= 0 && in_.normalTexture.scale != 1)
      warn("the scale of its normals is not read");
    out_.double_sided = in_.doubleSided;
    read_alpha();
    read_extensions();
    return out_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Location{path_}, where_ + ": " + what);
  }
  void warn(const std::string& what) { warnings_.push_back(where_ + ": " + what); }

  float number(double x, double most, const char* key) const {
    if (!(x >= 0 && x <= most)) fail(std::string("'") + key + "' is out of range");
    return static_cast<float>(x);
  }
  Color color(const std::vector<double>& numbers, double most) const {
    return gltf_color(path_, where_, numbers, most);
  }

  void read_alpha() {
    out_.alpha_cutoff = number(in_.alphaCutoff, kMost, "alphaCutoff");
    if (in_.alphaMode == "MASK")
      out_.alpha_mode = GltfMaterial::Alpha::mask;
    else if (in_.alphaMode == "BLEND")
      out_.alpha_mode = GltfMaterial::Alpha::blend;
    else if (in_.alphaMode != "OPAQUE")
      fail("unknown alphaMode " + quote_name(in_.alphaMode));
  }

  template <class Info>
  GltfTextureUse texture(const Info& info) {
    const auto transform = info.extensions.find("KHR_texture_transform");
    return texture(info.index, info.texCoord,
                   transform == info.extensions.end() ? nullptr : &transform->second);
  }

  GltfTextureUse texture(int index, int uvs, const Value* transform) {
    GltfTextureUse use;
    if (index == -1) return use;
    if (index < 0 || static_cast<std::size_t>(index) >= textures_)
      fail("there is no texture " + std::to_string(index) + ": the file has " + std::to_string(textures_));
    use.texture = static_cast<std::uint32_t>(index);
    if (transform != nullptr && transform->IsObject()) {
      const auto pair = [&](const char* key, Vec2f standard) {
        const Value& value = transform->Get(key);
        if (!value.IsArray() || value.ArrayLen() != 2) return standard;
        return Vec2f{signed_number(value.Get(0)), signed_number(value.Get(1))};
      };
      use.offset = pair("offset", {0, 0}), use.scale = pair("scale", {1, 1});
      const Value& rotation = transform->Get("rotation");
      if (rotation.IsNumber() && rotation.GetNumberAsDouble() != 0)
        warn("the rotation of a texture is not read");
      if (const Value& set = transform->Get("texCoord"); set.IsInt()) uvs = set.GetNumberAsInt();
    }
    if (uvs < 0 || uvs >= static_cast<int>(kMostGltfUvs))
      fail("set " + std::to_string(uvs) + " of texture coordinates; expected 0 to " +
           std::to_string(kMostGltfUvs - 1));
    use.uvs = static_cast<std::uint32_t>(uvs);
    return use;
  }

  float signed_number(const Value& value) const {
    const double x = value.IsNumber() ? value.GetNumberAsDouble() : 0;
    if (!(std::abs(x) <= 1e6)) fail("a transform of a texture is out of range");
    return static_cast<float>(x);
  }

  /// An extension, or an empty value.
  const Value& extension(const char* name) const {
    static const Value nothing{Value::Object{}};
    const auto found = in_.extensions.find(name);
    return found == in_.extensions.end() || !found->second.IsObject() ? nothing : found->second;
  }
  void read(const Value& object, const char* key, double most, float& out) const {
    if (const Value& value = object.Get(key); value.IsNumber())
      out = number(value.GetNumberAsDouble(), most, key);
  }
  void read(const Value& object, const char* key, GltfTextureUse& out) {
    const Value& info = object.Get(key);
    if (!info.IsObject()) return;
    const auto whole = [&](const char* name, int standard) {
      const Value& value = info.Get(name);
      return value.IsInt() ? value.GetNumberAsInt() : standard;
    };
    const Value& extensions = info.Get("extensions");
    const Value* const transform = extensions.IsObject() ? &extensions.Get("KHR_texture_transform") : nullptr;
    out = texture(whole("index", -2), whole("texCoord", 0), transform);
  }

  void read_extensions() {
    float strength = 1;
    read(extension("KHR_materials_emissive_strength"), "emissiveStrength", kMost, strength);
    out_.emission = out_.emission * strength;
    if (!(out_.emission.x <= kMost && out_.emission.y <= kMost && out_.emission.z <= kMost))
      fail("its emission is out of range");
    read(extension("KHR_materials_ior"), "ior", 1000, out_.ior);
    out_.unlit = in_.extensions.contains("KHR_materials_unlit");
    const Value& transmission = extension("KHR_materials_transmission");
    read(transmission, "transmissionFactor", 1, out_.transmission);
    read(transmission, "transmissionTexture", out_.transmission_texture);
    const Value& volume = extension("KHR_materials_volume");
    read(volume, "thicknessFactor", kMost, out_.thickness);
    if (volume.Has("attenuationDistance")) warn("what its inside absorbs is not read");
    const Value& specular = extension("KHR_materials_specular");
    read(specular, "specularFactor", 1, out_.specular);
    read(specular, "specularTexture", out_.specular_texture);
    if (specular.Has("specularColorFactor") || specular.Has("specularColorTexture"))
      warn("the colour of its reflections is not read");
    const Value& coat = extension("KHR_materials_clearcoat");
    read(coat, "clearcoatFactor", 1, out_.coat);
    read(coat, "clearcoatTexture", out_.coat_texture);
    read(coat, "clearcoatRoughnessFactor", 1, out_.coat_roughness);
    read(coat, "clearcoatRoughnessTexture", out_.coat_roughness_texture);
    if (coat.Has("clearcoatNormalTexture")) warn("the normals of its coat are not read");
    read_sheen(extension("KHR_materials_sheen"));
  }

  void read_sheen(const Value& sheen) {
    if (const Value& color = sheen.Get("sheenColorFactor"); color.IsArray()) {
      std::vector<double> numbers;
      for (std::size_t k = 0; k < color.ArrayLen(); ++k)
        numbers.push_back(color.Get(static_cast<int>(k)).GetNumberAsDouble());
      out_.sheen_color = this->color(numbers, 1);
    }
    read(sheen, "sheenColorTexture", out_.sheen_color_texture);
    read(sheen, "sheenRoughnessFactor", 1, out_.sheen_roughness);
    read(sheen, "sheenRoughnessTexture", out_.sheen_roughness_texture);
  }

  const std::string& path_;
  const tinygltf::Material& in_;
  const std::size_t textures_;
  std::vector<std::string>& warnings_;
  const std::string where_;
  GltfMaterial out_;
};

}  // namespace

Color gltf_color(const std::string& path, const std::string& where, const std::vector<double>& numbers,
                 double most) {
  const bool good = numbers.size() >= 3 && numbers[0] >= 0 && numbers[0] <= most && numbers[1] >= 0 &&
                    numbers[1] <= most && numbers[2] >= 0 && numbers[2] <= most;
  if (!good) throw Error(Location{path}, where + ": expected a colour of three numbers in range");
  return static_cast<Color>(Vec3d{numbers[0], numbers[1], numbers[2]});
}

GltfMaterial gltf_material(const std::string& path, const tinygltf::Material& m, std::size_t i,
                           std::size_t textures, std::vector<std::string>& warnings) {
  return MaterialReader(path, m, i, textures, warnings).run();
}

}  // namespace oktett
