#include "io/gltf/model.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "io/gltf/json.h"
#include "io/mesh/reading.h"

namespace oktett {

std::uint32_t checked_index(const std::string& path, std::uint64_t index, std::size_t count,
                            const std::string& where, const char* what) {
  if (index >= count)
    throw Error(Location{path}, where + ": there is no " + what + " " + std::to_string(index) +
                                    ": the file has " + std::to_string(count));
  return static_cast<std::uint32_t>(index);
}

std::uint32_t index_of(const std::string& path, const GltfJson& object, const char* key, std::size_t count,
                       const std::string& where, const char* what) {
  const GltfJson* const value = member(object, key);
  return value == nullptr ? kNoId : checked_index(path, value->get<std::uint64_t>(), count, where, what);
}

Affine GltfPlace::transform() const {
  const std::array<double, 4>& q = rotation;
  Affine map = Affine::translation(translation);
  if (q[0] != 0 || q[1] != 0 || q[2] != 0) {
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const auto twice = [&](std::size_t a, std::size_t b) { return 2 * (q[a] * q[b]) / square; };
    Affine turn;
    turn.m[0] = {1 - (twice(1, 1) + twice(2, 2)), twice(0, 1) - twice(2, 3), twice(0, 2) + twice(1, 3), 0};
    turn.m[1] = {twice(0, 1) + twice(2, 3), 1 - (twice(0, 0) + twice(2, 2)), twice(1, 2) - twice(0, 3), 0};
    turn.m[2] = {twice(0, 2) - twice(1, 3), twice(1, 2) + twice(0, 3), 1 - (twice(0, 0) + twice(1, 1)), 0};
    map = map * turn;
  }
  return scale == Vec3d{1, 1, 1} ? map : map * Affine::scaling(scale);
}

namespace {

/// How many numbers an element of a type has; 0: there is no such type.
std::uint32_t components_of(const std::string& type) {
  constexpr std::pair<std::string_view, std::uint32_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, count] : kTypes)
    if (type == name) return count;
  return 0;
}

TextureWrap wrap_of(std::uint64_t code) {
  constexpr std::uint64_t kClamped = 33071, kMirrored = 33648;
  return code == kClamped    ? TextureWrap::clamp
         : code == kMirrored ? TextureWrap::mirror
                             : TextureWrap::repeat;
}

/// Checks what a file says and makes the model of it.
class GltfConversion {
 public:
  GltfConversion(const std::string& path, const GltfJson& root) : path_(path), in_(root) {}

  GltfModel run() {
    take_sources("buffers", out_.buffers);
    take_sources("images", out_.images);
    take_views();
    take_accessors();
    const std::size_t textures = list_of(in_, "textures").size();
    for (const GltfJson& material : list_of(in_, "materials"))
      out_.materials.push_back(
          gltf_material(path_, material, out_.materials.size(), textures, out_.warnings));
    take_variants();
    take_meshes();
    take_cameras();
    take_lights();
    take_nodes();
    take_textures();
    for (std::size_t i = 0; i < out_.images.size(); ++i)
      if (const std::uint32_t view = out_.images[i].view; view != kNoId)
        checked_index(path_, view, out_.views.size(), gltf_place("images", i), "view");
    take_skins();
    take_animations();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(Location{path_}, what); }
  void warn(const std::string& what) { out_.warnings.push_back(what); }

  std::uint32_t index(const GltfJson& object, const char* key, std::size_t count, const std::string& where,
                      const char* what) const {
    return index_of(path_, object, key, count, where, what);
  }

  void take_sources(const char* key, std::vector<GltfSource>& sources) {
    for (const GltfJson& item : list_of(in_, key)) {
      GltfSource& source = sources.emplace_back();
      source.uri = text_of(item, "uri");
      if (source.uri.starts_with(kGltfDataUri)) {
        const char* const end = source.uri.data() + source.uri.size();
        std::from_chars(source.uri.data() + kGltfDataUri.size(), end, source.data_uri);
      }
      if (item.contains("bufferView"))
        source.view =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(whole_of(item, "bufferView", 0), kNoId - 1));
      source.length = whole_of(item, "byteLength", 0);
      source.is_fallback = extension_of(item, kGltfMeshopt) != nullptr;
    }
  }

  void take_views() {
    for (const GltfJson& v : list_of(in_, "bufferViews")) {
      const std::string where = gltf_place("bufferViews", out_.views.size());
      GltfView& view = out_.views.emplace_back();
      view.range = {index(v, "buffer", out_.buffers.size(), where, "buffer"), whole_of(v, "byteOffset", 0),
                    whole_of(v, "byteLength", 0)};
      const std::uint64_t stride = whole_of(v, "byteStride", 0);
      if (stride > 252 || stride % 4 != 0)
        fail(where + ": a stride of " + std::to_string(stride) +
             " bytes; expected a multiple of 4 that is at most 252");
      view.stride = static_cast<std::uint32_t>(stride);
      if (const GltfJson* const packing = extension_of(v, kGltfMeshopt))
        view.packing = packing_of(*packing, where);
    }
  }

  GltfPacking packing_of(const GltfJson& object, const std::string& where) const {
    GltfPacking packing;
    for (const char* const key : {"buffer", "byteLength", "byteStride", "count"})
      if (!object.contains(key)) fail(where + ": expected '" + key + "' of " + kGltfMeshopt);
    packing.packed.buffer = index(object, "buffer", out_.buffers.size(), where, "buffer");
    packing.packed.offset = whole_of(object, "byteOffset", 0);
    packing.packed.length = whole_of(object, "byteLength", 0);
    packing.stride =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(whole_of(object, "byteStride", 0), kNoId));
    packing.count = whole_of(object, "count", 0);
    const auto choose = [&](const char* key, std::initializer_list<std::string_view> words) {
      const std::string word = text_of(object, key, "NONE");
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

  GltfNumber number_type(const GltfJson& object, std::string& problem) const {
    const std::uint64_t code = whole_of(object, "componentType", 0);
    for (const GltfNumber number : {GltfNumber::int8, GltfNumber::uint8, GltfNumber::int16,
                                    GltfNumber::uint16, GltfNumber::uint32, GltfNumber::float32})
      if (code == static_cast<std::uint64_t>(number)) return number;
    problem = "unknown component type " + std::to_string(code);
    return GltfNumber::uint8;
  }

  void take_accessors() {
    for (const GltfJson& a : list_of(in_, "accessors")) {
      const std::string where = gltf_place("accessors", out_.accessors.size());
      GltfAccessor& accessor = out_.accessors.emplace_back();
      accessor.view = index(a, "bufferView", out_.views.size(), where, "view");
      accessor.offset = whole_of(a, "byteOffset", 0), accessor.count = whole_of(a, "count", 0);
      accessor.number = number_type(a, accessor.problem);
      accessor.components = components_of(text_of(a, "type"));
      accessor.is_matrix = text_of(a, "type").starts_with("MAT");
      if (accessor.components == 0) accessor.problem = "unknown type " + quote_name(text_of(a, "type"));
      accessor.normalized = flag_of(a, "normalized");
      if (const GltfJson* const s = member(a, "sparse")) {
        GltfSparse sparse;
        const GltfJson &indices = s->at("indices"), &values = s->at("values");
        sparse.count = whole_of(*s, "count", 0);
        sparse.index_view = index(indices, "bufferView", out_.views.size(), where, "view");
        sparse.value_view = index(values, "bufferView", out_.views.size(), where, "view");
        sparse.index_offset = whole_of(indices, "byteOffset", 0);
        sparse.value_offset = whole_of(values, "byteOffset", 0);
        sparse.index_number = number_type(indices, accessor.problem);
        accessor.sparse = sparse;
      }
    }
  }

  /// The number behind `what` in a name such as "TEXCOORD_1".
  static std::optional<std::uint32_t> set_of(const std::string& name, std::string_view what) {
    if (!name.starts_with(what)) return std::nullopt;
    std::uint32_t set = 0;
    const char *const first = name.data() + what.size(), *const end = name.data() + name.size();
    const auto [rest, error] = std::from_chars(first, end, set);
    // Not "TEXCOORD_01".
    const bool good = error == std::errc() && rest == end && (*first != '0' || end == first + 1);
    return good ? std::optional(set) : std::nullopt;
  }

  static bool is_known(const std::string& name) {
    constexpr std::string_view kNames[] = {"POSITION", "NORMAL", "TANGENT"};
    if (name.starts_with('_') || std::ranges::find(kNames, std::string_view(name)) != std::end(kNames))
      return true;
    constexpr std::string_view kSets[] = {"TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"};
    return std::ranges::any_of(kSets, [&](std::string_view set) { return set_of(name, set).has_value(); });
  }

  /// The attributes that are read, by their names; there are so many of what the numbers name.
  GltfAttributes attributes_of(const GltfJson& named, std::size_t count, const std::string& where,
                               const char* what) {
    GltfAttributes attributes;
    for (const auto& [name, value] : named.items()) {
      const auto number = [&, &value = value] {
        return checked_index(path_, value.get<std::uint64_t>(), count, where, what);
      };
      if (name == "POSITION") attributes.positions = number();
      if (name == "NORMAL") attributes.normals = number();
      if (name == "TANGENT") attributes.tangents = number();
      if (const std::optional<std::uint32_t> set = set_of(name, "TEXCOORD_"))
        attributes.uvs.emplace_back(*set, number());
      if (!is_known(name)) warn(where + ": the attribute " + quote_name(name) + " is not known");
    }
    for (int i = 0; i < kMostInfluences; ++i) {
      const GltfJson *const joints = member(named, ("JOINTS_" + std::to_string(i)).c_str()),
                            *const weights = member(named, ("WEIGHTS_" + std::to_string(i)).c_str());
      if ((joints == nullptr) != (weights == nullptr))
        warn(where + ": JOINTS_" + std::to_string(i) + " and WEIGHTS_" + std::to_string(i) +
             " belong together; the one that is there is not read");
      if (joints == nullptr || weights == nullptr) break;
      attributes.joints.push_back(checked_index(path_, joints->get<std::uint64_t>(), count, where, what));
      attributes.weights.push_back(checked_index(path_, weights->get<std::uint64_t>(), count, where, what));
    }
    return attributes;
  }

  /// The name in the mesh of what vertices carry as `name`; empty: they do not.
  static std::string carried_name(const std::string& name) {
    if (name.starts_with('_')) return name.substr(1);
    const std::optional<std::uint32_t> set = set_of(name, "COLOR_");
    if (!set) return "";
    return *set == 0 ? kColorAttribute : kColorAttribute + ("_" + std::to_string(*set));
  }

  /// Adds what the primitive's mesh carries of `named`, as attributes_of reads it.
  void take_carried(const GltfJson& named, std::size_t count, const std::string& where, const char* what,
                    GltfAttributes& attributes) {
    std::set<std::string> names;
    // Colours stand before names with an underscore.
    for (const auto& [name, value] : named.items()) {
      const std::string own = carried_name(name);
      if (own.empty()) continue;
      if (names.insert(own).second)
        attributes.carried.push_back(
            {own, checked_index(path_, value.get<std::uint64_t>(), count, where, what), name[0] != '_'});
      else
        warn(where + ": the attribute " + quote_name(name) + " is not read: another one is called " +
             quote_name(own));
    }
  }

  void take_meshes() {
    for (const GltfJson& m : list_of(in_, "meshes")) {
      const std::string where = gltf_place("meshes", out_.meshes.size());
      GltfMesh& mesh = out_.meshes.emplace_back();
      mesh.name = text_of(m, "name"), mesh.weights = numbers_of(m, "weights");
      const GltfJson& primitives = list_of(m, "primitives");
      if (primitives.empty()) warn(where + ": has no primitives");
      for (const GltfJson& p : primitives)
        mesh.primitives.push_back(
            primitive_of(p, where + "." + gltf_place("primitives", mesh.primitives.size())));
      if (mesh.primitives.empty()) continue;
      const std::size_t targets = mesh.primitives[0].targets.size();
      if (std::ranges::any_of(mesh.primitives, [&](const auto& p) { return p.targets.size() != targets; }))
        warn(where + ": its primitives have different numbers of morph targets");
      check_weights(mesh.weights, mesh, where);
    }
  }

  void check_weights(const std::vector<double>& weights, const GltfMesh& mesh, const std::string& where) {
    const std::size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
    if (!weights.empty() && weights.size() != targets)
      warn(where + ": " + std::to_string(weights.size()) + " weights for " + std::to_string(targets) +
           " morph targets; " +
           (weights.size() < targets ? "the others have none" : "the last ones are left out"));
  }

  GltfPrimitive primitive_of(const GltfJson& p, const std::string& where) {
    GltfPrimitive primitive;
    const std::size_t accessors = out_.accessors.size();
    const std::uint64_t mode = whole_of(p, "mode", GltfPrimitive::kTriangles);
    if (mode > GltfPrimitive::kFan)
      warn(where + ": unknown mode " + std::to_string(mode) + "; it is left out");
    primitive.mode = static_cast<int>(std::min<std::uint64_t>(mode, GltfPrimitive::kFan + 1));
    primitive.material = index(p, "material", list_of(in_, "materials").size(), where, "material");
    primitive.attributes = attributes_of(p.at("attributes"), accessors, where, "accessor");
    take_carried(p.at("attributes"), accessors, where, "accessor", primitive.attributes);
    primitive.indices = index(p, "indices", accessors, where, "accessor");
    for (const GltfJson& target : list_of(p, "targets"))
      primitive.targets.push_back(attributes_of(target, accessors, where, "accessor"));
    if (const GltfJson* const variants = extension_of(p, kGltfVariants))
      for (const GltfJson& mapping : list_of(*variants, "mappings")) {
        const std::uint32_t material =
            index(mapping, "material", list_of(in_, "materials").size(), where, "material");
        for (const GltfJson& variant : list_of(mapping, "variants"))
          primitive.variants.emplace(
              checked_index(path_, variant.get<std::uint64_t>(), out_.variants.size(), where, "variant"),
              material);
      }
    const GltfJson* const draco = extension_of(p, kGltfDraco);
    if (draco == nullptr) return primitive;
    primitive.draco_view = index(*draco, "bufferView", out_.views.size(), where, "view");
    primitive.draco_attributes = attributes_of(draco->at("attributes"), kNoId, where, "attribute");
    take_carried(draco->at("attributes"), kNoId, where, "attribute", primitive.draco_attributes);
    return primitive;
  }

  void take_cameras() {
    for (const GltfJson& c : list_of(in_, "cameras")) {
      const std::string where = gltf_place("cameras", out_.cameras.size());
      GltfCamera& camera = out_.cameras.emplace_back();
      const std::string type = text_of(c, "type");
      camera.is_perspective = type == "perspective";
      if (!camera.is_perspective && type != "orthographic") {
        camera.problem = "unknown type " + quote_name(type);
        continue;
      }
      const GltfJson* const view = member(c, type.c_str());
      if (view == nullptr) fail(where + ": '" + type + "' is missing");
      camera.yfov = number_of(*view, "yfov", 0.7), camera.aspect = number_of(*view, "aspectRatio", 0);
      const double xmag = number_of(*view, "xmag", 1);
      camera.ymag = std::abs(number_of(*view, "ymag", 1));
      if (!camera.is_perspective && camera.ymag > 0) camera.aspect = std::abs(xmag / camera.ymag);
      if (!(camera.aspect >= 0 && camera.aspect <= kMostAspect)) camera.aspect = 0;
      const bool good = camera.is_perspective ? camera.yfov > 0 && camera.yfov < 3.14
                                              : camera.ymag > 0 && camera.ymag <= 1e30;
      if (!good) camera.problem = "its field of view is out of range";
    }
  }

  void take_lights() {
    const GltfJson* const extension = extension_of(in_, kGltfLights);
    if (extension == nullptr) return;
    for (const GltfJson& l : list_of(*extension, "lights")) {
      const std::string where = gltf_place("lights", out_.lights.size());
      GltfLight& light = out_.lights.emplace_back();
      constexpr std::string_view kKinds[] = {"directional", "point", "spot"};
      const std::string type = text_of(l, "type");
      const auto* const kind = std::ranges::find(kKinds, std::string_view(type));
      if (kind == std::end(kKinds)) warn(where + ": unknown type " + quote_name(type) + "; it is left out");
      light.kind = static_cast<GltfLight::Kind>(kind - std::begin(kKinds));
      if (l.contains("color")) light.color = gltf_color(path_, where, numbers_of(l, "color"), 1e30);
      light.intensity = number_of(l, "intensity", 1);
      const GltfJson* const spot = member(l, "spot");
      light.inner_angle = spot == nullptr ? 0 : number_of(*spot, "innerConeAngle", 0);
      light.outer_angle = spot == nullptr ? kUsualCone : number_of(*spot, "outerConeAngle", kUsualCone);
      const bool good_angles = light.inner_angle >= 0 && light.inner_angle <= light.outer_angle &&
                               light.outer_angle > 0 && light.outer_angle < 1.5708;
      if (!(light.intensity >= 0 && light.intensity <= 1e30) ||
          (light.kind == GltfLight::Kind::spot && !good_angles))
        fail(where + ": its intensity or angles are out of range");
    }
  }

  void take_nodes() {
    const GltfJson& nodes = list_of(in_, "nodes");
    const std::size_t count = nodes.size();
    for (const GltfJson& n : nodes) {
      const std::string where = gltf_place("nodes", out_.nodes.size());
      GltfNode& node = out_.nodes.emplace_back();
      node.name = text_of(n, "name");
      set_transform(n, where, node);
      node.mesh = index(n, "mesh", out_.meshes.size(), where, "mesh");
      node.camera = index(n, "camera", out_.cameras.size(), where, "camera");
      for (const GltfJson& child : list_of(n, "children"))
        node.children.push_back(checked_index(path_, child.get<std::uint64_t>(), count, where, "node"));
      if (const GltfJson* const light = extension_of(n, kGltfLights))
        node.light = index(*light, "light", out_.lights.size(), where, "light");
      node.skin = index(n, "skin", list_of(in_, "skins").size(), where, "skin");
      node.weights = numbers_of(n, "weights");
      if (node.mesh != kNoId) check_weights(node.weights, out_.meshes[node.mesh], where);
      if (const GltfJson* const instances = extension_of(n, kGltfInstances)) {
        const GltfJson& attributes = instances->at("attributes");
        const std::size_t accessors = out_.accessors.size();
        node.is_instanced = true;
        node.instance_translations = index(attributes, "TRANSLATION", accessors, where, "accessor");
        node.instance_rotations = index(attributes, "ROTATION", accessors, where, "accessor");
        node.instance_scales = index(attributes, "SCALE", accessors, where, "accessor");
      }
    }
    choose_roots(count);
  }

  void choose_roots(std::size_t count) {
    const GltfJson& scenes = list_of(in_, "scenes");
    if (scenes.empty()) {
      if (in_.contains("scene")) checked_index(path_, whole_of(in_, "scene", 0), 0, "scene", "scene");
      // A library of things: all that is in no other is shown.
      std::vector<bool> is_child(count);
      for (const GltfNode& node : out_.nodes)
        for (const std::uint32_t child : node.children) is_child[child] = true;
      for (std::uint32_t i = 0; i < count; ++i)
        if (!is_child[i]) out_.roots.push_back(i);
      return;
    }
    const std::uint32_t shown =
        checked_index(path_, whole_of(in_, "scene", 0), scenes.size(), "scene", "scene");
    if (scenes.size() > 1)
      warn("of " + std::to_string(scenes.size()) + " scenes, number " + std::to_string(shown) + " is shown");
    for (const GltfJson& root : list_of(scenes[shown], "nodes"))
      out_.roots.push_back(
          checked_index(path_, root.get<std::uint64_t>(), count, gltf_place("scenes", shown), "node"));
    std::vector<std::uint32_t> parents(count, kNoId);
    for (std::uint32_t i = 0; i < count; ++i)
      for (const std::uint32_t child : out_.nodes[i].children) parents[child] = i;
    for (const std::uint32_t root : out_.roots)
      if (parents[root] != kNoId)
        warn(gltf_place("scenes", shown) + ": " + gltf_place("nodes", root) + " is a child of " +
             gltf_place("nodes", parents[root]) + ", with which it moves");
  }

  void set_transform(const GltfJson& n, const std::string& where, GltfNode& node) {
    if (const std::vector<double> matrix = numbers_of(n, "matrix"); !matrix.empty()) {
      node.has_matrix = true;
      for (const char* const key : {"translation", "rotation", "scale"})
        if (n.contains(key)) warn(where + ": its " + key + " is not read, as it has a matrix");
      const double off = std::max(
          {std::abs(matrix[3]), std::abs(matrix[7]), std::abs(matrix[11]), std::abs(matrix[15] - 1)});
      if (!(off <= 1e-6)) warn(where + ": the last row of its matrix is not 0, 0, 0, 1, as which it is read");
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column)
          node.to_parent.m[row][column] = matrix[4 * column + row];
      return;
    }
    if (const std::vector<double> t = numbers_of(n, "translation"); !t.empty())
      node.place.translation = {t[0], t[1], t[2]};
    if (const std::vector<double> s = numbers_of(n, "scale"); !s.empty())
      node.place.scale = {s[0], s[1], s[2]};
    if (const std::vector<double> q = numbers_of(n, "rotation"); !q.empty()) {
      node.place.rotation = {q[0], q[1], q[2], q[3]};
      const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
      if (!(square > 0 && square < 1e60))
        fail(where + ": the quaternion of its rotation is zero or out of range");
    }
    node.to_parent = node.place.transform();
  }

  void take_textures() {
    const GltfJson& samplers = list_of(in_, "samplers");
    for (const GltfJson& t : list_of(in_, "textures")) {
      const std::string where = gltf_place("textures", out_.textures.size());
      GltfTexture& texture = out_.textures.emplace_back();
      texture.image = index(t, "source", out_.images.size(), where, "image");
      if (const GltfJson* const webp = extension_of(t, "EXT_texture_webp"); webp && webp->contains("source"))
        texture.image = index(*webp, "source", out_.images.size(), where, "image");
      if (extension_of(t, "KHR_texture_basisu") != nullptr)
        warn(where + ": its KTX2 image is not read; " +
             (texture.image == kNoId ? "white instead" : "the other one that it names is"));
      const std::uint32_t sampler = index(t, "sampler", samplers.size(), where, "sampler");
      if (sampler == kNoId) continue;
      texture.lookup.u = wrap_of(whole_of(samplers[sampler], "wrapS", 0));
      texture.lookup.v = wrap_of(whole_of(samplers[sampler], "wrapT", 0));
      constexpr std::uint64_t kNearest = 9728;
      if (whole_of(samplers[sampler], "magFilter", 0) == kNearest)
        texture.lookup.magnified = TextureFilter::nearest;
    }
  }

  void take_variants() {
    const GltfJson* const extension = extension_of(in_, kGltfVariants);
    if (extension == nullptr) return;
    for (const GltfJson& variant : list_of(*extension, "variants"))
      out_.variants.push_back(text_of(variant, "name"));
  }

  void take_skins() {
    for (const GltfJson& s : list_of(in_, "skins")) {
      const std::string where = gltf_place("skins", out_.skins.size());
      GltfSkin& skin = out_.skins.emplace_back();
      for (const GltfJson& joint : list_of(s, "joints"))
        skin.joints.push_back(
            checked_index(path_, joint.get<std::uint64_t>(), out_.nodes.size(), where, "node"));
      skin.inverse_binds = index(s, "inverseBindMatrices", out_.accessors.size(), where, "accessor");
    }
  }

  void take_animations() {
    const GltfJson& animations = list_of(in_, "animations");
    for (std::size_t i = 0; i < animations.size(); ++i) {
      const GltfJson &channels = list_of(animations[i], "channels"),
                     &samplers = list_of(animations[i], "samplers");
      for (std::size_t k = 0; k < channels.size(); ++k)
        take_channel(channels[k], samplers, gltf_place("animations", i) + "." + gltf_place("channels", k));
    }
  }

  void take_channel(const GltfJson& c, const GltfJson& samplers, const std::string& where) {
    const GltfJson& target = c.at("target");
    const GltfJson& sampler = samplers[index(c, "sampler", samplers.size(), where, "sampler")];
    GltfChannel channel;
    constexpr std::string_view kPaths[] = {"translation", "rotation", "scale", "weights"};
    const auto* const path = std::ranges::find(kPaths, std::string_view(text_of(target, "path")));
    // An extension may have further ones, and targets of its own.
    if (path == std::end(kPaths) || !target.contains("node"))
      return warn(where + ": animates what is not read");
    channel.path = static_cast<GltfChannel::Path>(path - std::begin(kPaths));
    channel.node = index(target, "node", out_.nodes.size(), where, "node");
    // glTF forbids to animate a node that has a matrix, and programs split such a matrix differently.
    if (channel.path != GltfChannel::Path::weights && out_.nodes[channel.node].has_matrix)
      return warn(where + ": " + gltf_place("nodes", channel.node) + " has a matrix; it is not animated");
    constexpr std::string_view kCurves[] = {"LINEAR", "STEP", "CUBICSPLINE"};
    const std::string curve = text_of(sampler, "interpolation", "LINEAR");
    const auto* const found = std::ranges::find(kCurves, std::string_view(curve));
    if (found == std::end(kCurves))
      return warn(where + ": unknown interpolation " + quote_name(curve) + "; it is left out");
    channel.curve = static_cast<GltfChannel::Curve>(found - std::begin(kCurves));
    channel.times = index(sampler, "input", out_.accessors.size(), where, "accessor");
    channel.values = index(sampler, "output", out_.accessors.size(), where, "accessor");
    out_.channels.push_back(channel);
  }

  static constexpr int kMostInfluences = 8;  ///< sets of four joints
  static constexpr double kUsualCone = 0.7853981633974483, kMostAspect = 1e6;

  const std::string& path_;
  const GltfJson& in_;
  GltfModel out_;
};

}  // namespace

GltfModel gltf_model(const std::string& path, const GltfJson& root) {
  return GltfConversion(path, root).run();
}

}  // namespace oktett
