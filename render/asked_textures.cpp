#include "render/asked_textures.h"

namespace oktett {

std::vector<Texture> asked_textures(const Scene& scene, bool data_layers) {
  std::vector<Texture> textures = scene.textures;
  const IntegratorKind kind = scene.integrator.kind;
  if (traits(kind).bounces()) return textures;
  std::vector<bool> asked(textures.size(), false);
  const auto ask = [&](std::uint32_t texture) {
    for_each_shown_texture(scene.textures, texture, [&](std::uint32_t shown) { asked[shown] = true; });
  };
  const bool normals = data_layers || kind == IntegratorKind::normal || kind == IntegratorKind::ao;
  const bool colors = data_layers || kind == IntegratorKind::albedo;
  ask(scene.background_texture);
  for (const Material& m : scene.materials) {
    ask(m.opacity_texture);
    if (normals) ask(m.bump_texture), ask(m.normal_texture);
    if (colors) ask(m.color_texture);
  }
  for (std::size_t i = 0; i < textures.size(); ++i)
    if (!asked[i]) textures[i].path.clear(), textures[i].content.reset();
  return textures;
}

}  // namespace oktett
