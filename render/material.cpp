#include "render/material.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace oktett {

/// Below this roughness Whitted's model shows a mirror, above it a highlight.
static constexpr float kMirrorRoughness = 0.2f;

namespace {

/// Bounds on what a texture answers.
struct TextureBounds {
  Color least{1, 1, 1}, greatest{1, 1, 1};
};

TextureBounds texture_bounds(std::span<const Texture> textures, std::uint32_t index, unsigned depth = 0) {
  TextureBounds bounds;
  if (index >= textures.size() || depth > kMostNestedTextures) return bounds;
  const Texture& t = textures[index];
  std::vector<Color> ends{{0, 0, 0}, {1, 1, 1}};
  // Between its colours a pattern is interpolated.
  if (t.pattern && !t.pattern->map.empty()) {
    ends.clear();
    for (const PatternEntry& entry : t.pattern->map) {
      const bool is_color = entry.texture == TextureIndex{};
      const TextureBounds other = is_color ? TextureBounds{entry.color, entry.color}
                                           : texture_bounds(textures, entry.texture.index, depth + 1);
      ends.push_back(other.least), ends.push_back(other.greatest);
    }
  } else if (t.pattern && !t.pattern->colors.empty()) {
    ends = t.pattern->colors;
  }
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
  // The highlight's cosine to the power n, over pi, has the integral 2 / (n + 1) over its hemisphere.
  const float mirror = most(m.specular, m.specular_weight_texture, kAny) * 2 / (least_exponent + 1) +
                       most(m.reflection, m.reflection_texture, 1);
  const float transparency = most(m.transparency, m.transparency_texture, 1);
  Color sum = color * most(m.diffuse, m.diffuse_texture, kAny) +
              m.specular_color * bounds(m.specular_texture).greatest * mirror;
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
