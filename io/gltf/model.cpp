#include "io/gltf/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "io/gltf/tiny_model.h"
#include "io/mesh/reading.h"

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
    if (!(max_component(out_.emission) <= static_cast<float>(kMost))) fail("its emission is out of range");
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

namespace {

using tinygltf::Value;

/// Checks tinygltf's model and makes ours of it.
class GltfConversion {
 public:
  GltfConversion(const std::string& path, TinyModel tiny) : path_(path), in_(std::move(tiny.model)) {
    out_.buffers = std::move(tiny.buffers), out_.images = std::move(tiny.images);
    out_.warnings = std::move(tiny.warnings);
  }

  GltfModel run() {
    take_views();
    take_accessors();
    for (std::size_t i = 0; i < in_.materials.size(); ++i)
      out_.materials.push_back(gltf_material(path_, in_.materials[i], i, in_.textures.size(), out_.warnings));
    take_meshes();
    take_cameras();
    take_lights();
    take_nodes();
    take_textures();
    check_images();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(Location{path_}, what); }
  void warn(const std::string& what) { out_.warnings.push_back(what); }

  /// Throws Error unless `index`, which is -1 for none, is below `count`.
  std::uint32_t index(std::int64_t index, std::size_t count, const std::string& where, const char* what,
                      bool required = false) const {
    if (index == -1 && !required) return kNoId;
    if (index == -2) fail(where + ": the number of its " + what + " is missing");
    if (index < 0 || static_cast<std::uint64_t>(index) >= count)
      fail(where + ": there is no " + what + " " + std::to_string(index) + ": the file has " +
           std::to_string(count));
    return static_cast<std::uint32_t>(index);
  }

  /// A whole number of an extension; `standard` if it has none.
  std::int64_t whole(const Value& object, const char* key, std::int64_t standard) const {
    if (!object.IsObject()) return standard;
    const Value& value = object.Get(key);
    return value.IsInt() ? value.GetNumberAsInt() : standard;
  }

  void take_views() {
    for (std::size_t i = 0; i < in_.bufferViews.size(); ++i) {
      const tinygltf::BufferView& v = in_.bufferViews[i];
      const std::string where = gltf_place("bufferViews", i);
      GltfView& view = out_.views.emplace_back();
      view.range = {index(v.buffer, out_.buffers.size(), where, "buffer", true), v.byteOffset, v.byteLength};
      if (v.byteStride > 255)
        fail(where + ": a stride of " + std::to_string(v.byteStride) + " bytes is out of range");
      view.stride = static_cast<std::uint32_t>(v.byteStride);
      if (const auto packing = v.extensions.find(kGltfMeshopt); packing != v.extensions.end())
        view.packing = packing_of(packing->second, where);
    }
  }

  GltfPacking packing_of(const Value& object, const std::string& where) const {
    GltfPacking packing;
    const auto size = [&](const char* key, std::int64_t standard) {
      const std::int64_t value = whole(object, key, standard);
      if (value < 0) fail(where + ": expected '" + key + "' of " + kGltfMeshopt);
      return static_cast<std::uint64_t>(value);
    };
    packing.packed.buffer = index(whole(object, "buffer", -2), out_.buffers.size(), where, "buffer", true);
    packing.packed.offset = size("byteOffset", 0);
    packing.packed.length = size("byteLength", -1);
    packing.stride = static_cast<std::uint32_t>(size("byteStride", -1));
    packing.count = size("count", -1);
    const auto choose = [&](const char* key, std::initializer_list<std::string_view> words) {
      const Value& value = object.Get(key);
      const std::string word = value.IsString() ? value.Get<std::string>() : "NONE";
      const auto* const found = std::ranges::find(words, std::string_view(word));
      if (found == words.end())
        fail(where + ": unknown " + key + " " + quote_name(word) + " of " + kGltfMeshopt);
      return static_cast<std::uint8_t>(found - words.begin());
    };
    packing.mode = static_cast<GltfPacking::Mode>(choose("mode", {"ATTRIBUTES", "TRIANGLES", "INDICES"}));
    packing.filter = static_cast<GltfPacking::Filter>(
        choose("filter", {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"}));
    return packing;
  }

  GltfNumber number_type(int code, const std::string& where) const {
    for (const GltfNumber number : {GltfNumber::int8, GltfNumber::uint8, GltfNumber::int16,
                                    GltfNumber::uint16, GltfNumber::uint32, GltfNumber::float32})
      if (code == static_cast<int>(number)) return number;
    fail(where + ": unknown component type " + std::to_string(code));
  }

  void take_accessors() {
    for (std::size_t i = 0; i < in_.accessors.size(); ++i) {
      const tinygltf::Accessor& a = in_.accessors[i];
      const std::string where = gltf_place("accessors", i);
      GltfAccessor& accessor = out_.accessors.emplace_back();
      accessor.view = index(a.bufferView, out_.views.size(), where, "view");
      accessor.offset = a.byteOffset, accessor.count = a.count;
      accessor.number = number_type(a.componentType, where);
      const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
      accessor.components = static_cast<std::uint32_t>(std::max(components, 1));
      accessor.normalized = a.normalized;
      if (!a.sparse.isSparse) continue;
      GltfSparse sparse;
      if (a.sparse.count < 0 || a.sparse.indices.byteOffset < 0 || a.sparse.values.byteOffset < 0)
        fail(where + ": a negative number of sparse elements");
      sparse.count = static_cast<std::uint64_t>(a.sparse.count);
      sparse.index_view = index(a.sparse.indices.bufferView, out_.views.size(), where, "view", true);
      sparse.value_view = index(a.sparse.values.bufferView, out_.views.size(), where, "view", true);
      sparse.index_offset = static_cast<std::uint64_t>(a.sparse.indices.byteOffset);
      sparse.value_offset = static_cast<std::uint64_t>(a.sparse.values.byteOffset);
      sparse.index_number = number_type(a.sparse.indices.componentType, where);
      accessor.sparse = sparse;
    }
  }

  /// Calls find(name), which returns the number of an attribute or -1, for all that are read.
  template <class Find>
  static GltfAttributes attributes_of(const Find& find) {
    GltfAttributes attributes;
    attributes.positions = find("POSITION"), attributes.normals = find("NORMAL");
    for (std::size_t k = 0; k < kMostGltfUvs; ++k) attributes.uvs[k] = find("TEXCOORD_" + std::to_string(k));
    return attributes;
  }

  void take_meshes() {
    bool colours = false, targets = false;
    for (std::size_t i = 0; i < in_.meshes.size(); ++i) {
      const tinygltf::Mesh& m = in_.meshes[i];
      GltfMesh& mesh = out_.meshes.emplace_back();
      mesh.name = m.name;
      for (std::size_t k = 0; k < m.primitives.size(); ++k) {
        const tinygltf::Primitive& p = m.primitives[k];
        mesh.primitives.push_back(
            primitive_of(p, gltf_place("meshes", i) + "." + gltf_place("primitives", k)));
        colours = colours || p.attributes.contains("COLOR_0");
        targets = targets || !p.targets.empty();
      }
    }
    if (colours) warn("colours of vertices are not read");
    if (targets) warn("morph targets are not read: meshes are shown at rest");
  }

  GltfPrimitive primitive_of(const tinygltf::Primitive& p, const std::string& where) const {
    GltfPrimitive primitive;
    const std::size_t accessors = out_.accessors.size();
    primitive.mode = p.mode;
    if (p.mode < 0 || p.mode > GltfPrimitive::kFan) fail(where + ": unknown mode " + std::to_string(p.mode));
    primitive.material = index(p.material, in_.materials.size(), where, "material");
    primitive.attributes = attributes_of([&](const std::string& name) {
      const auto found = p.attributes.find(name);
      return index(found == p.attributes.end() ? -1 : found->second, accessors, where, "accessor");
    });
    primitive.indices = index(p.indices, accessors, where, "accessor");
    const auto draco = p.extensions.find(kGltfDraco);
    if (draco == p.extensions.end()) return primitive;
    const Value& object = draco->second;
    primitive.indices = index(whole(object, "indices", -1), accessors, where, "accessor");
    primitive.draco_view = index(whole(object, "bufferView", -2), out_.views.size(), where, "view", true);
    const Value& attributes = object.Get("attributes");
    primitive.draco_attributes = attributes_of([&](const std::string& name) {
      return index(whole(attributes, name.c_str(), -1), kNoId, where, "attribute");
    });
    return primitive;
  }

  void take_cameras() {
    for (std::size_t i = 0; i < in_.cameras.size(); ++i) {
      const tinygltf::Camera& c = in_.cameras[i];
      GltfCamera& camera = out_.cameras.emplace_back();
      camera.is_perspective = c.type == "perspective";
      if (!camera.is_perspective && c.type != "orthographic")
        fail(gltf_place("cameras", i) + ": unknown type " + quote_name(c.type));
      camera.yfov = c.perspective.yfov, camera.aspect = c.perspective.aspectRatio;
      camera.ymag = std::abs(c.orthographic.ymag);
      if (!camera.is_perspective && c.orthographic.ymag != 0)
        camera.aspect = std::abs(c.orthographic.xmag / c.orthographic.ymag);
      if (camera.is_perspective ? !(camera.yfov > 0 && camera.yfov < 3.14) : !(camera.ymag > 0))
        fail(gltf_place("cameras", i) + ": its field of view is out of range");
    }
  }

  void take_lights() {
    for (std::size_t i = 0; i < in_.lights.size(); ++i) {
      const tinygltf::Light& l = in_.lights[i];
      GltfLight& light = out_.lights.emplace_back();
      constexpr std::string_view kKinds[] = {"directional", "point", "spot"};
      const auto* const kind = std::ranges::find(kKinds, std::string_view(l.type));
      if (kind == std::end(kKinds)) fail(gltf_place("lights", i) + ": unknown type " + quote_name(l.type));
      light.kind = static_cast<GltfLight::Kind>(kind - std::begin(kKinds));
      if (!l.color.empty()) light.color = gltf_color(path_, gltf_place("lights", i), l.color, 1e30);
      light.intensity = l.intensity;
      light.inner_angle = l.spot.innerConeAngle, light.outer_angle = l.spot.outerConeAngle;
      const bool good_angles = light.inner_angle >= 0 && light.inner_angle <= light.outer_angle &&
                               light.outer_angle > 0 && light.outer_angle < 1.5708;
      if (!(l.intensity >= 0 && l.intensity <= 1e30) || (light.kind == GltfLight::Kind::spot && !good_angles))
        fail(gltf_place("lights", i) + ": its intensity or angles are out of range");
    }
  }

  void take_nodes() {
    const std::size_t count = in_.nodes.size();
    for (std::size_t i = 0; i < count; ++i) {
      const tinygltf::Node& n = in_.nodes[i];
      const std::string where = gltf_place("nodes", i);
      GltfNode& node = out_.nodes.emplace_back();
      node.name = n.name;
      node.to_parent = transform_of(n, where);
      node.mesh = index(n.mesh, out_.meshes.size(), where, "mesh");
      node.camera = index(n.camera, out_.cameras.size(), where, "camera");
      for (const int child : n.children) node.children.push_back(index(child, count, where, "node", true));
      if (const auto light = n.extensions.find(kGltfLights); light != n.extensions.end())
        node.light = index(whole(light->second, "light", -2), out_.lights.size(), where, "light", true);
    }
    if (in_.scenes.empty()) {
      // A library of things: all that is in no other is shown.
      std::vector<bool> is_child(count);
      for (const GltfNode& node : out_.nodes)
        for (const std::uint32_t child : node.children) is_child[child] = true;
      for (std::uint32_t i = 0; i < count; ++i)
        if (!is_child[i]) out_.roots.push_back(i);
      return;
    }
    const std::uint32_t shown =
        index(std::max(in_.defaultScene, 0), in_.scenes.size(), "scene", "scene", true);
    if (in_.scenes.size() > 1)
      warn("of " + std::to_string(in_.scenes.size()) + " scenes, number " + std::to_string(shown) +
           " is shown");
    for (const int root : in_.scenes[shown].nodes)
      out_.roots.push_back(index(root, count, gltf_place("scenes", shown), "node", true));
  }

  Affine transform_of(const tinygltf::Node& n, const std::string& where) const {
    const auto check = [&](const std::vector<double>& numbers, std::size_t size, const char* what) {
      if (!numbers.empty() && numbers.size() != size)
        fail(where + ": expected " + std::to_string(size) + " numbers in '" + what + "', found " +
             std::to_string(numbers.size()));
      return !numbers.empty();
    };
    Affine map;
    if (check(n.matrix, 16, "matrix")) {
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column) map.m[row][column] = n.matrix[4 * column + row];
      return map;
    }
    if (check(n.translation, 3, "translation"))
      map = Affine::translation({n.translation[0], n.translation[1], n.translation[2]});
    if (check(n.rotation, 4, "rotation"))
      map = map * rotation_of({n.rotation[0], n.rotation[1], n.rotation[2], n.rotation[3]}, where);
    if (check(n.scale, 3, "scale")) map = map * Affine::scaling({n.scale[0], n.scale[1], n.scale[2]});
    return map;
  }

  /// The rotation of a quaternion x, y, z, w.
  Affine rotation_of(const std::array<double, 4>& q, const std::string& where) const {
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(square > 0 && square < 1e60))
      fail(where + ": the quaternion of its rotation is zero or out of range");
    const auto twice = [&](std::size_t a, std::size_t b) { return 2 * (q[a] * q[b]) / square; };
    Affine map;
    map.m[0] = {1 - (twice(1, 1) + twice(2, 2)), twice(0, 1) - twice(2, 3), twice(0, 2) + twice(1, 3), 0};
    map.m[1] = {twice(0, 1) + twice(2, 3), 1 - (twice(0, 0) + twice(2, 2)), twice(1, 2) - twice(0, 3), 0};
    map.m[2] = {twice(0, 2) - twice(1, 3), twice(1, 2) + twice(0, 3), 1 - (twice(0, 0) + twice(1, 1)), 0};
    return map;
  }

  void take_textures() {
    for (std::size_t i = 0; i < in_.textures.size(); ++i) {
      const tinygltf::Texture& t = in_.textures[i];
      const std::string where = gltf_place("textures", i);
      GltfTexture& texture = out_.textures.emplace_back();
      std::int64_t image = t.source;
      if (const auto webp = t.extensions.find("EXT_texture_webp"); webp != t.extensions.end())
        image = whole(webp->second, "source", image);
      texture.image = index(image, out_.images.size(), where, "image");
      const std::uint32_t sampler = index(t.sampler, in_.samplers.size(), where, "sampler");
      if (sampler == kNoId) continue;
      const tinygltf::Sampler& s = in_.samplers[sampler];
      texture.clamp = s.wrapS == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE && s.wrapT == s.wrapS;
      if (!texture.clamp &&
          (s.wrapS != TINYGLTF_TEXTURE_WRAP_REPEAT || s.wrapT != TINYGLTF_TEXTURE_WRAP_REPEAT))
        warn(where +
             " repeats, although the file says otherwise: textures repeat or are clamped along both axes");
    }
  }

  void check_images() const {
    for (std::size_t i = 0; i < out_.images.size(); ++i)
      if (const std::uint32_t view = out_.images[i].view; view != kNoId)
        index(view, out_.views.size(), gltf_place("images", i), "view", true);
  }

  const std::string& path_;
  const tinygltf::Model in_;
  GltfModel out_;
};

}  // namespace

GltfModel parse_gltf(const std::string& path, const std::string& json, bool in_bytes) {
  return GltfConversion(path, parse_tiny_model(path, json, in_bytes)).run();
}

}  // namespace oktett
