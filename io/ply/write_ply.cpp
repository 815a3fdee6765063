#include "io/ply/ply.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/image/color.h"
#include "io/mesh/vertices.h"
#include "io/ply/attributes.h"
#include "io/text/files.h"

namespace oktett {
namespace {

/// The images that a header can name, one for each slot of the mesh that has one.
class PlyImages {
 public:
  PlyImages(const std::string& path, const MeshFile& file) : slots_(file.mesh.material_slots) {
    for (const Material& m : file.materials) numbers_.push_back(add(path, file, m));
    if (names_.empty() || file.mesh.uv_indices.empty()) names_.clear(), numbers_.clear();
  }

  const std::vector<std::string>& names() const { return names_; }
  const std::set<std::uint32_t>& written() const { return written_; }
  bool has_numbers() const { return !names_.empty() && !slots_.empty(); }
  /// -1 for none.
  std::int32_t number(std::size_t triangle) const { return numbers_[slots_[triangle]]; }

 private:
  std::int32_t add(const std::string& path, const MeshFile& file, const Material& m) {
    if (m.color_texture == kNoId) return -1;
    const Texture& t = file.textures[m.color_texture];
    const Texture plain{.path = t.path};
    if (t.path.empty() || !(t == plain) || file.mesh.uv_indices.empty()) return -1;
    const std::string name = path_beside(path, t.path);
    const bool is_word_like = std::ranges::none_of(name, [](char c) { return c == '\n' || c == '\r'; });
    if (name.empty() || !is_word_like || name.front() == ' ' || name.back() == ' ') return -1;
    names_.push_back(name);
    written_.insert(m.color_texture);
    return static_cast<std::int32_t>(names_.size() - 1);
  }

  const Column<std::uint16_t>& slots_;
  std::vector<std::string> names_;
  std::vector<std::int32_t> numbers_;  ///< per slot
  std::set<std::uint32_t> written_;
};

class PlyWriting {
 public:
  PlyWriting(const std::string& path, const UnifiedMesh& mesh, const PlyImages& images, bool ascii)
      : out_(path), mesh_(mesh), images_(images), ascii_(ascii) {}

  void run() {
    for (const MeshAttribute& a : mesh_.attributes) forms_.push_back({is_color(a), needs_floats(a)});
    write_header();
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) write_vertex(i);
    for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) write_face(&mesh_.indices[i]);
    out_.commit();
  }

 private:
  void write_header() {
    out_.text("ply\nformat ").text(ascii_ ? "ascii" : "binary_little_endian").text(" 1.0\n");
    out_.text("comment Written by Oktett\n");
    for (const std::string& name : images_.names()) out_.text("comment TextureFile ").text(name).text("\n");
    out_.text("element vertex ").number(mesh_.positions.size()).text("\n");
    const auto properties = [&](std::initializer_list<const char*> names) {
      for (const char* name : names) out_.text("property float ").text(name).text("\n");
    };
    if (is_far())
      for (const char* name : {"x", "y", "z"}) out_.text("property double ").text(name).text("\n");
    else
      properties({"x", "y", "z"});
    if (!mesh_.normals.empty()) properties({"nx", "ny", "nz"});
    if (!mesh_.uvs.empty()) properties({"s", "t"});
    describe(AttributeDomain::vertex);
    out_.text("element face ").number(mesh_.indices.size() / 3).text("\nproperty list uchar ");
    // Most readers know int here, and some nothing else.
    const bool is_small = mesh_.positions.size() <= std::numeric_limits<std::int32_t>::max();
    out_.text(is_small ? "int" : "uint").text(" vertex_indices\n");
    describe(AttributeDomain::face);
    if (images_.has_numbers()) out_.text("property int texnumber\n");
    out_.text("end_header\n");
  }

  void describe(AttributeDomain domain) {
    for (std::size_t n = 0; n < mesh_.attributes.size(); ++n) {
      const MeshAttribute& a = mesh_.attributes[n];
      if (a.domain != domain) continue;
      constexpr const char* kColors[] = {"red", "green", "blue", "alpha"};
      if (forms_[n].as_bytes)
        for (std::uint32_t k = 0; k < a.components; ++k)
          out_.text("property uchar ").text(kColors[k]).text("\n");
      if (!forms_[n].as_floats) continue;
      for (std::uint32_t k = 0; k < a.components; ++k) {
        out_.text("property float ").text(property_name(a));
        if (a.components > 1) out_.text(std::string(1, kPlyComponents.front()) + std::to_string(k));
        out_.text("\n");
      }
    }
  }

  /// Whether readers find the attribute by the names of colours. Most of them know bytes there alone.
  bool is_color(const MeshAttribute& a) const { return a.components >= 3 && own_name(a) == kColorAttribute; }

  /// Whether bytes would round the attribute, or it is no colour.
  bool needs_floats(const MeshAttribute& a) const {
    if (!is_color(a)) return true;
    for (std::size_t i = 0; i < a.floats.size(); ++i) {
      const auto k = static_cast<std::uint32_t>(i % a.components);
      const std::uint8_t byte = byte_of(a.floats[i], k);
      if ((k < 3 ? linear_of_srgb_byte(byte) : static_cast<float>(byte) / 255) != a.floats[i]) return true;
    }
    return false;
  }

  static std::uint8_t byte_of(float x, std::uint32_t component) {
    return component < 3 ? linear_to_srgb8(x)
                         : static_cast<std::uint8_t>(x > 0 ? std::min(x * 255 + 0.5f, 255.0f) : 0);
  }

  /// Without what tells a face's from a vertex's of the same name.
  std::string_view own_name(const MeshAttribute& a) const {
    std::string_view name = a.name;
    if (a.domain == AttributeDomain::face && name.starts_with("face_") &&
        std::ranges::any_of(mesh_.attributes, [&](const MeshAttribute& other) {
          return other.domain == AttributeDomain::vertex && other.name == name.substr(5);
        }))
      name.remove_prefix(5);
    return name;
  }

  /// Names are words in headers.
  std::string property_name(const MeshAttribute& a) const {
    std::string name(own_name(a));
    for (char& c : name)
      if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
    return name;
  }

  void write_attributes(AttributeDomain domain, std::size_t i) {
    for (std::size_t n = 0; n < mesh_.attributes.size(); ++n) {
      const MeshAttribute& a = mesh_.attributes[n];
      if (a.domain != domain) continue;
      if (forms_[n].as_bytes)
        for (std::uint32_t k = 0; k < a.components; ++k)
          write(a.floats.empty() ? a.srgb[i * a.components + k] : byte_of(a.value(i, k), k));
      if (forms_[n].as_floats)
        for (std::uint32_t k = 0; k < a.components; ++k) write(a.value(i, k));
    }
  }

  bool is_far() const { return !(mesh_.origin == Vec3d{}); }

  template <class T>
  void write(const T& value) {
    if (!ascii_)
      out_.bytes(value);
    else
      out_.text(is_first_ ? "" : " ").number(value);
    is_first_ = false;
  }
  void end_record() {
    if (ascii_) out_.text("\n");
    is_first_ = true;
  }

  void write_vertex(std::size_t i) {
    const auto vector = [this](const Vec3f& v) { write(v.x), write(v.y), write(v.z); };
    if (is_far())
      for (int k = 0; k < 3; ++k) write(mesh_.origin[k] + static_cast<double>(mesh_.positions[i][k]));
    else
      vector(mesh_.positions[i]);
    if (!mesh_.normals.empty()) vector(mesh_.normals[i]);
    if (!mesh_.uvs.empty()) write(mesh_.uvs[i].x), write(mesh_.uvs[i].y);
    write_attributes(AttributeDomain::vertex, i);
    end_record();
  }
  void write_face(const std::uint32_t* corners) {
    write(std::uint8_t{3});
    for (int k = 0; k < 3; ++k) write(corners[k]);
    const auto triangle = static_cast<std::size_t>(corners - mesh_.indices.data()) / 3;
    write_attributes(AttributeDomain::face, triangle);
    if (images_.has_numbers()) write(images_.number(triangle));
    end_record();
  }

  MeshOutput out_;
  const UnifiedMesh& mesh_;
  const PlyImages& images_;
  const bool ascii_;
  struct Form {
    bool as_bytes, as_floats;
  };
  std::vector<Form> forms_;  ///< of each attribute
  bool is_first_ = true;     ///< of a record
};

}  // namespace

/// All that materials are beside an image.
static void note_lost_materials(const MeshFile& file, const PlyImages& images, MeshLosses& losses) {
  std::size_t lost = 0;
  for (const Material& m : file.materials) {
    const bool written = images.written().contains(m.color_texture);
    if (!(m == image_material(m.name, written ? m.color_texture : kNoId))) ++lost;
  }
  if (lost > 0) losses.push_back("lost: " + count_of(lost, "material"));
  const std::size_t textures = file.textures.size() - images.written().size();
  if (textures > 0) losses.push_back("lost: " + count_of(textures, "texture"));
}

MeshLosses write_ply(const std::string& path, const MeshFile& file, bool ascii) {
  const UnifiedMesh mesh = unify_vertices(file.mesh, true);
  const PlyImages images(path, file);
  PlyWriting(path, mesh, images, ascii).run();
  MeshLosses losses;
  note_lost_materials(file, images, losses);
  mesh.note_changes(file.mesh.positions.size(), losses);
  return losses;
}

}  // namespace oktett
