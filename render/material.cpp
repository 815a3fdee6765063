#include "render/material.h"

#include <algorithm>
#include <cmath>

namespace oktett {

/// Below this roughness Whitted's model shows a mirror, above it a highlight.
static constexpr float kMirrorRoughness = 0.2f;

float greatest_albedo(const Material& m) {
  // The highlight's cosine to the power n, over pi, has the integral 2 / (n + 1) over its hemisphere.
  const float mirror = m.specular * 2 / (m.phong + 1) + m.reflection;
  Color sum = m.color * m.diffuse + m.specular_color * mirror;
  for (int k = 0; k < 3; ++k) sum[k] += m.transparency * std::max(1.0f, m.color[k]);
  return max_component(sum);
}

PrincipledMaterial principled_like(const Material& m) {
  PrincipledMaterial principled;
  PrincipledParameters& p = principled.parameters;
  p.base_color = m.color;
  p.ior = m.ior;
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
  const float dielectric = 0.08f * unit(p.specular) * opaque;
  v.specular = (mirror ? dielectric : metal + dielectric) * std::min(1.0f, (v.phong + 2) / 16);
  return v;
}

Color resembling_specular_color(const PrincipledParameters& p) {
  return unit(p.metallic) > 0.5f ? p.base_color : Color{1, 1, 1};
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
