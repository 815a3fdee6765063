// The only unit with the implementation of tinygltf and the JSON library beneath it, which take long to
// compile.

#define TINYGLTF_IMPLEMENTATION
#include <algorithm>
#include <charconv>
#include <exception>
#include <fstream>
#include <new>
#include <string_view>
#include <utility>

#include "io/gltf/gltf_file.h"
#include "io/gltf/tiny_model.h"
#include "io/mesh/reading.h"

namespace oktett {
namespace {

using nlohmann::json;

/// Extensions that are read; the others are an error if the file requires them.
constexpr std::string_view kKnown[] = {
    kGltfDraco,
    kGltfMeshopt,
    kGltfLights,
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_clearcoat",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "EXT_texture_webp",
};

/// Parses a file's JSON to tinygltf's model.
class TinyParse {
 public:
  TinyParse(const std::string& path, bool in_bytes) : path_(path), in_bytes_(in_bytes) {}

  TinyModel run(const std::string& text) {
    parse_json(text);
    take_sources("buffers", out_.buffers);
    take_sources("images", out_.images);
    clean(root_);
    note_motion();
    parse_model();
    check_extensions();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(Location{path_}, what); }

  void parse_json(const std::string& text) {
    try {
      root_ = json::parse(text);
    } catch (const json::parse_error& error) {
      const std::size_t at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
      if (in_bytes_) fail("byte " + std::to_string(at) + " of the JSON: expected other text there");
      const std::string_view before(text.data(), at);
      const std::size_t line_begin = before.rfind('\n') + 1;  // 0 in the first line, since npos + 1 is 0
      throw Error(Location{path_, 1 + static_cast<int>(std::ranges::count(before, '\n')),
                           1 + static_cast<int>(at - line_begin)},
                  "expected other JSON text here");
    } catch (const json::exception& error) {
      fail("the JSON cannot be read: " + quote_name(error.what()));
    }
    if (!root_.is_object()) fail("expected a JSON object that describes a glTF scene");
    const auto asset = root_.find("asset");
    const auto version =
        asset == root_.end() || !asset->is_object() ? json() : asset->value("version", json());
    if (!version.is_string()) fail("expected a glTF file: the version in 'asset' is missing");
    const std::string number = version.get<std::string>();
    if (!number.starts_with("2.")) fail("expected glTF version 2, found " + quote_name(number));
  }

  /// Takes buffers or images out of the JSON: tinygltf would read them, and copy them.
  void take_sources(const char* key, std::vector<GltfSource>& sources) {
    const auto list = root_.find(key);
    if (list == root_.end()) return;
    if (!list->is_array()) fail(std::string(key) + ": expected a list");
    for (const json& item : *list) {
      const std::string where = gltf_place(key, sources.size());
      if (!item.is_object()) fail(where + ": expected an object");
      GltfSource& source = sources.emplace_back();
      if (const auto uri = item.find("uri"); uri != item.end()) {
        if (!uri->is_string()) fail(where + ": expected a text as uri");
        source.uri = uri->get<std::string>();
        if (source.uri.starts_with(kGltfDataUri)) {
          const char* const end = source.uri.data() + source.uri.size();
          std::from_chars(source.uri.data() + kGltfDataUri.size(), end, source.data_uri);
        }
      }
      if (const auto view = item.find("bufferView"); view != item.end()) {
        if (!view->is_number_unsigned()) fail(where + ": expected the number of a view");
        source.view =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(view->get<std::uint64_t>(), kNoId - 1));
      }
      if (const auto length = item.find("byteLength"); length != item.end()) {
        if (!length->is_number_unsigned()) fail(where + ": expected a whole number of bytes");
        source.length = length->get<std::uint64_t>();
      }
      const auto extensions = item.find("extensions");
      source.is_fallback =
          extensions != item.end() && extensions->is_object() && extensions->contains(kGltfMeshopt);
    }
    root_.erase(key);
  }

  /// Leaves out what is not read, and what tinygltf misreads: it cuts large numbers down, but for the sizes
  /// of views and accessors, and looks for the indices of Draco's triangles outside of Draco's data.
  void clean(json& node, bool sizes = true) {
    if (node.is_number_integer()) check_size(node);
    if (node.is_object()) {
      node.erase("extras");
      const auto extensions = node.find("extensions");
      if (extensions != node.end() && extensions->is_object() && node.contains("indices")) {
        const auto draco = extensions->find(kGltfDraco);
        if (draco != extensions->end() && draco->is_object()) {
          (*draco)["indices"] = node["indices"];
          node.erase("indices");
        }
      }
      for (auto& [key, value] : node.items()) {
        const bool is_size = sizes && (key == "byteOffset" || key == "byteLength" || key == "count");
        if (!is_size || !value.is_number_unsigned())
          clean(value, sizes && key != "sparse" && key != "extensions");
      }
    }
    if (node.is_array())
      for (json& item : node) clean(item, sizes);
  }

  void check_size(const json& number) const {
    const bool good = number.is_number_unsigned() ? number.get<std::uint64_t>() <= 0x7fffffffu
                                                  : number.get<std::int64_t>() >= -0x7fffffffLL;
    if (!good) fail("the number " + number.dump() + " in the JSON is out of range");
  }

  void note_motion() {
    for (const auto& [key, what] :
         {std::pair{"animations", "animations are not read: things are shown at rest"},
          std::pair{"skins", "skins are not read: meshes are shown at rest"}}) {
      const auto found = root_.find(key);
      if (found != root_.end() && !found->empty()) out_.warnings.emplace_back(what);
      root_.erase(key);
    }
  }

  void parse_model() {
    const std::string text = root_.dump();
    root_ = nullptr;
    tinygltf::TinyGLTF reader;
    std::string error, warning;
    bool good = false;
    try {
      good = reader.LoadASCIIFromString(&out_.model, &error, &warning, text.c_str(),
                                        static_cast<unsigned>(text.size()), "");
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& exception) {
      error = exception.what();
    }
    if (!good)
      fail("not a proper glTF file: " + error.substr(0, std::min(error.find('\n'), std::size_t{200})));
  }

  void check_extensions() {
    const auto is_known = [](const std::string& name) {
      return std::ranges::find(kKnown, name) != std::end(kKnown);
    };
    for (const std::string& name : out_.model.extensionsRequired)
      if (!is_known(name)) fail("needs the extension " + quote_name(name) + ", which is not known here");
    for (const std::string& name : out_.model.extensionsUsed)
      if (!is_known(name)) out_.warnings.push_back("extension " + quote_name(name) + " is not read");
  }

  const std::string& path_;
  const bool in_bytes_;
  json root_;
  TinyModel out_;
};

}  // namespace

TinyModel parse_tiny_model(const std::string& path, const std::string& json, bool in_bytes) {
  return TinyParse(path, in_bytes).run(json);
}

}  // namespace oktett
