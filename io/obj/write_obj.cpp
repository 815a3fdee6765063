#include "io/obj/write_obj.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/color.h"
#include "io/image/color.h"
#include "io/mesh/reading.h"
#include "io/obj/colors.h"
#include "io/obj/obj.h"
#include "io/text/file_content.h"
#include "io/text/files.h"

namespace oktett {

namespace {

namespace fs = std::filesystem;

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

/// The end of the name of an image's file, by its first bytes.
const char* image_extension(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return ".png";
  return bytes.starts_with("RIFF") ? ".webp" : ".jpg";
}

/// Whether there is a file, and not with these bytes.
bool is_another(const fs::path& path, std::string_view bytes) {
  std::error_code error;
  if (!fs::exists(path, error)) return false;
  try {
    return MappedFile(path.string()).text() != bytes;
  } catch (const Error&) {
    return true;
  }
}

/// Numbers near `guess`, the nearest first, until reads(number) is `target`; `guess` if none is.
template <class F>
float find_number(float guess, float target, const F& reads) {
  float above = guess, below = guess;
  for (int i = 0; i < 64; ++i) {
    if (reads(above) == target) return above;
    if (reads(below) == target) return below;
    above = std::nextafter(above, INFINITY), below = std::nextafter(below, -INFINITY);
  }
  return guess;
}

class MtlWriting {
 public:
  MtlWriting(MeshOutput& out, const std::string& path, const MeshFile& file, MeshLosses& losses)
      : out_(out), path_(path), file_(file), losses_(losses) {}

  void run(const std::vector<std::string>& names) {
    out_.text("# Written by Oktett\n");
    for (std::size_t i = 0; i < names.size(); ++i) {
      out_.text("\nnewmtl ").text(names[i]).text("\n");
      write(file_.materials[i]);
    }
    out_.flush();
    note_losses(names);
  }

 private:
  void color(const char* key, const Color& c) { out_.text(key).text(" ").vector(c).text("\n"); }
  void number(const char* key, float x) { out_.text(key).text(" ").number(x).text("\n"); }

  void write(const Material& m) {
    write_diffuse(m);
    write_specular(m);
    if (glows(m)) color("Ke", m.emission);
    number("Ns", m.phong);
    number("Ni", m.ior);
    write_opacity(m);
    if (m.principled) {
      const PrincipledParameters& p = m.principled->parameters;
      number("Pr", p.roughness), number("Pm", p.metallic), number("Ps", p.sheen);
      number("Pc", p.coat), number("Pcr", p.coat_roughness);
    }
    write_textures(m);
  }

  /// The inverse of what load_mtl makes of Kd and Ka.
  void write_diffuse(const Material& m) {
    const Material standard;
    const float part = m.transparency > 0 ? 1 - m.transparency : 1;
    const bool is_standard = m.color == standard.color && m.diffuse == standard.diffuse * part;
    if (is_standard && m.color_texture == kNoId) {
      // What load_mtl takes if there is no Kd.
    } else if (m.principled || m.diffuse == part) {
      color("Kd", m.color);
    } else {
      color("Kd", m.color * (part > 0 ? m.diffuse / part : 1.0f));
    }
    if (m.ambient != standard.ambient) write_ambient(m.ambient, luminance(m.color));
  }

  /// d is what other programs know best.
  void write_opacity(const Material& m) {
    if (m.principled) {
      if (m.opacity != 1) number("d", m.opacity);
      const float t = m.principled->parameters.transmission;
      if (t > 0) color("Tf", {t, t, t});
    } else if (m.transparency > 0) {
      const float d = 1 - m.transparency;
      number(1 - d == m.transparency ? "d" : "Tr", 1 - d == m.transparency ? d : m.transparency);
      const Color passing = m.filter.value_or(m.color);
      if (!(passing == Color{1, 1, 1})) color("Tf", passing);
    } else if (m.opacity != 1) {
      number("d", m.opacity);
    }
  }

  /// A grey, but for the last bits of its blue, that is by this part as bright.
  void write_ambient(float part, float brightness) {
    float grey = 0, blue = 0;
    if (brightness > 0) {
      const auto ratio = [brightness](float x) { return std::clamp(x / brightness, 0.0f, 1.0f); };
      grey = find_number(part * brightness, part, ratio);
      blue = find_number(grey, grey, [grey](float b) { return luminance({grey, grey, b}); });
    }
    color("Ka", {grey, grey, blue});
  }

  void write_specular(const Material& m) {
    if (m.specular > 0)
      color("Ks", m.specular == 1 ? m.specular_color : m.specular_color * m.specular);
    else if (m.specular_texture != kNoId)
      color("Ks", {0, 0, 0});
    if (m.reflection > 0) number("illum", 3);
  }

  void write_textures(const Material& m) {
    constexpr auto kNone = std::nullopt;
    constexpr auto kNumber = ImageChannel::luminance;
    texture("map_Kd", m.color_texture, kNone);
    texture("map_Ks", m.specular_texture, kNone);
    texture("map_Ke", m.emission_texture, kNone);
    texture("map_d", m.opacity_texture, kNumber);
    texture("map_Bump", m.bump_texture, kNumber, m.bump_scale);
    texture("norm", m.normal_texture, kNone);
    // Blender takes normal maps from there alone; the others that know `norm` prefer it.
    if (m.bump_texture == kNoId) texture("map_Bump", m.normal_texture, kNone);
    if (!m.principled) return;
    texture("map_Pr", m.principled->roughness_texture, kNumber);
    texture("map_Pm", m.principled->metallic_texture, kNumber);
    texture("map_Ps", m.principled->sheen_texture, kNumber);
    texture("map_Pc", m.principled->coat_texture, kNumber);
    texture("map_Pcr", m.principled->coat_roughness_texture, kNumber);
  }

  /// `usual`: the channel that need not be named; nothing for colours, which have none.
  void texture(const char* key, std::uint32_t index, std::optional<ImageChannel> usual, float bump = 1) {
    if (index == kNoId) return;
    const Texture& t = file_.textures[index];
    if (t.pattern || !t.attribute.empty()) return;
    const std::string name = t.content ? embedded_name(t) : relative_name(t.path);
    if (name.empty()) return;
    written_.insert(index);
    out_.text(key);
    if (!(t.scale == Vec3f{1, 1, 1})) out_.text(" -s ").vector(t.scale);
    if (!(t.offset == Vec3f{0, 0, 0})) out_.text(" -o ").vector(t.offset);
    if (t.base != 0 || t.gain != 1) out_.text(" -mm ").number(t.base).text(" ").number(t.gain);
    if (bump != 1) out_.text(" -bm ").number(bump);
    if (t.lookup.u == TextureWrap::clamp && t.lookup.v == TextureWrap::clamp) out_.text(" -clamp on");
    constexpr const char* kChannels[] = {"r", "g", "b", "m", "l"};  // in the order of ImageChannel
    if (usual && t.channel != *usual)
      out_.text(" -imfchan ").text(kChannels[static_cast<std::size_t>(t.channel)]);
    // Most readers take the option for a part of the name, so it is written only where it changes something.
    if (t.color_space == TextureColors::linear) out_.text(" -colorspace linear");
    out_.text(" ").text(name).text("\n");
  }

  /// As seen from the folder of the MTL file; empty if MTL cannot say it.
  std::string relative_name(const std::string& path) const {
    const std::string name = path_beside(path_, path);
    if (name.empty() || name.back() == '\\' || name.back() == ' ' || std::ranges::any_of(name, is_control))
      return "";
    return name.front() == '-' || name.front() == ' ' ? "./" + name : name;
  }

  /// The name of the file to which the image of a texture goes, which is written at its first use.
  std::string embedded_name(const Texture& t) {
    std::string& name = images_[t.content.get()];
    if (!name.empty()) return name;
    const fs::path folder = fs::path(path_).parent_path();
    fs::path file;
    // Files that are there may be other textures.
    do {
      name = fs::path(path_).stem().string() + "-" + std::to_string(++image_number_) +
             image_extension(*t.content);
      file = folder / name;
    } while (is_another(file, *t.content));
    OutputFile image(file.string());
    image.write(*t.content);
    image.commit();
    losses_.push_back("changed: an image of a texture is written to '" + name + "'");
    return name;
  }

  void note_losses(const std::vector<std::string>& names) {
    note_lost_textures(file_.materials, written_, "MTL", losses_);
    note_changed_materials(names);
  }

  /// Reads the file again, because that shows best what is another material now.
  void note_changed_materials(const std::vector<std::string>& names) {
    std::vector<Material> read;
    std::vector<Texture> textures;
    std::vector<Warning> warnings;
    if (files_are_confined()) {
      losses_.push_back(kNotCompared);
      return;
    }
    load_mtl(out_.temporary(), read, textures, warnings);
    std::vector<std::string> changed;
    std::size_t renamed = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] != file_.materials[i].name) ++renamed;
      if (i >= read.size() || !is_same_material(read[i], file_.materials[i])) changed.push_back(names[i]);
    }
    note_changed(changed, "MTL", losses_);
    if (renamed > 0)
      losses_.push_back("changed: the " + std::string(renamed == 1 ? "name of " : "names of ") +
                        count_of(renamed, "material"));
  }

  MeshOutput& out_;
  const std::string& path_;
  const MeshFile& file_;
  MeshLosses& losses_;
  std::set<std::uint32_t> written_;                   ///< textures
  std::map<const std::string*, std::string> images_;  ///< names of files by their content
  int image_number_ = 0;
};

}  // namespace

/// Names for `newmtl` and `usemtl`: those of the materials without what would end them, none empty, none
/// twice.
static std::vector<std::string> mtl_names(const std::vector<Material>& materials) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& m : materials) {
    std::string name = m.name;
    for (char& c : name)
      if (is_control(c) || c == '\\' || c == '#') c = '_';
    while (name.starts_with(' ')) name.erase(0, 1);
    while (name.ends_with(' ')) name.pop_back();
    if (name.empty()) name = "material";
    const std::string stem = name;
    for (int i = 2; !taken.insert(name).second; ++i) name = stem + "_" + std::to_string(i);
    names.push_back(name);
  }
  return names;
}

/// Writes the materials of `file` under `names` to `out`, whose path is `path`. Adds what MTL cannot say to
/// `losses`.
static void write_mtl(MeshOutput& out, const std::string& path, const MeshFile& file,
                      const std::vector<std::string>& names, MeshLosses& losses) {
  MtlWriting(out, path, file, losses).run(names);
}

namespace {

namespace fs = std::filesystem;

/// The index of a corner, counted from 1; nothing where there is none.
void write_index(MeshOutput& out, const Column<std::uint32_t>& indices, std::size_t corner) {
  if (!indices.empty() && indices[corner] != kNoId) out.number(std::uint64_t{indices[corner]} + 1);
}

bool has_index(const Column<std::uint32_t>& indices, std::size_t corner) {
  return !indices.empty() && indices[corner] != kNoId;
}

void write_faces(MeshOutput& out, const TriangleMesh& mesh, const std::vector<std::string>& names) {
  std::uint32_t shown = kNoId;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const std::uint32_t slot = mesh.material_slots.empty() ? 0 : mesh.material_slots[i];
    if (slot != shown && slot < names.size()) out.text("usemtl ").text(names[slot]).text("\n");
    shown = slot;
    out.text("f");
    for (std::size_t corner = 3 * i; corner < 3 * i + 3; ++corner) {
      out.text(" ").number(std::uint64_t{mesh.indices[corner]} + 1);
      const bool has_normal = has_index(mesh.normal_indices, corner);
      if (has_normal || has_index(mesh.uv_indices, corner)) out.text("/");
      write_index(out, mesh.uv_indices, corner);
      if (has_normal) out.text("/");
      write_index(out, mesh.normal_indices, corner);
    }
    out.text("\n");
  }
}

/// The number that the reader takes for `linear`, if there is one.
float encoded(float linear) {
  if (!(linear > 0)) return 0;
  const float most = std::numeric_limits<float>::max();
  return find_number(linear_to_srgb(std::min(linear, most)), linear, linear_of_obj_color);
}

/// The colours of vertices, if there are some: OBJ can say no others.
const MeshAttribute* obj_colors(const TriangleMesh& mesh) {
  const MeshAttribute* const color = find_attribute(mesh, kColorAttribute);
  const bool said = color != nullptr && color->domain == AttributeDomain::vertex && color->components >= 3;
  return said ? color : nullptr;
}

/// The colour of vertex `i` as the reader expects it: encoded by the sRGB curve.
void write_color(MeshOutput& out, const MeshAttribute& color, std::size_t i) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    out.text(" ");
    const std::size_t at = i * color.components + k;
    if (color.floats.empty())
      out.number(static_cast<float>(color.srgb[at]) / 255);
    else
      out.number(encoded(color.floats[at]));
  }
}

void note_colors(const MeshAttribute& color, MeshLosses& losses) {
  if (color.components == 4) losses.push_back("lost: alpha of vertices");
  std::size_t changed = 0;
  for (std::size_t i = 0; i < color.floats.size(); ++i)
    if (i % color.components < 3 && linear_of_obj_color(encoded(color.floats[i])) != color.floats[i])
      ++changed;
  if (changed > 0)
    losses.push_back("changed: " + count_of(changed, "number") +
                     " of colours, which OBJ encodes by the sRGB curve and rounds");
}

void write_mesh(MeshOutput& out, const TriangleMesh& mesh, const std::vector<std::string>& names) {
  const MeshAttribute* const color = obj_colors(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    out.text("v ").position(mesh, mesh.positions[i]);
    if (color != nullptr) write_color(out, *color, i);
    out.text("\n");
  }
  if (!mesh.uv_indices.empty())
    for (const Vec2f& uv : mesh.uvs) out.text("vt ").number(uv.x).text(" ").number(uv.y).text("\n");
  if (!mesh.normal_indices.empty())
    for (const Vec3f& n : mesh.normals) out.text("vn ").vector(n).text("\n");
  write_faces(out, mesh, names);
}

}  // namespace

MeshLosses write_obj(const std::string& path, const MeshFile& file) {
  MeshLosses losses;
  MeshOutput out(path);
  out.text("# Written by Oktett\n");
  std::optional<MeshOutput> library;
  const std::vector<std::string> names = mtl_names(file.materials);
  if (!names.empty()) {
    const std::string library_path = fs::path(path).replace_extension(".mtl").string();
    library.emplace(library_path);
    write_mtl(*library, library_path, file, names, losses);
    out.text("mtllib ").text(fs::path(library_path).filename().string()).text("\n");
  }
  write_mesh(out, file.mesh, names);
  const MeshAttribute* const color = obj_colors(file.mesh);
  note_lost_attributes(
      file.mesh, [&](const MeshAttribute& a) { return &a == color; }, losses);
  if (color != nullptr) note_colors(*color, losses);
  out.flush();
  // Behind all that takes much space, so that seldom one file is new and the other is not.
  if (library) library->commit();
  out.commit();
  return losses;
}

}  // namespace oktett
