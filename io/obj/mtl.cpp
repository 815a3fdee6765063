#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/mesh/reading.h"
#include "io/obj/mtl_texture.h"
#include "io/obj/obj.h"
#include "io/text/file_content.h"

namespace oktett {
namespace {

float clamp_unit(float x) { return std::clamp(x, 0.0f, 1.0f); }

/// Rec.709.
float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// What the statements of one material say, before they are put in terms of Material.
struct Statements {
  std::optional<Color> ka, kd, ks, ke, tf;
  std::optional<float> d, tr;
  float illum = 2;
  struct Principled {
    std::optional<float> value;
    std::optional<std::uint32_t> texture;
  };
  std::array<Principled, 5> principled;  ///< in the order of kPrincipled
  Location ior_place;                    ///< of the last Ni
};

constexpr std::pair<const char*, std::optional<Color> Statements::*> kColors[] = {{"ka", &Statements::ka},
                                                                                  {"kd", &Statements::kd},
                                                                                  {"ks", &Statements::ks},
                                                                                  {"ke", &Statements::ke},
                                                                                  {"tf", &Statements::tf}};

constexpr std::pair<const char*, std::uint32_t Material::*> kTextures[] = {
    {"map_kd", &Material::color_texture},    {"map_ks", &Material::specular_texture},
    {"map_ke", &Material::emission_texture}, {"map_d", &Material::opacity_texture},
    {"map_bump", &Material::bump_texture},   {"bump", &Material::bump_texture},
    {"norm", &Material::normal_texture},     {"map_normal", &Material::normal_texture}};

// The statements of the extension for physically based rendering. One of them makes a material principled.
// "map_" before a statement gives the texture.
struct PrincipledStatement {
  std::string_view key;   ///< in lower case, as MtlLine::keyword
  std::string_view name;  ///< as it is written
  float PrincipledParameters::*value;
  std::uint32_t PrincipledMaterial::*texture;
};
constexpr PrincipledStatement kPrincipled[] = {
    {"pr", "Pr", &PrincipledParameters::roughness, &PrincipledMaterial::roughness_texture},
    {"pm", "Pm", &PrincipledParameters::metallic, &PrincipledMaterial::metallic_texture},
    {"ps", "Ps", &PrincipledParameters::sheen, &PrincipledMaterial::sheen_texture},
    {"pc", "Pc", &PrincipledParameters::coat, &PrincipledMaterial::coat_texture},
    {"pcr", "Pcr", &PrincipledParameters::coat_roughness, &PrincipledMaterial::coat_roughness_texture}};

// What is read of a material beside the above, and what is not, though other programs know it.
constexpr const char* kNumbers[] = {"d", "tr", "ns", "ni", "illum"};
constexpr const char* kOtherStatements[] = {
    "map_ka", "map_ns",   "map_ni", "map_tr", "map_tf",    "map_aat", "disp",   "map_disp",  "decal",
    "refl",   "map_refl", "km",     "map_km", "sharpness", "aniso",   "anisor", "map_aniso", "map_anisor"};

/// All keywords of materials that mean something here, in lower case.
const std::vector<std::string>& used_statements() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const auto& [name, color] : kColors) names.emplace_back(name);
    for (const auto& [name, slot] : kTextures) names.emplace_back(name);
    names.insert(names.end(), std::begin(kNumbers), std::end(kNumbers));
    for (const PrincipledStatement& statement : kPrincipled) {
      names.emplace_back(statement.key);
      names.push_back(std::string("map_").append(statement.key));
    }
    return names;
  }();
  return all;
}

/// What there is to say of the statement `written`, whose keyword in lower case is `key`; empty: nothing.
std::string why_unused(const std::string& key, const std::string& written) {
  const std::vector<std::string>& used = used_statements();
  if (std::ranges::find(used, key) != used.end()) return "";
  if (std::ranges::find(kOtherStatements, key) != std::end(kOtherStatements)) return written + " is not used";
  return "unknown statement " + written + did_you_mean(key, used);
}

class MtlReader {
 public:
  MtlReader(const std::string& path, std::vector<Material>& materials, std::vector<Texture>& textures,
            std::vector<Warning>& warnings, MtlPlaces* places)
      : path_(path),
        directory_(std::filesystem::path(path).parent_path().string()),
        materials_(materials),
        first_(materials.size()),
        textures_(textures),
        warnings_(warnings),
        places_(places) {}

  void run() {
    const MappedFile file(path_);
    const std::string_view text = without_byte_order_mark(file.text());
    const char* const end = text.data() + text.size();
    LineCounter lines(text);
    for (const char* p = text.data(); p < end;) {
      p = skip_blanks(p);
      MtlLine line(p, path_, lines, warnings_);
      if (line.keyword() == "newmtl")
        start_material(line);
      else if (in_material_)
        read_statement(line);
      if (in_material_) note_unused(line, p);
      p = next_line(find_joined_line_end(p), end);
    }
    finish_material();
    if (materials_.size() == first_) warnings_.push_back({Location{path_}, "no materials"});
  }

 private:
  void start_material(MtlLine& line) {
    finish_material();
    Material material;
    material.name = line.take_rest();
    if (material.name.empty()) line.warn("expected the name of the material");
    if (!names_.insert(material.name).second)
      line.warn("material " + quote_name(material.name) + " is defined again; the first definition counts");
    materials_.push_back(std::move(material));
    if (places_ != nullptr) places_->materials.push_back(line.where());
    said_ = Statements{};
    in_material_ = true;
  }

  void read_statement(MtlLine& line) {
    const std::string& key = line.keyword();
    Material& material = materials_.back();
    for (const auto& [name, color] : kColors)
      if (key == name) read(line.take_color(), said_.*color);
    for (const auto& [name, slot] : kTextures)
      if (key == name) read_texture(line, slot, material);
    if (key == "d") {
      // The halo, which depends on the angle of view, is not reproduced.
      if (line.peek() == "-halo") line.take();
      read(take_part(line, "d"), said_.d);
    } else if (key == "tr") {
      read(take_part(line, "Tr"), said_.tr);
    } else if (key == "ns") {
      read(take(
               line, [](float x) { return x >= 0; }, "Ns must not be negative"),
           material.phong);
    } else if (key == "ni") {
      read(take(
               line, [](float x) { return x > 0; }, "Ni must be greater than 0"),
           material.ior);
      said_.ior_place = line.where();
    } else if (key == "illum") {
      const auto is_model = [](float x) { return x >= 0 && x <= 10 && x == std::floor(x); };
      read(take(line, is_model, "illum must be a whole number from 0 to 10"), said_.illum);
    }
    for (std::size_t i = 0; i < std::size(kPrincipled); ++i) {
      if (key == kPrincipled[i].key) read(take_part(line, kPrincipled[i].name), said_.principled[i].value);
      if (key == std::string("map_").append(kPrincipled[i].key))
        if (const auto texture = read_mtl_texture(line, directory_))
          said_.principled[i].texture = add_texture(*texture, line);
    }
  }

  /// The statement stands at `p`.
  void note_unused(const MtlLine& line, const char* p) {
    const std::string& key = line.keyword();
    if (places_ == nullptr || key.empty() || key == "newmtl" || !noted_.insert(key).second) return;
    if (const std::string why = why_unused(key, quote_word(p)); !why.empty())
      places_->unused.push_back({line.where(), why});
  }

  /// A malformed value leaves what was there.
  template <class T>
  static void read(const std::optional<T>& value, auto& target) {
    if (value) target = *value;
  }

  /// The number that follows; nothing, after a warning, if there is none or it is not allowed.
  static std::optional<float> take(MtlLine& line, bool (*allowed)(float), const std::string& rule) {
    const std::optional<float> value = line.take_number();
    if (!value || allowed(*value)) return value;
    line.warn(rule + "; the default is kept");
    return std::nullopt;
  }

  /// The number that follows, limited to 0 and 1 with a warning. `name` is that of the statement.
  static std::optional<float> take_part(MtlLine& line, std::string_view name) {
    const std::optional<float> value = line.take_number();
    if (!value || (*value >= 0 && *value <= 1)) return value;
    line.warn(std::string(name) + " must be from 0 to 1; it counts as " + (*value > 1 ? "1" : "0"));
    return clamp_unit(*value);
  }

  std::uint32_t add_texture(const MtlTexture& texture, const MtlLine& line) {
    const std::uint32_t index = textures_.add(texture.texture);
    if (places_ != nullptr && index >= places_->textures.size()) places_->textures.push_back(line.where());
    return index;
  }

  void read_texture(MtlLine& line, std::uint32_t Material::*slot, Material& material) {
    const std::optional<MtlTexture> texture = read_mtl_texture(line, directory_);
    if (!texture) return;
    material.*slot = add_texture(*texture, line);
    if (slot == &Material::bump_texture) material.bump_scale = texture->bump_scale;
  }

  void finish_material() {
    if (!in_material_) return;
    Material& m = materials_.back();
    set_opacity(m);
    set_diffuse(m);
    set_specular(m);
    if (said_.ke)
      m.emission = *said_.ke;
    else if (m.emission_texture != kNoId)
      m.emission = {1, 1, 1};
    set_principled(m);
  }

  void set_principled(Material& m) {
    const auto said = [](const Statements::Principled& p) { return p.value || p.texture; };
    if (std::ranges::none_of(said_.principled, said)) return;
    PrincipledMaterial& principled = m.principled.emplace(principled_like(m));
    limit_ior(principled.parameters.ior);
    for (std::size_t i = 0; i < std::size(kPrincipled); ++i) {
      const auto& [value, texture] = said_.principled[i];
      // A texture without a number to multiply shows as it is.
      if (value || texture) principled.parameters.*kPrincipled[i].value = value.value_or(1);
      if (texture) principled.*kPrincipled[i].texture = *texture;
    }
  }

  void limit_ior(float& ior) {
    constexpr float kMost = kMostIor, kLeast = 1 / kMost;
    if (ior >= kLeast && ior <= kMost) return;
    ior = std::clamp(ior, kLeast, kMost);
    warnings_.push_back({said_.ior_place,
                         fmt::format("Ni must be from {} to {} beside Pr, Pm, Ps, Pc or Pcr; it counts as {}",
                                     kLeast, kMost, ior)});
  }

  void set_opacity(Material& m) const {
    if (said_.d)
      m.transparency = 1 - *said_.d;
    else if (said_.tr)
      m.transparency = *said_.tr;
  }

  void set_diffuse(Material& m) const {
    if (said_.kd) {
      m.color = *said_.kd;
      m.diffuse = 1;
    } else if (m.color_texture != kNoId) {
      m.color = {1, 1, 1};
      m.diffuse = 1;
    }
    if (m.transparency > 0) {
      // In MTL the surface and what is seen through it share the light; weights of Material add up.
      m.diffuse *= 1 - m.transparency;
      // One colour serves both what is scattered and what passes, and the filter shows more.
      if (said_.tf) {
        const float before = luminance(m.color);
        m.color = *said_.tf;
        const float after = luminance(m.color);
        m.diffuse = after > 0 ? clamp_unit(m.diffuse * before / after) : 0;
      }
    }
    if (said_.ka) {
      const float brightness = luminance(m.color);
      m.ambient = brightness > 0 ? clamp_unit(luminance(*said_.ka) / brightness) : 0;
    }
  }

  void set_specular(Material& m) const {
    const bool has_color = said_.ks && max_component(*said_.ks) > 0;
    // A black Ks takes away the highlight but not the reflections that glass has by nature.
    if (has_color) m.specular_color = *said_.ks;
    m.specular = has_color || (!said_.ks && m.specular_texture != kNoId) ? 1.0f : 0.0f;
    const bool mirrors = said_.illum == 3 || said_.illum == 5;
    if (mirrors && said_.ks) m.reflection = clamp_unit(luminance(*said_.ks));
  }

  const std::string path_;
  const std::string directory_;
  std::vector<Material>& materials_;
  const std::size_t first_;
  TextureList textures_;
  std::vector<Warning>& warnings_;
  MtlPlaces* places_;
  std::unordered_set<std::string> names_, noted_;
  Statements said_;
  bool in_material_ = false;
};

}  // namespace

void load_mtl(const std::string& path, std::vector<Material>& materials, std::vector<Texture>& textures,
              std::vector<Warning>& warnings, MtlPlaces* places) {
  MtlReader(path, materials, textures, warnings, places).run();
}

}  // namespace oktett
