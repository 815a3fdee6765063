#include "render/append_materials.h"

#include <iterator>
#include <utility>

namespace oktett {

std::uint32_t append_materials(std::vector<Material> materials, std::vector<Texture> textures,
                               std::vector<Medium> media, Scene& scene) {
  const auto first = static_cast<std::uint32_t>(scene.materials.size());
  const auto first_texture = static_cast<std::uint32_t>(scene.textures.size());
  const auto first_medium = static_cast<std::uint32_t>(scene.media.size());
  for (Material& material : materials) {
    if (material.interior != kNoId) material.interior += first_medium;
    if (material.back != kNoId) material.back += first;
    for_each_texture(material, [first_texture](std::uint32_t& texture) {
      if (texture != kNoId) texture += first_texture;
    });
  }
  for (Medium& medium : media)
    if (medium.density_texture != kNoId) medium.density_texture += first_texture;
  for (Texture& texture : textures)
    if (texture.pattern)
      for_each_nested_texture(*texture.pattern, [first_texture](std::uint32_t& nested) {
        if (nested != kNoId) nested += first_texture;
      });
  std::move(materials.begin(), materials.end(), std::back_inserter(scene.materials));
  std::move(textures.begin(), textures.end(), std::back_inserter(scene.textures));
  std::move(media.begin(), media.end(), std::back_inserter(scene.media));
  return first;
}

}  // namespace oktett
