#include "io/scene/meshes.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include "io/cache/scene_cache.h"
#include "io/image/library.h"
#include "io/text/files.h"
#include "render/material.h"

namespace oktett {

void check_textures(MeshFile& file) {
  for (std::size_t i = 0; i < file.textures.size(); ++i) {
    Texture& texture = file.textures[i];
    if (texture.content) continue;
    note_file_read(texture.path);
    const std::string why = why_not_an_image(texture.path);
    if (why.empty()) continue;
    file.warnings.push_back(
        {file.texture_places[i], "texture " + texture.path + " not used: " + why + "; white instead"});
    texture.path.clear();
  }
}

std::vector<std::uint32_t> append_materials(MeshFile& file, Scene& scene) {
  const auto first_texture = static_cast<std::uint32_t>(scene.textures.size());
  scene.texture_places.resize(scene.textures.size());
  scene.material_places.resize(scene.materials.size());
  std::ranges::move(file.texture_places, std::back_inserter(scene.texture_places));
  std::ranges::move(file.material_places, std::back_inserter(scene.material_places));
  std::move(file.textures.begin(), file.textures.end(), std::back_inserter(scene.textures));
  const auto first_medium = static_cast<std::uint32_t>(scene.media.size());
  std::move(file.media.begin(), file.media.end(), std::back_inserter(scene.media));
  std::vector<std::uint32_t> indices;
  for (Material& material : file.materials) {
    if (material.interior != kNoId) material.interior += first_medium;
    for_each_texture(material, [first_texture](std::uint32_t& texture) {
      if (texture != kNoId) texture += first_texture;
    });
    indices.push_back(static_cast<std::uint32_t>(scene.materials.size()));
    scene.materials.push_back(std::move(material));
  }
  return indices;
}

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path canonical = std::filesystem::canonical(path, error);
  return error ? path : canonical.string();
}

const MeshLibrary::Entry& MeshLibrary::load(const std::string& path, const MeshOptions& options,
                                            Scene& scene) {
  const std::pair key(canonical_path(path), options.weld);
  const auto found = entries_.find(key);
  if (found != entries_.end()) return found->second;
  SceneCache* const cache = SceneCache::current();
  MeshFile file = cache != nullptr ? cache->load_mesh(path, options) : load_mesh(path, options);
  return entries_.emplace(key, add(std::move(file), scene)).first->second;
}

MeshLibrary::Entry MeshLibrary::add(MeshFile file, Scene& scene) {
  check_textures(file);
  Entry entry;
  entry.slot_materials = append_materials(file, scene);
  entry.mesh = std::make_shared<const TriangleMesh>(std::move(file.mesh));
  std::move(file.warnings.begin(), file.warnings.end(), std::back_inserter(scene.warnings));
  return entry;
}

}  // namespace oktett
