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

void resemble_principled(Material& m) {
  const PrincipledParameters& p = m.principled->parameters;
  const float metal = std::clamp(p.metallic, 0.0f, 1.0f);
  const float glass = (1 - metal) * std::clamp(p.transmission, 0.0f, 1.0f);
  const float opaque = 1 - metal - glass;
  const bool mirror = p.roughness < kMirrorRoughness;
  m.color = p.base_color;
  m.ambient = 0.1f * opaque, m.diffuse = opaque;
  m.specular_color = metal > 0.5f ? p.base_color : Color{1, 1, 1};
  m.reflection = mirror ? metal : 0;
  m.transparency = glass;
  m.ior = p.ior;
  // The exponent whose highlight is as wide as facets of that roughness.
  const float alpha = std::max(p.roughness * p.roughness, 0.01f);
  m.phong = std::max(2 / (alpha * alpha) - 2, 0.0f);
  const float dielectric = 0.08f * std::clamp(p.specular, 0.0f, 1.0f) * opaque;
  m.specular = (mirror ? dielectric : metal + dielectric) * std::min(1.0f, (m.phong + 2) / 16);
}

}  // namespace oktett
