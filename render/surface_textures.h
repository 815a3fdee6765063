#pragma once
/// \file Textures at places of surfaces: images by uv, patterns by the place in the object's own space.

#include <cstdint>
#include <span>

#include "core/vec3.h"
#include "render/context.h"

namespace oktett {

/// Where textures are looked up.
struct TexturePlace {
  Vec2f uv;
  Vec2f dx, dy;    ///< changes of uv from this pixel to its neighbours; zero when unknown
  Vec3d position;  ///< in the object's own space
};

/// The pattern of a texture; null for an image or kNoId.
const PatternTexture* pattern_of(const RenderContext& context, std::uint32_t texture);

/// The textures of a scene, and what reads its images (null: they are white).
struct Textures {
  std::span<const Texture> list;
  const TextureSampler* images = nullptr;
};

/// The colour of a texture; white for kNoId.
Color texture_color(const Textures& textures, std::uint32_t texture, const TexturePlace& place);
inline Color texture_color(const RenderContext& context, std::uint32_t texture, const TexturePlace& place) {
  return texture_color(Textures{context.texture_list, context.textures}, texture, place);
}
/// Its number; 1 for kNoId.
float texture_value(const RenderContext& context, std::uint32_t texture, const TexturePlace& place);

bool has_textures(const Material& material);
/// Whether any texture of the material is a pattern.
bool has_pattern(const RenderContext& context, const Material& material);

}  // namespace oktett
