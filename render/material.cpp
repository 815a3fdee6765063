#include "render/material.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <variant>
#include <vector>

namespace oktett {

/// Below this roughness Whitted's model shows a mirror, above it a highlight.
static constexpr float kMirrorRoughness = 0.2f;

namespace {

/// Bounds on what a texture answers.
struct TextureBounds {
  Color least{1, 1, 1}, greatest{1, 1, 1};
};

TextureBounds texture_bounds(std::span<const Texture> textures, std::uint32_t index, unsigned depth = 0);

/// Values between which all colours of a pattern lie. Between the colours of its map it is interpolated.
std::vector<Color> ends_of(std::span<const Texture> textures, const PatternTexture& pattern, unsigned depth) {
  std::vector<Color> ends;
  const auto bounds_of = [&](const Color& color, TextureIndex other) {
    return other == TextureIndex{} ? TextureBounds{color, color}
                                   : texture_bounds(textures, other.index, depth + 1);
  };
  const auto add = [&](const TextureBounds& b) { ends.push_back(b.least), ends.push_back(b.greatest); };
  if (const auto* const over = std::get_if<OverPattern>(&pattern.pattern)) {
    const auto [color, filter, under] = std::tuple(bounds_of(over->color.color, over->color.texture),
                                                   bounds_of(over->filter.color, over->filter.texture),
                                                   bounds_of(over->under.color, over->under.texture));
    add({color.least + filter.least * under.least, color.greatest + filter.greatest * under.greatest});
  } else if (const auto* const image = std::get_if<ProjectedPattern>(&pattern.pattern)) {
    add(texture_bounds(textures, image->texture.index, depth + 1));
  } else {
    for (const PatternEntry& entry : pattern.map) add(bounds_of(entry.color, entry.texture));
    if (ends.empty()) ends = pattern.colors;
  }
  return ends;
}

TextureBounds texture_bounds(std::span<const Texture> textures, std::uint32_t index, unsigned depth) {
  TextureBounds bounds;
  if (index >= textures.size() || depth > kMostNestedTextures) return bounds;
  const Texture& t = textures[index];
  std::vector<Color> ends;
  if (t.pattern) ends = ends_of(textures, *t.pattern, depth);
  if (ends.empty()) ends = {{0, 0, 0}, {1, 1, 1}};
  for (int k = 0; k < 3; ++k) {
    const auto value = [&](const Color& c) { return std::max(c[k] * t.gain + t.base, 0.0f); };
    bounds.least[k] = bounds.greatest[k] = value(ends[0]);
    for (const Color& c : ends) {
      bounds.least[k] = std::min(bounds.least[k], value(c));
      bounds.greatest[k] = std::max(bounds.greatest[k], value(c));
    }
  }
  return bounds;
}

}  // namespace

float greatest_albedo(const Material& m, std::span<const Texture> textures) {
  const auto bounds = [&](std::uint32_t texture) { return texture_bounds(textures, texture); };
  const auto most = [&](float value, std::uint32_t texture, float limit) {
    return std::min(value * bounds(texture).greatest.x, limit);
  };
  constexpr float kAny = std::numeric_limits<float>::infinity();
  const Color color = m.color * bounds(m.color_texture).greatest * bounds(m.tint_texture).greatest;
  const float least_exponent = m.phong * bounds(m.phong_texture).least.x;
  // The highlight's cosine to the power n, over pi, has the integral 2 / (n + 1) over its hemisphere. By the
  // halfway direction, which turns half as fast, it has at most four times that.
  const float least_blinn = m.blinn * bounds(m.blinn_texture).least.x;
  const float least_brilliance = m.brilliance * bounds(m.brilliance_texture).least.x;
  const float highlights = most(m.specular, m.specular_weight_texture, kAny) * 2 / (least_exponent + 1) +
                           most(m.specular_blinn, m.specular_blinn_texture, kAny) * 8 / (least_blinn + 1);
  const float mirror =
      std::max(most(m.reflection, m.reflection_texture, 1),
               m.reflection_varies ? most(m.reflection_grazing, m.reflection_grazing_texture, 1) : 0);
  const Color specular_color = m.specular_color * bounds(m.specular_texture).greatest;
  const Color mirror_color =
      m.reflection_color ? *m.reflection_color * bounds(m.reflection_color_texture).greatest : specular_color;
  const float transparency = most(m.transparency, m.transparency_texture, 1);
  Color sum = color * (most(m.diffuse, m.diffuse_texture, kAny) * 2 / (least_brilliance + 1)) +
              specular_color * highlights + mirror_color * mirror;
  const Color passing = m.filter ? *m.filter * bounds(m.filter_texture).greatest : color;
  for (int k = 0; k < 3; ++k) sum[k] += transparency * std::max(1.0f, passing[k]);
  return max_component(sum);
}

PrincipledMaterial principled_like(const Material& m) {
  PrincipledMaterial principled;
  PrincipledParameters& p = principled.parameters;
  p.base_color = m.color;
  p.ior = m.ior, principled.ior_texture = m.ior_texture;
  p.transmission = m.transparency;
  principled.transmission_texture = m.transparency_texture;
  // Facets whose highlight is as wide as that of the exponent: alpha^2 = 2 / (exponent + 2).
  p.roughness = std::sqrt(std::sqrt(2 / (m.phong + 2)));
  return principled;
}

static float unit(float x) { return std::clamp(x, 0.0f, 1.0f); }

PhongValues resembling_values(const PrincipledParameters& p) {
  const float metal = unit(p.metallic), glass = glass_weight(metal, unit(p.transmission));
  const float opaque = 1 - metal - glass;
  const bool mirror = p.roughness < kMirrorRoughness;
  PhongValues v{};
  v.ambient = 0.1f * opaque, v.diffuse = opaque;
  v.reflection = mirror ? metal : 0;
  v.transparency = glass;
  // The exponent whose highlight is as wide as facets of that roughness.
  const float alpha = std::max(p.roughness * p.roughness, 0.01f);
  v.phong = std::max(2 / (alpha * alpha) - 2, 0.0f);
  const float head_on = std::min(0.08f * unit(p.specular) * max_component(p.specular_color), 1.0f);
  const float dielectric = head_on * unit(p.specular_weight) * opaque;
  v.specular = (mirror ? dielectric : metal + dielectric) * std::min(1.0f, (v.phong + 2) / 16);
  return v;
}

Color resembling_specular_color(const PrincipledParameters& p) {
  if (unit(p.metallic) > 0.5f) return p.base_color;
  const float most = max_component(p.specular_color);
  return most > 0 ? p.specular_color * (1 / most) : Color{1, 1, 1};
}

void resemble_principled(Material& m) {
  PrincipledMaterial& principled = *m.principled;
  const PrincipledParameters& p = principled.parameters;
  const PhongValues v = resembling_values(p);
  m.color = p.base_color, m.specular_color = resembling_specular_color(p);
  m.ambient = v.ambient, m.diffuse = v.diffuse, m.specular = v.specular, m.phong = v.phong;
  m.reflection = v.reflection;
  const float least_metallic = principled.metallic_texture == kNoId ? unit(p.metallic) : 0;
  m.transparency = glass_weight(least_metallic, unit(p.transmission));
  m.ior = p.ior;
  principled.resembled = true;
}

}  // namespace oktett
