#include "render/surface_textures.h"

#include <cmath>

namespace oktett {

static const PatternTexture* pattern_in(std::span<const Texture> list, std::uint32_t texture) {
  if (texture >= list.size()) return nullptr;
  const Texture& t = list[texture];
  return t.pattern ? &*t.pattern : nullptr;
}

const PatternTexture* pattern_of(const RenderContext& context, std::uint32_t texture) {
  return pattern_in(context.texture_list, texture);
}

/// Channels that are negative, NaN or infinite count as 0.
static Color valid_color(const Color& c) {
  const auto valid = [](float x) { return x > 0 && std::isfinite(x) ? x : 0; };
  return {valid(c.x), valid(c.y), valid(c.z)};
}

Color texture_color(const Textures& textures, std::uint32_t texture, const TexturePlace& place) {
  if (const PatternTexture* pattern = pattern_in(textures.list, texture)) {
    const Texture& t = textures.list[texture];
    return valid_color(pattern_color(*pattern, place.position) * t.gain + Color{t.base, t.base, t.base});
  }
  if (texture == kNoId || textures.images == nullptr) return {1, 1, 1};
  return valid_color(textures.images->color(texture, place.uv, place.dx, place.dy));
}

float texture_value(const RenderContext& context, std::uint32_t texture, const TexturePlace& place) {
  if (pattern_of(context, texture) != nullptr) return texture_color(context, texture, place).x;
  if (texture == kNoId || context.textures == nullptr) return 1;
  return context.textures->value(texture, place.uv, place.dx, place.dy);
}

/// Whether any texture of the material is such that is(texture).
template <class Is>
static bool any_texture(const Material& m, const Is& is) {
  for (const std::uint32_t texture : {m.color_texture, m.specular_texture, m.emission_texture,
                                      m.opacity_texture, m.bump_texture, m.normal_texture, m.ior_texture})
    if (is(texture)) return true;
  for (const PhongNumber& number : kPhongNumbers)
    if (is(m.*number.texture)) return true;
  if (!m.principled) return false;
  for (const PrincipledNumber& number : kPrincipledNumbers)
    if (is((*m.principled).*number.texture)) return true;
  return is(m.principled->sheen_color_texture) || is(m.principled->eta_texture) ||
         is(m.principled->k_texture);
}

bool has_textures(const Material& m) {
  return any_texture(m, [](std::uint32_t texture) { return texture != kNoId; });
}

bool has_pattern(const RenderContext& context, const Material& m) {
  return any_texture(m, [&](std::uint32_t t) { return pattern_of(context, t) != nullptr; });
}

}  // namespace oktett
