#pragma once
/// \file The textures of a material, one after the other.

#include <cstdint>

#include "render/material.h"

namespace oktett {

/// Calls f(index) for each index into a list of textures that a material holds.
template <class F>
void for_each_texture(Material& material, F&& f) {
  for (std::uint32_t* texture :
       {&material.color_texture, &material.specular_texture, &material.emission_texture,
        &material.opacity_texture, &material.bump_texture, &material.normal_texture,
        &material.ambient_texture, &material.diffuse_texture, &material.specular_weight_texture,
        &material.phong_texture, &material.reflection_texture, &material.transparency_texture,
        &material.ior_texture})
    f(*texture);
  if (!material.principled) return;
  for (const PrincipledNumber& number : kPrincipledNumbers) f((*material.principled).*number.texture);
  PrincipledMaterial& principled = *material.principled;
  for (std::uint32_t* texture :
       {&principled.sheen_color_texture, &principled.eta_texture, &principled.k_texture})
    f(*texture);
}

}  // namespace oktett
