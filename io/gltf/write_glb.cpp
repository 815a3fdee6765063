#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <streambuf>
#include <string>
#include <utility>
#include <vector>

#include "core/vec3.h"
#include "io/gltf/glb_materials.h"
#include "io/gltf/gltf.h"
#include "io/gltf/gltf_file.h"
#include "io/mesh/reading.h"
#include "io/mesh/vertices.h"
#include "io/obj/write_obj.h"
#include "io/text/files.h"

namespace oktett {
namespace {

/// Hands what tinygltf writes to a file.
class OutputBuffer : public std::streambuf {
 public:
  explicit OutputBuffer(OutputFile& file) : file_(file) {}

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    file_.write({bytes, static_cast<std::size_t>(size)});
    return size;
  }
  int_type overflow(int_type c) override {
    const char byte = static_cast<char>(c);
    file_.write({&byte, 1});
    return c;
  }

  OutputFile& file_;
};

class GlbWriting {
 public:
  GlbWriting(const std::string& path, const MeshFile& file)
      : path_(path), file_(file), mesh_(unify_vertices(mended(file.mesh))), materials_(model_, file) {}

  MeshLosses run() {
    OutputFile out(path_);
    model_.asset.version = "2.0", model_.asset.generator = "Oktett";
    model_.buffers.emplace_back();
    add_vertices();
    add_primitives();
    add_node();
    std::ranges::sort(model_.extensionsUsed);
    model_.extensionsUsed.erase(std::unique(model_.extensionsUsed.begin(), model_.extensionsUsed.end()),
                                model_.extensionsUsed.end());
    write(out);
    mesh_.note_changes(file_.mesh.positions.size(), losses_);
    materials_.note_losses(losses_);
    note_changed_materials(out.temporary());
    out.commit();
    return std::move(losses_);
  }

 private:
  /// The mesh, whose triangles have no normals where one of theirs is none.
  const TriangleMesh& mended(const TriangleMesh& mesh) {
    std::vector<bool> is_bad(mesh.normals.size());
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
      is_bad[i] = !is_finite(mesh.normals[i]) || mesh.normals[i] == Vec3f{0, 0, 0};
    std::size_t bad = 0;
    for (const std::uint32_t index : mesh.normal_indices) bad += index != kNoId && is_bad[index] ? 1 : 0;
    if (bad == 0) return mesh;
    losses_.push_back("changed: " + count_of(bad, "corner") +
                      " whose normal is zero or not finite; their triangles get flat ones");
    mended_ = mesh;
    for (std::uint32_t& index : mended_.normal_indices)
      if (index != kNoId && is_bad[index]) index = kNoId;
    return mended_;
  }

  /// Unit vectors; those of triangles without an area are any.
  std::vector<Vec3f> unit_normals() {
    std::vector<Vec3f> normals = mesh_.normals;
    std::size_t changed = 0;
    for (Vec3f& n : normals) {
      const Vec3d exact(n);
      const double size = length(exact);
      if (std::abs(size - 1) <= kAlmostUnit) continue;
      if (size > 0) ++changed;
      n = size > 0 ? Vec3f(exact / size) : Vec3f{0, 0, 1};
    }
    if (changed > 0)
      losses_.push_back("changed: " + count_of(changed, "normal") + ", which glTF has at unit length");
    return normals;
  }

  int add_accessor(int view, int type, int number, std::size_t count) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view, accessor.type = type, accessor.componentType = number, accessor.count = count;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }
  template <class T>
  int add_floats(const std::vector<T>& values) {
    const int view =
        add_gltf_view(model_, values.data(), values.size() * sizeof(T), TINYGLTF_TARGET_ARRAY_BUFFER);
    return add_accessor(view,
                        sizeof(T) == 16   ? TINYGLTF_TYPE_VEC4
                        : sizeof(T) == 12 ? TINYGLTF_TYPE_VEC3
                                          : TINYGLTF_TYPE_VEC2,
                        TINYGLTF_COMPONENT_TYPE_FLOAT, values.size());
  }

  void add_vertices() {
    attributes_["POSITION"] = add_floats(mesh_.positions);
    constexpr double kMost = std::numeric_limits<double>::max();
    std::vector<double> lo(3, kMost), hi(3, -kMost);
    for (const Vec3f& p : mesh_.positions)
      for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        lo[i] = std::min(lo[i], static_cast<double>(p[k])),
        hi[i] = std::max(hi[i], static_cast<double>(p[k]));
      }
    model_.accessors.back().minValues = lo, model_.accessors.back().maxValues = hi;
    if (!mesh_.normals.empty()) attributes_["NORMAL"] = add_floats(unit_normals());
    if (!mesh_.tangents.empty()) add_tangents();
    if (!mesh_.uvs.empty()) attributes_["TEXCOORD_0"] = add_floats(turned_uvs(mesh_.uvs));
    if (!mesh_.second_uvs.empty()) attributes_["TEXCOORD_1"] = add_floats(turned_uvs(mesh_.second_uvs));
    // The sets of colours are numbered without gaps.
    std::vector<const MeshAttribute*> colors;
    while (const MeshAttribute* const next = color_set(colors.size())) colors.push_back(next);
    for (const MeshAttribute& a : mesh_.attributes) {
      const auto set = static_cast<std::size_t>(std::ranges::find(colors, &a) - colors.begin());
      add_attribute(a, set < colors.size() ? "COLOR_" + std::to_string(set) : own_name(a.name));
    }
  }

  /// The attribute that is a set of colours as glTF has them, from 0 to 1; or null.
  const MeshAttribute* color_set(std::size_t number) const {
    const std::string name = number == 0 ? kColorAttribute : kColorAttribute + ("_" + std::to_string(number));
    const auto found = std::ranges::find(mesh_.attributes, name, &MeshAttribute::name);
    if (found == mesh_.attributes.end() || found->components < 3) return nullptr;
    for (std::size_t i = 0; i < found->size(); ++i)
      for (std::uint32_t k = 0; k < found->components; ++k)
        if (const float x = found->value(i, k); x < 0 || (x > 1 && std::isfinite(x))) return nullptr;
    return &*found;
  }

  /// With an underscore before it, as glTF has what it knows nothing of.
  std::string own_name(const std::string& name) {
    std::string own = "_" + name;
    for (char& c : own)
      if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) >= 0x7f) c = '_';
    const std::string wanted = own;
    for (int i = 2; attributes_.contains(own) || own == "_"; ++i) own = wanted + "_" + std::to_string(i);
    if (own.substr(1) != name)
      losses_.push_back("changed: the name of the attribute " + quote_name(name) + ", which is " +
                        quote_name(own.substr(1)) + " now");
    return own;
  }

  void add_attribute(const MeshAttribute& a, const std::string& name) {
    std::vector<float> numbers;
    numbers.reserve(a.size() * a.components);
    std::size_t bad = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::uint32_t k = 0; k < a.components; ++k) {
        const float x = a.value(i, k);
        if (!std::isfinite(x)) ++bad;
        numbers.push_back(std::isfinite(x) ? x : 0);
      }
    if (bad > 0)
      losses_.push_back("changed: " + count_of(bad, "number") + " of the attribute " + quote_name(a.name) +
                        " that are not finite become 0");
    if (a.name == kColorAttribute && name != "COLOR_0")
      losses_.push_back(
          "changed: colours, which glTF has as three or four parts from 0 to 1; others do not show them");
    constexpr int kTypes[] = {TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3,
                              TINYGLTF_TYPE_VEC4};
    const int view =
        add_gltf_view(model_, numbers.data(), numbers.size() * sizeof(float), TINYGLTF_TARGET_ARRAY_BUFFER);
    attributes_[name] = add_accessor(view, kTypes[a.components - 1], TINYGLTF_COMPONENT_TYPE_FLOAT, a.size());
  }

  /// Those of the triangles of a slot: where an image is shown without the colours, these only stand beside
  /// it.
  std::map<std::string, int> attributes_of(std::size_t slot) const {
    if (slot >= file_.materials.size()) return attributes_;
    const Material& m = file_.materials[slot];
    if (m.color_texture == kNoId || m.tint_texture != kNoId) return attributes_;
    std::map<std::string, int> own;
    for (const auto& [name, accessor] : attributes_)
      own[name.starts_with("COLOR_") ? name == "COLOR_0" ? "_color" : "_color" + name.substr(5) : name] =
          accessor;
    return own;
  }

  /// Unit vectors and 1 or -1. glTF has tangents for all vertices or for none.
  void add_tangents() {
    std::vector<std::array<float, 4>> tangents = mesh_.tangents;
    for (std::array<float, 4>& t : tangents) {
      const Vec3d along{t[0], t[1], t[2]};
      const double size = length(along);
      if (!(size > 0)) {
        losses_.push_back("lost: tangents, which some of the triangles do not have");
        return;
      }
      for (std::size_t k = 0; k < 3; ++k) t[k] = static_cast<float>(along[static_cast<int>(k)] / size);
      t[3] = t[3] < 0 ? -1.0f : 1.0f;
    }
    attributes_["TANGENT"] = add_floats(tangents);
  }

  /// With v from the top.
  std::vector<Vec2f> turned_uvs(std::vector<Vec2f> uvs) {
    std::size_t rounded = 0;
    for (Vec2f& uv : uvs) {
      const float v = uv.y;
      uv.y = 1 - v;
      if (1 - uv.y != v) ++rounded;
    }
    if (rounded > 0)
      losses_.push_back("lost: precision of " + count_of(rounded, "texture coordinate") +
                        ", because glTF counts v from the top");
    return uvs;
  }

  /// One for each slot, because a primitive has one material.
  void add_primitives() {
    const Column<std::uint16_t>& slots = file_.mesh.material_slots;
    std::size_t count = 1;
    for (const std::uint16_t slot : slots) count = std::max(count, std::size_t{slot} + 1);
    std::vector<std::vector<std::uint32_t>> corners(count);
    for (std::size_t i = 0; i < mesh_.indices.size(); ++i)
      corners[slots.empty() ? 0 : slots[i / 3]].push_back(mesh_.indices[i]);
    if (!std::is_sorted(slots.begin(), slots.end()))
      losses_.push_back("changed: the order of triangles, which glTF has by material");
    tinygltf::Mesh mesh;
    for (std::size_t slot = 0; slot < count; ++slot) {
      if (corners[slot].empty()) continue;
      tinygltf::Primitive primitive;
      primitive.attributes = attributes_of(slot);
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
      if (slot < file_.materials.size()) primitive.material = materials_.add(slot);
      if (primitive.material >= 0) written_.push_back(slot);
      const std::vector<std::uint32_t>& own = corners[slot];
      const int view =
          add_gltf_view(model_, own.data(), own.size() * sizeof own[0], TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
      primitive.indices =
          add_accessor(view, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, own.size());
      mesh.primitives.push_back(primitive);
    }
    model_.meshes.push_back(std::move(mesh));
  }

  void add_node() {
    tinygltf::Node node;
    node.mesh = 0;
    const Vec3d& origin = mesh_.origin;
    if (!(origin == Vec3d{})) node.translation = {origin.x, origin.y, origin.z};
    model_.nodes.push_back(node);
    tinygltf::Scene scene;
    scene.nodes = {0};
    model_.scenes.push_back(scene);
    model_.defaultScene = 0;
  }

  void write(OutputFile& out) {
    // A margin for the JSON beside the bytes.
    if (model_.buffers[0].data.size() > std::numeric_limits<std::uint32_t>::max() - (std::size_t{64} << 20))
      throw Error(Location{path_}, "cannot write: a GLB file has at most 4 GB");
    OutputBuffer buffer(out);
    std::ostream stream(&buffer);
    // So that errors of the file come through.
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, false, true))
      throw Error(Location{path_}, "cannot write", ErrorKind::io);
    model_ = {};
  }

  /// Reads the materials again, because that shows best what is another one now.
  void note_changed_materials(const std::string& temporary) {
    if (written_.empty()) return;
    if (files_are_confined()) {
      losses_.push_back(kNotCompared);
      return;
    }
    FileScene read;
    add_gltf_materials(GltfFile(temporary), read);
    std::vector<std::string> changed;
    for (std::size_t i = 0; i < written_.size(); ++i) {
      const Material& m = file_.materials[written_[i]];
      if (i >= read.materials.size() || !is_same_material(read.materials[i], m)) changed.push_back(m.name);
    }
    note_changed(changed, "glTF", losses_);
  }

  static constexpr double kAlmostUnit = 1e-6;

  const std::string& path_;
  const MeshFile& file_;
  MeshLosses losses_;
  TriangleMesh mended_;
  const UnifiedMesh mesh_;
  tinygltf::Model model_;
  GltfMaterialWriter materials_;
  std::map<std::string, int> attributes_;
  std::vector<std::size_t> written_;  ///< the slots of the model's materials
};

}  // namespace

MeshLosses write_glb(const std::string& path, const MeshFile& file) { return GlbWriting(path, file).run(); }

}  // namespace oktett
