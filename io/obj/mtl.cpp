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

#include "core/color.h"
#include "core/error.h"
#include "io/mesh/reading.h"
#include "io/obj/mtl_texture.h"
#include "io/obj/obj.h"
#include "io/text/file_content.h"

namespace oktett {
namespace {

float clamp_unit(float x) { return std::clamp(x, 0.0f, 1.0f); }

/// The programs whose files mean other things by a statement than others do, known by a comment before the
/// first material.
enum class MtlWriter { other, meshlab, vtk, blender, oktett };

constexpr std::pair<std::string_view, MtlWriter> kWriters[] = {
    {"Converted by Meshlab", MtlWriter::meshlab},
    {"written by the visualization toolkit", MtlWriter::vtk},
    {"# Blender", MtlWriter::blender},
    {"# Written by Oktett", MtlWriter::oktett}};

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
  Location tr_place;                     ///< of the last Tr
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
        texture_list_(textures),
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
      if (*p == '#' && !in_material_) note_writer(p);
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
  /// The comment stands at `p`.
  void note_writer(const char* p) {
    const std::string_view comment(p, static_cast<std::size_t>(find_line_end(p) - p));
    for (const auto& [words, writer] : kWriters)
      if (comment.find(words) != std::string_view::npos) writer_ = writer;
  }

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
      said_.tr_place = line.where();
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
        if (const auto texture = read_mtl_texture(line, directory_, ImageChannel::luminance))
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
    const bool is_number = slot == &Material::opacity_texture || slot == &Material::bump_texture;
    std::optional<MtlTexture> texture =
        read_mtl_texture(line, directory_, is_number ? ImageChannel::luminance : ImageChannel::red);
    if (!texture) return;
    // A colour shows all channels, and that alpha is a grey in its place is meant by no such file.
    if (!is_number && texture->texture.channel == ImageChannel::alpha)
      texture->texture.channel = ImageChannel::red;
    material.*slot = add_texture(*texture, line);
    if (slot == &Material::bump_texture) material.bump_scale = texture->bump_scale;
  }

  void finish_material() {
    if (!in_material_) return;
    Material& m = materials_.back();
    set_opacity(m);
    limit_light(m);
    set_diffuse(said_, m);
    set_specular(said_, m);
    if (said_.ke)
      m.emission = *said_.ke;
    else if (m.emission_texture != kNoId)
      m.emission = {1, 1, 1};
    if (is_principled()) set_principled(m);
    drop_doubled_normals(m);
  }

  /// Some programs name a normal map as `norm` for some readers and as `map_Bump` for others.
  void drop_doubled_normals(Material& m) const {
    if (m.bump_texture == kNoId || m.normal_texture == kNoId) return;
    if (texture_list_[m.bump_texture].path != texture_list_[m.normal_texture].path) return;
    m.bump_texture = kNoId;
    m.bump_scale = 1;
  }

  bool is_principled() const {
    return std::ranges::any_of(said_.principled,
                               [](const Statements::Principled& p) { return p.value || p.texture; });
  }

  void set_principled(Material& m) {
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

  /// The part of the surface that covers what is behind it, and the rest: the one that the file says as it
  /// says it.
  struct Coverage {
    float covered = 1, clear = 0;
  };

  /// Nothing if no statement says so. `d` counts where `Tr` is there, too.
  std::optional<Coverage> coverage() {
    const std::optional<float>&d = said_.d, &tr = said_.tr;
    constexpr float kSame = 0.01f;  // some programs write few digits
    if (d && tr && std::abs(*tr - (1 - *d)) > kSame && std::abs(*tr - *d) > kSame)
      warnings_.push_back(
          {said_.tr_place, fmt::format("Tr {} and d {} contradict each other; d counts", *tr, *d)});
    if (d) return Coverage{*d, 1 - *d};
    if (!tr) return std::nullopt;
    const bool is_opacity = writer_ == MtlWriter::meshlab || writer_ == MtlWriter::vtk;
    return is_opacity ? Coverage{*tr, 1 - *tr} : Coverage{1 - *tr, *tr};
  }

  /// Physically based materials are covered in parts, as programs that write them show them, and `Tf` is how
  /// much light passes the rest; others are see-through.
  void set_opacity(Material& m) {
    const Coverage said = coverage().value_or(Coverage{});
    if (!is_principled()) {
      m.transparency = said.clear;
      return;
    }
    m.opacity = said.covered;
    const bool says_transmission = writer_ == MtlWriter::blender || writer_ == MtlWriter::oktett;
    if (said_.tf && says_transmission) m.transparency = clamp_unit(said_.tf->y);
  }

  void set_diffuse(const Statements& said, Material& m) const {
    if (said.kd) {
      m.color = *said.kd;
      m.diffuse = 1;
    } else if (m.color_texture != kNoId) {
      m.color = {1, 1, 1};
      m.diffuse = 1;
    }
    if (m.transparency > 0) {
      // In MTL the surface and what is seen through it share the light; weights of Material add up.
      m.diffuse *= 1 - m.transparency;
      if (!is_principled()) {
        // Kd colours what is scattered, Tf what passes, which does not bend where no Ni says so.
        m.filter = min(said.tf.value_or(Color{1, 1, 1}), Color{1, 1, 1});
        if (said.ior_place.line == 0) m.ior = 1;
      }
    }
    if (said.ka) {
      const float brightness = luminance(m.color);
      m.ambient = brightness > 0 ? clamp_unit(luminance(*said.ka) / brightness) : 0;
    }
  }

  static void set_specular(const Statements& said, Material& m) {
    const bool has_color = said.ks && max_component(*said.ks) > 0;
    // A black Ks takes away the highlight but not the reflections that glass has by nature.
    if (has_color) m.specular_color = *said.ks;
    m.specular = has_color || (!said.ks && m.specular_texture != kNoId) ? 1.0f : 0.0f;
    const bool mirrors = said.illum == 3 || said.illum == 5;
    if (mirrors && said.ks) m.reflection = clamp_unit(luminance(*said.ks));
  }

  /// What a material of these statements gives back, at most.
  float albedo_of(const Statements& said, const Material& start) const {
    Material m = start;
    set_diffuse(said, m);
    set_specular(said, m);
    return greatest_albedo(m, texture_list_);
  }

  /// Darkens Kd and Ks until the surface gives back no more light than arrives. Highlights of small
  /// exponents, almost as wide as the hemisphere, which some programs write everywhere, get only what the
  /// diffuse light leaves.
  void limit_light(const Material& m) {
    constexpr float kMost = 1 + 1e-5f, kWideHighlight = 10;
    const auto scaled = [&](float kd, float ks) {
      Statements said = said_;
      if (said.kd) said.kd = *said.kd * kd;
      if (said.ks) said.ks = *said.ks * ks;
      return said;
    };
    const auto limit = [&](const auto& part) {
      if (!(albedo_of(part(1.0f), m) > kMost)) return;
      float least = 0, most = 1;
      for (int i = 0; i < 24; ++i) {
        const float middle = (least + most) / 2;
        (albedo_of(part(middle), m) > 1 ? most : least) = middle;
      }
      said_ = part(least);
    };
    if (m.phong < kWideHighlight) limit([&](float s) { return scaled(1, s); });
    limit([&](float s) { return scaled(s, s); });
  }

  const std::string path_;
  const std::string directory_;
  std::vector<Material>& materials_;
  const std::size_t first_;
  const std::vector<Texture>& texture_list_;
  TextureList textures_;
  std::vector<Warning>& warnings_;
  MtlPlaces* places_;
  std::unordered_set<std::string> names_, noted_;
  Statements said_;
  MtlWriter writer_ = MtlWriter::other;
  bool in_material_ = false;
};

}  // namespace

void load_mtl(const std::string& path, std::vector<Material>& materials, std::vector<Texture>& textures,
              std::vector<Warning>& warnings, MtlPlaces* places) {
  MtlReader(path, materials, textures, warnings, places).run();
}

}  // namespace oktett
