#include "io/scene/meshes.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include "io/cache/scene_cache.h"
#include "io/image/image_access.h"
#include "io/obj/material_textures.h"
#include "io/obj/obj.h"
#include "io/text/files_read.h"

namespace oktett {
namespace {

/// Images that cannot be read at all are told of here, where the statement that names them is known. Their
/// textures lose the path, and are white.
void check_textures(ObjFile& obj) {
  for (std::size_t i = 0; i < obj.textures.size(); ++i) {
    Texture& texture = obj.textures[i];
    note_file_read(texture.path);
    const std::string why = why_not_an_image(texture.path);
    if (why.empty()) continue;
    obj.warnings.push_back(
        {obj.texture_places[i], "texture " + texture.path + " not used: " + why + "; white instead"});
    texture.path.clear();
  }
}

/// Appends what `obj` brings to `scene` and returns the new index of each of its materials.
std::vector<std::uint32_t> append_materials(ObjFile& obj, Scene& scene) {
  const auto first_texture = static_cast<std::uint32_t>(scene.textures.size());
  std::move(obj.textures.begin(), obj.textures.end(), std::back_inserter(scene.textures));
  std::vector<std::uint32_t> indices;
  for (Material& material : obj.materials) {
    for_each_texture(material, [first_texture](std::uint32_t& texture) {
      if (texture != kNoId) texture += first_texture;
    });
    indices.push_back(static_cast<std::uint32_t>(scene.materials.size()));
    scene.materials.push_back(std::move(material));
  }
  return indices;
}

}  // namespace

std::string lower_case_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path canonical = std::filesystem::canonical(path, error);
  return error ? path : canonical.string();
}

const MeshLibrary::Entry& MeshLibrary::load(const std::string& path, Scene& scene) {
  const std::string key = canonical_path(path);
  const auto found = entries_.find(key);
  if (found != entries_.end()) return found->second;
  SceneCache* const cache = SceneCache::current();
  ObjFile obj = cache != nullptr ? cache->load_mesh(path) : load_obj(path);
  check_textures(obj);
  Entry entry;
  entry.slot_materials = append_materials(obj, scene);
  entry.mesh = std::make_shared<const TriangleMesh>(std::move(obj.mesh));
  std::move(obj.warnings.begin(), obj.warnings.end(), std::back_inserter(scene.warnings));
  return entries_.emplace(key, std::move(entry)).first->second;
}

}  // namespace oktett
