#include "render/texture_values.h"

#include <cmath>
#include <optional>

#include "core/color.h"
#include "core/mesh_geometry.h"

namespace oktett {

const PatternTexture* pattern_in(std::span<const Texture> list, std::uint32_t texture) {
  if (texture >= list.size()) return nullptr;
  const Texture& t = list[texture];
  return t.pattern ? &*t.pattern : nullptr;
}

const UvPlace& uv_place(std::span<const Texture> list, std::uint32_t texture, const TexturePlace& place) {
  return texture < list.size() && list[texture].uv_layer != 0 ? place.second : place;
}

const Texture* attribute_in(std::span<const Texture> list, std::uint32_t texture) {
  return texture < list.size() && !list[texture].attribute.empty() ? &list[texture] : nullptr;
}

/// What an attribute has at a place; nothing if there is none.
static std::optional<AttributeValue> attribute_value(const Texture& t, const MeshPoint& place) {
  if (place.mesh == nullptr) return std::nullopt;
  const MeshAttribute* const attribute = find_attribute(*place.mesh, t.attribute);
  if (attribute == nullptr) return std::nullopt;
  AttributeValue value = attribute_at(place, *attribute);
  for (float& x : value) x = x * t.gain + t.base;
  return value;
}

float number_of(const AttributeValue& value, ImageChannel channel) {
  if (channel == ImageChannel::luminance) return luminance({value[0], value[1], value[2]});
  return value[static_cast<std::size_t>(channel)];
}

/// Channels that are negative, NaN or infinite count as 0.
static Color valid_color(const Color& c) {
  const auto valid = [](float x) { return x > 0 && std::isfinite(x) ? x : 0; };
  return {valid(c.x), valid(c.y), valid(c.z)};
}

Color NestedTextures::color(std::uint32_t texture, const Vec3d& position) const {
  if (depth_ > kMostNestedTextures) return {0, 0, 0};
  TexturePlace place = place_;
  place.position = position;
  return color_at(textures_, texture, place, depth_);
}

Color NestedTextures::image(std::uint32_t texture, const Vec2f& uv) const {
  if (depth_ > kMostNestedTextures) return {0, 0, 0};
  TexturePlace place = place_;
  place.uv = uv, place.dx = place.dy = {};
  place.second = place;
  return color_at(textures_, texture, place, depth_);
}

Vec3d NestedTextures::slope(std::uint32_t texture, const Vec3d& position) const {
  const PatternTexture* const pattern = pattern_in(textures_.list, texture);
  if (depth_ > kMostNestedTextures || pattern == nullptr || pattern->by_uv) return {0, 0, 0};
  const NestedTextures nested(textures_, place_, depth_ + 1);
  return pattern_slope(*pattern, position, &nested) * double{textures_.list[texture].gain};
}

Color NestedTextures::color_at(const Textures& textures, std::uint32_t texture, const TexturePlace& place,
                               unsigned depth) {
  if (const PatternTexture* pattern = pattern_in(textures.list, texture)) {
    const Texture& t = textures.list[texture];
    const NestedTextures nested(textures, place, depth + 1);
    const Vec3d position = pattern->by_uv ? Vec3d{place.uv.x, place.uv.y, 0} : place.position;
    return valid_color(pattern_color(*pattern, position, &nested) * t.gain + Color{t.base, t.base, t.base});
  }
  if (const Texture* t = attribute_in(textures.list, texture)) {
    const std::optional<AttributeValue> value = attribute_value(*t, place.on_mesh);
    return value ? valid_color({(*value)[0], (*value)[1], (*value)[2]}) : Color{1, 1, 1};
  }
  if (texture == kNoId || textures.images == nullptr) return {1, 1, 1};
  const UvPlace& at = uv_place(textures.list, texture, place);
  return valid_color(textures.images->color(texture, at.uv, at.dx, at.dy));
}

Color texture_color(const Textures& textures, std::uint32_t texture, const TexturePlace& place) {
  return NestedTextures::color_at(textures, texture, place, 0);
}

Color background_color(const RenderContext& context, const Vec3f& direction) {
  if (context.background_texture == kNoId) return context.background;
  TexturePlace place;
  place.position = normalize(Vec3d(direction));
  return context.background * texture_color(context, context.background_texture, place);
}

float texture_value(const RenderContext& context, std::uint32_t texture, const TexturePlace& place) {
  if (pattern_in(context.texture_list, texture) != nullptr) return texture_color(context, texture, place).x;
  if (const Texture* t = attribute_in(context.texture_list, texture)) {
    const std::optional<AttributeValue> value = attribute_value(*t, place.on_mesh);
    return value ? number_of(*value, t->channel) : 1;
  }
  if (texture == kNoId || context.textures == nullptr) return 1;
  const UvPlace& at = uv_place(context.texture_list, texture, place);
  return context.textures->value(texture, at.uv, at.dx, at.dy);
}

TextureNeeds texture_needs(std::span<const Texture> list, const Material& m) {
  TextureNeeds needs;
  needs.any = has_textures(m);
  for_each_texture(m, [&](std::uint32_t texture) {
    // What is not in the list is an image for TextureSampler.
    needs.uv = needs.uv || (texture != kNoId && texture >= list.size());
    for_each_shown_texture(list, texture, [&](std::uint32_t t) {
      const Texture& shown = list[t];
      needs.uv = needs.uv || (shown.pattern ? shown.pattern->by_uv : shown.attribute.empty());
      needs.position = needs.position || shown.pattern;
      needs.mesh = needs.mesh || !shown.attribute.empty();
      needs.second_uvs = needs.second_uvs || shown.uv_layer != 0;
    });
  });
  return needs;
}

bool has_textures(const Material& m) {
  bool some = false;
  for_each_texture(m, [&](std::uint32_t texture) { some = some || texture != kNoId; });
  return some;
}

}  // namespace oktett
