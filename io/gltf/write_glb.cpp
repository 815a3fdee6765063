#include "io/gltf/gltf.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <ostream>
#include <set>
#include <streambuf>
#include <string>
#include <utility>
#include <vector>

#include "io/gltf/gltf_file.h"
#include "io/gltf/tiny_model.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"
#include "io/mesh/vertices.h"
#include "io/obj/write_obj.h"
#include "io/text/file_content.h"
#include "io/text/files.h"
#include "render/material.h"

namespace oktett {

// ---- Materials as glTF says them.

/// Adds materials to a model, and their images to its only buffer.
class GltfMaterialWriter {
 public:
  GltfMaterialWriter(tinygltf::Model& model, const MeshFile& file) : model_(model), file_(file) {}

  /// The index of the material in the model; -1 for one like that of triangles without a material.
  int add(const Material& material);
  /// Adds textures that glTF cannot show to `losses`.
  void note_losses(MeshLosses& losses) const;

 private:
  void set_base(const Material& m, tinygltf::Material& out);
  void set_emission(const Material& m, tinygltf::Material& out);
  void set_opacity(const Material& m, tinygltf::Material& out);
  void set_metal(const PrincipledMaterial& p, tinygltf::Material& out);
  void set_glass(const PrincipledMaterial& p, tinygltf::Material& out);
  void set_layers(const PrincipledMaterial& p, tinygltf::Material& out);

  bool is_plain(std::uint32_t texture, ImageChannel channel) const;
  int texture(std::uint32_t index);
  int image(const Texture& texture);
  tinygltf::Value::Object info(std::uint32_t index);
  template <class Info>
  void set(std::uint32_t index, Info& info);
  void extend(tinygltf::Material& out, const char* name, tinygltf::Value::Object values);

  tinygltf::Model& model_;
  const MeshFile& file_;
  std::set<std::uint32_t> written_;
  std::map<std::string, int> images_;  ///< by path; -1 for those that cannot be
};

namespace {

using tinygltf::Value;

double unit(float x) { return std::clamp(static_cast<double>(x), 0.0, 1.0); }

Value::Array numbers(const Color& c) {
  return {Value(static_cast<double>(c.x)), Value(static_cast<double>(c.y)), Value(static_cast<double>(c.z))};
}

std::string_view mime_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n")) return "image/png";
  return bytes.starts_with("\xff\xd8\xff") ? "image/jpeg" : "";
}

/// The transform of texture coordinates, whose v points down in glTF.
Value::Object transform_of(const Texture& t) {
  const double scale = t.scale.y;
  return {{"offset", Value(Value::Array{Value(double{t.offset.x}), Value(1 - scale - t.offset.y)})},
          {"scale", Value(Value::Array{Value(double{t.scale.x}), Value(scale)})}};
}

bool is_moved(const Texture& t) {
  return t.scale.x != 1 || t.scale.y != 1 || t.offset.x != 0 || t.offset.y != 0;
}

}  // namespace

/// Appends bytes to the only buffer of a model; the index of their view.
static int add_gltf_view(tinygltf::Model& model, const void* bytes, std::size_t size, int target) {
  std::vector<unsigned char>& data = model.buffers[0].data;
  data.resize((data.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0, view.byteOffset = data.size(), view.byteLength = size, view.target = target;
  const auto* first = static_cast<const unsigned char*>(bytes);
  data.insert(data.end(), first, first + size);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int GltfMaterialWriter::add(const Material& m) {
  if (m == Material{}) return -1;
  tinygltf::Material out;
  out.name = m.name;
  out.doubleSided = m.emits_behind;
  const PrincipledMaterial p = m.principled ? *m.principled : principled_like(m);
  set_base(m, out);
  set_emission(m, out);
  set_opacity(m, out);
  set_metal(p, out);
  set_glass(p, out);
  set_layers(p, out);
  set(m.normal_texture, out.normalTexture);
  model_.materials.push_back(std::move(out));
  return static_cast<int>(model_.materials.size()) - 1;
}

void GltfMaterialWriter::set_base(const Material& m, tinygltf::Material& out) {
  out.pbrMetallicRoughness.baseColorFactor = {unit(m.color.x), unit(m.color.y), unit(m.color.z), 1};
  set(m.color_texture, out.pbrMetallicRoughness.baseColorTexture);
}

void GltfMaterialWriter::set_emission(const Material& m, tinygltf::Material& out) {
  const float most = std::max(1.0f, max_component(m.emission));
  const Color factor = most > 1 ? m.emission * (1 / most) : m.emission;
  out.emissiveFactor = {unit(factor.x), unit(factor.y), unit(factor.z)};
  if (most > 1)
    extend(out, "KHR_materials_emissive_strength", {{"emissiveStrength", Value(static_cast<double>(most))}});
  set(m.emission_texture, out.emissiveTexture);
}

void GltfMaterialWriter::set_opacity(const Material& m, tinygltf::Material& out) {
  double& alpha = out.pbrMetallicRoughness.baseColorFactor[3];
  alpha = unit(m.opacity);
  if (m.opacity < 1) out.alphaMode = "BLEND";
  if (m.opacity_texture == kNoId || m.color_texture == kNoId) return;
  // glTF has one image for colour and opacity.
  const Texture &t = file_.textures[m.opacity_texture], &color = file_.textures[m.color_texture];
  if (t.channel != ImageChannel::alpha || t.path != color.path || t.content != color.content ||
      !written_.contains(m.color_texture))
    return;
  if (t.gain == 1 && t.base == 0) {
    out.alphaMode = "BLEND";
  } else if (t.gain >= 1 && t.gain <= kGltfMaskSlope) {
    out.alphaMode = "MASK";
    alpha = static_cast<double>(t.gain / kGltfMaskSlope);
    out.alphaCutoff = std::max(0.0, static_cast<double>((0.5f - t.base) / kGltfMaskSlope));
  } else {
    return;
  }
  written_.insert(m.opacity_texture);
}

void GltfMaterialWriter::set_metal(const PrincipledMaterial& p, tinygltf::Material& out) {
  tinygltf::PbrMetallicRoughness& pbr = out.pbrMetallicRoughness;
  pbr.metallicFactor = unit(p.parameters.metallic);
  pbr.roughnessFactor = unit(p.parameters.roughness);
  if (!is_plain(p.metallic_texture, ImageChannel::blue) ||
      !is_plain(p.roughness_texture, ImageChannel::green))
    return;
  // One image has both.
  Texture metal = file_.textures[p.metallic_texture];
  metal.channel = ImageChannel::green;
  if (!(metal == file_.textures[p.roughness_texture])) return;
  set(p.metallic_texture, pbr.metallicRoughnessTexture);
  if (written_.contains(p.metallic_texture)) written_.insert(p.roughness_texture);
}

void GltfMaterialWriter::set_glass(const PrincipledMaterial& p, tinygltf::Material& out) {
  if (p.parameters.ior != 1.5f)
    extend(out, "KHR_materials_ior", {{"ior", Value(static_cast<double>(p.parameters.ior))}});
  if (p.parameters.transmission > 0) {
    Value::Object glass{{"transmissionFactor", Value(unit(p.parameters.transmission))}};
    if (is_plain(p.transmission_texture, ImageChannel::red))
      glass.emplace("transmissionTexture", Value(info(p.transmission_texture)));
    extend(out, "KHR_materials_transmission", std::move(glass));
    if (!p.parameters.thin) extend(out, "KHR_materials_volume", {{"thicknessFactor", Value(1.0)}});
  }
}

void GltfMaterialWriter::set_layers(const PrincipledMaterial& p, tinygltf::Material& out) {
  const PrincipledParameters& n = p.parameters;
  if (n.specular != 0.5f || p.specular_texture != kNoId) {
    Value::Object specular{{"specularFactor", Value(unit(2 * n.specular))}};
    if (is_plain(p.specular_texture, ImageChannel::alpha))
      specular.emplace("specularTexture", Value(info(p.specular_texture)));
    extend(out, "KHR_materials_specular", std::move(specular));
  }
  if (n.coat > 0) {
    Value::Object coat{{"clearcoatFactor", Value(unit(n.coat))},
                       {"clearcoatRoughnessFactor", Value(unit(n.coat_roughness))}};
    if (is_plain(p.coat_texture, ImageChannel::red)) coat.emplace("clearcoatTexture", info(p.coat_texture));
    if (is_plain(p.coat_roughness_texture, ImageChannel::green))
      coat.emplace("clearcoatRoughnessTexture", info(p.coat_roughness_texture));
    extend(out, "KHR_materials_clearcoat", std::move(coat));
  }
  if (n.sheen > 0) {
    Value::Object sheen{{"sheenColorFactor", Value(numbers(n.sheen_color * n.sheen))},
                        {"sheenRoughnessFactor", Value(unit(n.sheen_roughness))}};
    if (is_plain(p.sheen_color_texture, ImageChannel::red))
      sheen.emplace("sheenColorTexture", info(p.sheen_color_texture));
    if (is_plain(p.sheen_roughness_texture, ImageChannel::alpha))
      sheen.emplace("sheenRoughnessTexture", info(p.sheen_roughness_texture));
    extend(out, "KHR_materials_sheen", std::move(sheen));
  }
}

/// Whether it is a texture whose numbers are those of the channel.
bool GltfMaterialWriter::is_plain(std::uint32_t index, ImageChannel channel) const {
  if (index == kNoId) return false;
  const Texture& t = file_.textures[index];
  return t.channel == channel && t.gain == 1 && t.base == 0;
}

/// The index of the texture in the model; -1 if it cannot be.
int GltfMaterialWriter::texture(std::uint32_t index) {
  const Texture& t = file_.textures[index];
  const int source = t.pattern || t.gain != 1 || t.base != 0 ? -1 : image(t);
  if (source < 0) return -1;
  written_.insert(index);
  tinygltf::Texture out;
  out.source = source;
  if (t.clamp) {
    if (model_.samplers.empty()) {
      model_.samplers.emplace_back();
      model_.samplers[0].wrapS = model_.samplers[0].wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }
    out.sampler = 0;
  }
  model_.textures.push_back(out);
  return static_cast<int>(model_.textures.size()) - 1;
}

/// The index of the texture's image in the model; -1 if it is neither PNG nor JPEG or cannot be read.
int GltfMaterialWriter::image(const Texture& t) {
  const auto [found, is_new] = images_.try_emplace(t.path, -1);
  if (!is_new) return found->second;
  std::string bytes;
  try {
    bytes = t.content ? *t.content : std::string(MappedFile(t.path).text());
  } catch (const Error&) {
    return -1;
  }
  const std::string_view type = mime_type(bytes);
  if (type.empty()) return -1;
  tinygltf::Image out;
  out.bufferView = add_gltf_view(model_, bytes.data(), bytes.size(), 0);
  out.mimeType = type;
  model_.images.push_back(std::move(out));
  return found->second = static_cast<int>(model_.images.size()) - 1;
}

template <class Info>
void GltfMaterialWriter::set(std::uint32_t index, Info& info) {
  if (index == kNoId) return;
  info.index = texture(index);
  const Texture& t = file_.textures[index];
  if (info.index < 0 || !is_moved(t)) return;
  info.extensions["KHR_texture_transform"] = Value(transform_of(t));
  model_.extensionsUsed.push_back("KHR_texture_transform");
}

Value::Object GltfMaterialWriter::info(std::uint32_t index) {
  tinygltf::TextureInfo made;
  set(index, made);
  Value::Object object{{"index", Value(made.index)}};
  if (!made.extensions.empty())
    object.emplace("extensions", Value(Value::Object(made.extensions.begin(), made.extensions.end())));
  return object;
}

void GltfMaterialWriter::extend(tinygltf::Material& out, const char* name, Value::Object values) {
  std::erase_if(values, [](const auto& entry) {
    return entry.second.IsObject() && entry.second.Has("index") &&
           entry.second.Get("index").GetNumberAsInt() < 0;
  });
  out.extensions[name] = Value(std::move(values));
  model_.extensionsUsed.push_back(name);
}

void GltfMaterialWriter::note_losses(MeshLosses& losses) const {
  note_lost_textures(file_.materials, written_, "glTF", losses);
}

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
      : path_(path), file_(file), mesh_(unify_vertices(file.mesh)), materials_(model_, file) {}

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
    return add_accessor(view, sizeof(T) == 12 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC2,
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
    if (!mesh_.normals.empty()) attributes_["NORMAL"] = add_floats(mesh_.normals);
    if (!mesh_.uvs.empty()) attributes_["TEXCOORD_0"] = add_floats(turned_uvs());
  }

  /// With v from the top.
  std::vector<Vec2f> turned_uvs() {
    std::vector<Vec2f> uvs = mesh_.uvs;
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
      primitive.attributes = attributes_;
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
      if (slot < file_.materials.size()) primitive.material = materials_.add(file_.materials[slot]);
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
    GltfScene read;
    add_gltf_materials(GltfFile(temporary), read);
    std::vector<std::string> changed;
    for (std::size_t i = 0; i < written_.size(); ++i) {
      const Material& m = file_.materials[written_[i]];
      if (i >= read.materials.size() || !is_same_material(read.materials[i], m)) changed.push_back(m.name);
    }
    note_changed(changed, "glTF", losses_);
  }

  const std::string& path_;
  const MeshFile& file_;
  const UnifiedMesh mesh_;
  tinygltf::Model model_;
  GltfMaterialWriter materials_;
  std::map<std::string, int> attributes_;
  std::vector<std::size_t> written_;  ///< the slots of the model's materials
  MeshLosses losses_;
};

}  // namespace

MeshLosses write_glb(const std::string& path, const MeshFile& file) { return GlbWriting(path, file).run(); }

}  // namespace oktett
