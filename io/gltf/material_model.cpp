#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/gltf/json.h"
#include "io/mesh/reading.h"

namespace oktett {

namespace {

constexpr double kMost = 1e30;

/// The reading of one material.
class MaterialReader {
 public:
  MaterialReader(const std::string& path, const GltfJson& in, std::size_t i, std::size_t textures,
                 std::vector<std::string>& warnings)
      : path_(path), in_(in), textures_(textures), warnings_(warnings), where_(gltf_place("materials", i)) {}

  GltfMaterial run() {
    static const GltfJson nothing = GltfJson::object();
    const GltfJson* const given = member(in_, "pbrMetallicRoughness");
    const GltfJson& pbr = given == nullptr ? nothing : *given;
    out_.name = text_of(in_, "name");
    out_.metallic = out_.roughness = 1;
    if (const std::vector<double> base = numbers_of(pbr, "baseColorFactor"); !base.empty()) {
      out_.base_color = color(base, 1);
      out_.alpha = number(base.back(), 1, "baseColorFactor");
    }
    read(pbr, "metallicFactor", 1, out_.metallic);
    read(pbr, "roughnessFactor", 1, out_.roughness);
    read_color(in_, "emissiveFactor", kMost, out_.emission);
    read(pbr, "baseColorTexture", out_.base_texture);
    read(pbr, "metallicRoughnessTexture", out_.metallic_roughness_texture);
    read_normals(in_, "normalTexture", out_.normal_texture, out_.normal_scale);
    read(in_, "emissiveTexture", out_.emission_texture);
    out_.double_sided = flag_of(in_, "doubleSided");
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
    read(in_, "alphaCutoff", kMost, out_.alpha_cutoff);
    const std::string mode = text_of(in_, "alphaMode", "OPAQUE");
    if (mode == "MASK")
      out_.alpha_mode = GltfMaterial::Alpha::mask;
    else if (mode == "BLEND")
      out_.alpha_mode = GltfMaterial::Alpha::blend;
    else if (mode != "OPAQUE")
      warn("unknown alphaMode " + quote_name(mode) + "; it is opaque");
  }

  void read_normals(const GltfJson& object, const char* key, GltfTextureUse& out, float& out_scale) const {
    read(object, key, out);
    const GltfJson* const normals = member(object, key);
    if (normals == nullptr) return;
    const double scale = number_of(*normals, "scale", 1);
    if (!(std::abs(scale) <= 1e6)) fail("the scale of its normals is out of range");
    out_scale = static_cast<float>(scale);
  }

  float signed_number(double x) const {
    if (!(std::abs(x) <= 1e6)) fail("a transform of a texture is out of range");
    return static_cast<float>(x);
  }

  /// An extension, or an empty object.
  const GltfJson& extension(const char* name) const {
    static const GltfJson nothing = GltfJson::object();
    const GltfJson* const found = extension_of(in_, name);
    return found == nullptr ? nothing : *found;
  }
  void read(const GltfJson& object, const char* key, double most, float& out) const {
    if (const GltfJson* const value = member(object, key)) out = number(value->get<double>(), most, key);
  }
  void read_color(const GltfJson& object, const char* key, double most, Color& out) const {
    if (member(object, key) != nullptr) out = color(numbers_of(object, key), most);
  }
  void read(const GltfJson& object, const char* key, GltfTextureUse& out) const {
    const GltfJson* const info = member(object, key);
    if (info == nullptr) return;
    const std::uint64_t index = whole_of(*info, "index", kNoId);
    if (index >= textures_)
      fail("there is no texture " + std::to_string(index) + ": the file has " + std::to_string(textures_));
    out.texture = static_cast<std::uint32_t>(index);
    std::uint64_t set = whole_of(*info, "texCoord", 0);
    if (const GltfJson* const transform = extension_of(*info, "KHR_texture_transform")) {
      const auto pair = [&](const char* name, Vec2f standard) {
        const std::vector<double> numbers = numbers_of(*transform, name);
        return numbers.empty() ? standard : Vec2f{signed_number(numbers[0]), signed_number(numbers[1])};
      };
      out.offset = pair("offset", {0, 0}), out.scale = pair("scale", {1, 1});
      out.rotation = static_cast<double>(signed_number(number_of(*transform, "rotation", 0)));
      set = whole_of(*transform, "texCoord", set);
    }
    out.uvs = static_cast<std::uint32_t>(std::min<std::uint64_t>(set, kNoId - 1));
  }

  void read_extensions() {
    float strength = 1;
    read(extension("KHR_materials_emissive_strength"), "emissiveStrength", kMost, strength);
    out_.emission = out_.emission * strength;
    if (!(max_component(out_.emission) <= static_cast<float>(kMost))) fail("its emission is out of range");
    read(extension("KHR_materials_ior"), "ior", 1000, out_.ior);
    out_.unlit = extension_of(in_, "KHR_materials_unlit") != nullptr;
    const GltfJson& transmission = extension("KHR_materials_transmission");
    read(transmission, "transmissionFactor", 1, out_.transmission);
    read(transmission, "transmissionTexture", out_.transmission_texture);
    const GltfJson& volume = extension("KHR_materials_volume");
    read(volume, "thicknessFactor", kMost, out_.thickness);
    if (const GltfJson* const distance = member(volume, "attenuationDistance")) {
      read_color(volume, "attenuationColor", 1, out_.attenuation);
      out_.attenuation_distance = distance->get<double>();
      if (!(out_.attenuation_distance > 0)) fail("'attenuationDistance' is out of range");
    }
    const GltfJson& specular = extension("KHR_materials_specular");
    read(specular, "specularFactor", 1, out_.specular);
    read(specular, "specularTexture", out_.specular_texture);
    read_color(specular, "specularColorFactor", kMost, out_.specular_color);
    read(specular, "specularColorTexture", out_.specular_color_texture);
    const GltfJson& coat = extension("KHR_materials_clearcoat");
    read(coat, "clearcoatFactor", 1, out_.coat);
    read(coat, "clearcoatTexture", out_.coat_texture);
    read(coat, "clearcoatRoughnessFactor", 1, out_.coat_roughness);
    read(coat, "clearcoatRoughnessTexture", out_.coat_roughness_texture);
    read_normals(coat, "clearcoatNormalTexture", out_.coat_normal_texture, out_.coat_normal_scale);
    read_sheen(extension("KHR_materials_sheen"));
    read_anisotropy(extension("KHR_materials_anisotropy"));
    read_iridescence(extension("KHR_materials_iridescence"));
    read(extension("KHR_materials_dispersion"), "dispersion", kMostDispersion, out_.dispersion);
    if (const GltfJson* const gloss = extension_of(in_, "KHR_materials_pbrSpecularGlossiness"))
      read_gloss(*gloss);
  }

  /// As near to it as metal and plastic come. Of one colour, what reflects more than plastic is metal.
  void read_gloss(const GltfJson& gloss) {
    Color diffuse{1, 1, 1}, specular{1, 1, 1};
    if (const std::vector<double> base = numbers_of(gloss, "diffuseFactor"); !base.empty()) {
      diffuse = color(base, 1);
      out_.alpha = number(base.back(), 1, "diffuseFactor");
    } else {
      out_.alpha = 1;
    }
    read_color(gloss, "specularFactor", 1, specular);
    read(gloss, "glossinessFactor", 1, out_.gloss);
    out_.base_texture = out_.metallic_roughness_texture = {};
    read(gloss, "diffuseTexture", out_.base_texture);
    read(gloss, "specularGlossinessTexture", out_.gloss_texture);
    out_.is_glossy = true;
    out_.specular_color_texture = out_.gloss_texture;
    constexpr float kPlastic = 0.04f;
    const float most = max_component(specular);
    const bool shows_texture = out_.gloss_texture.texture != kNoId;
    out_.metallic = shows_texture ? 0 : std::clamp((most - kPlastic) / (1 - kPlastic), 0.0f, 1.0f);
    out_.base_color = diffuse * (1 - out_.metallic) + specular * out_.metallic;
    if (out_.metallic == 0) out_.specular_color = specular * (1 / kPlastic);
  }

  void read_anisotropy(const GltfJson& anisotropy) {
    read(anisotropy, "anisotropyStrength", 1, out_.anisotropy);
    read(anisotropy, "anisotropyTexture", out_.anisotropy_texture);
    out_.anisotropy_rotation = number_of(anisotropy, "anisotropyRotation", 0);
    if (!(std::abs(out_.anisotropy_rotation) <= 1e6)) fail("'anisotropyRotation' is out of range");
  }

  void read_iridescence(const GltfJson& film) {
    read(film, "iridescenceFactor", 1, out_.iridescence);
    read(film, "iridescenceTexture", out_.iridescence_texture);
    read(film, "iridescenceIor", 1000, out_.iridescence_ior);
    read(film, "iridescenceThicknessMinimum", kMostFilm, out_.least_thickness);
    read(film, "iridescenceThicknessMaximum", kMostFilm, out_.most_thickness);
    read(film, "iridescenceThicknessTexture", out_.thickness_texture);
  }

  void read_sheen(const GltfJson& sheen) {
    read_color(sheen, "sheenColorFactor", 1, out_.sheen_color);
    read(sheen, "sheenColorTexture", out_.sheen_color_texture);
    read(sheen, "sheenRoughnessFactor", 1, out_.sheen_roughness);
    read(sheen, "sheenRoughnessTexture", out_.sheen_roughness_texture);
  }

  const std::string& path_;
  const GltfJson& in_;
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

GltfMaterial gltf_material(const std::string& path, const GltfJson& m, std::size_t i, std::size_t textures,
                           std::vector<std::string>& warnings) {
  return MaterialReader(path, m, i, textures, warnings).run();
}

}  // namespace oktett
