#pragma once
/// \file Textures at places of surfaces: images by uv, patterns by the place in the object's own space,
/// attributes by that on the mesh.

#include <cstdint>
#include <span>

#include "core/vec3.h"
#include "render/context.h"
#include "render/material.h"

namespace oktett {

/// A place in texture coordinates.
struct UvPlace {
  Vec2f uv;
  Vec2f dx, dy;  ///< changes of uv from this pixel to its neighbours; zero when unknown
};

/// Where textures are looked up.
struct TexturePlace : UvPlace {
  Vec3d position;  ///< in the object's own space
  UvPlace second;  ///< of textures whose uv_layer is 1
  MeshPoint on_mesh;
  Vec3d normal{0, 0, 0}, to_viewer{0, 0, 0};  ///< as of PatternTextures
};

/// The textures of a scene, and what reads its images (null: they are white).
struct Textures {
  std::span<const Texture> list;
  const TextureSampler* images = nullptr;
};

/// The light of the background from a direction.
Color background_color(const RenderContext& context, const Vec3f& direction);

/// The colour of a texture; white for kNoId.
Color texture_color(const Textures& textures, std::uint32_t texture, const TexturePlace& place);
inline Color texture_color(const RenderContext& context, std::uint32_t texture, const TexturePlace& place) {
  return texture_color(Textures{context.texture_list, context.textures}, texture, place);
}

bool has_textures(const Material& material);
/// What the textures of a material, numbers in `list`, ask of a hit.
TextureNeeds texture_needs(std::span<const Texture> list, const Material& material);

/// The number of a texture; 1 for kNoId.
float texture_value(const RenderContext& context, std::uint32_t texture, const TexturePlace& place);

// What a texture is made of.

/// The pattern of a texture; null for an image or kNoId.
const PatternTexture* pattern_in(std::span<const Texture> list, std::uint32_t texture);
/// Where the image of a texture is looked up.
const UvPlace& uv_place(std::span<const Texture> list, std::uint32_t texture, const TexturePlace& place);
/// The texture, if it shows an attribute of meshes; else null.
const Texture* attribute_in(std::span<const Texture> list, std::uint32_t texture);
/// The number that a texture takes from a value of an attribute.
float number_of(const AttributeValue& value, ImageChannel channel);

/// The textures that a pattern at a place shows. They are `depth` patterns deep.
class NestedTextures final : public PatternTextures {
 public:
  NestedTextures(const Textures& textures, const TexturePlace& place, unsigned depth)
      : textures_(textures), place_(place), depth_(depth) {}

  Color color(std::uint32_t texture, const Vec3d& position) const override;
  Color image(std::uint32_t texture, const Vec2f& uv) const override;
  Vec3d slope(std::uint32_t texture, const Vec3d& position) const override;
  Vec3d normal() const override { return place_.normal; }
  Vec3d to_viewer() const override { return place_.to_viewer; }

  /// The colour of a texture that is shown `depth` patterns deep.
  static Color color_at(const Textures& textures, std::uint32_t texture, const TexturePlace& place,
                        unsigned depth);

 private:
  const Textures& textures_;
  const TexturePlace& place_;
  unsigned depth_;
};

}  // namespace oktett
