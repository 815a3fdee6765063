#include <algorithm>
#include <charconv>
#include <string_view>

#include "io/gltf/json.h"
#include "io/gltf/schema.h"
#include "io/mesh/reading.h"

namespace oktett {
namespace {

/// Extensions that are read; the others are an error if the file requires them.
constexpr std::string_view kKnown[] = {
    kGltfDraco,
    kGltfMeshopt,
    kGltfLights,
    kGltfVariants,
    kGltfInstances,
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_materials_pbrSpecularGlossiness",
    "EXT_texture_webp",
    "KHR_texture_basisu",
};

/// The text of a file as JSON, of which all types are right.
class JsonText {
 public:
  JsonText(const std::string& path, bool in_bytes) : path_(path), in_bytes_(in_bytes) {}

  GltfJson run(const std::string& text) {
    parse(text);
    check_version();
    check_gltf_types(path_, root_);
    for (const GltfJson& name : list_of(root_, "extensionsRequired"))
      if (!is_known(name.get<std::string>()))
        fail("needs the extension " + quote_name(name.get<std::string>()) + ", which is not known here");
    return std::move(root_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(Location{path_}, what); }

  void parse(const std::string& text) {
    try {
      root_ = GltfJson::parse(text);
    } catch (const GltfJson::parse_error& error) {
      const std::size_t at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
      if (in_bytes_) fail("byte " + std::to_string(at) + " of the JSON: expected other text there");
      const std::string_view before(text.data(), at);
      const std::size_t line_begin = before.rfind('\n') + 1;  // 0 in the first line, since npos + 1 is 0
      throw Error(Location{path_, 1 + static_cast<int>(std::ranges::count(before, '\n')),
                           1 + static_cast<int>(at - line_begin)},
                  "expected other JSON text here");
    } catch (const GltfJson::exception& error) {
      fail("the JSON cannot be read: " + quote_name(error.what()));
    }
    if (!root_.is_object()) fail("expected a JSON object that describes a glTF scene");
  }

  /// First, because files of other versions have other types.
  void check_version() const {
    const GltfJson* const asset = member(root_, "asset");
    const GltfJson* const version =
        asset == nullptr || !asset->is_object() ? nullptr : member(*asset, "version");
    if (version == nullptr || !version->is_string())
      fail("expected a glTF file: the version in 'asset' is missing");
    const std::string number = version->get<std::string>();
    if (!number.starts_with("2.")) fail("expected glTF version 2, found " + quote_name(number));
    const GltfJson* const least = member(*asset, "minVersion");
    if (least != nullptr && least->is_string() && least->get<std::string>() != "2.0")
      fail("asset.minVersion: needs glTF version " + quote_name(least->get<std::string>()) + "; 2.0 is read");
  }

 public:
  static bool is_known(const std::string& name) {
    return std::ranges::find(kKnown, name) != std::end(kKnown);
  }

 private:
  const std::string& path_;
  const bool in_bytes_;
  GltfJson root_;
};

}  // namespace

GltfModel parse_gltf(const std::string& path, const std::string& json, bool in_bytes) {
  const GltfJson root = JsonText(path, in_bytes).run(json);
  GltfModel model = gltf_model(path, root);
  for (const GltfJson& used : list_of(root, "extensionsUsed"))
    if (const std::string name = used.get<std::string>(); !JsonText::is_known(name))
      model.warnings.push_back("extension " + quote_name(name) + " is not read");
  return model;
}

}  // namespace oktett
