#include "io/image/texture.h"

#include <algorithm>
#include <utility>

#include "io/image/library.h"
#include "io/text/files_read.h"

namespace oktett {

ImageTextures::ImageTextures(std::vector<Texture> textures) {
  const auto is_image = [](const Texture& texture) { return !texture.pattern; };
  for (const Texture& texture : textures)
    if (is_image(texture)) note_file_read(texture.path);
  if (std::ranges::any_of(textures, is_image))
    sampler_ = image_library().load_textures(std::move(textures), warnings_);
}

Color ImageTextures::color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->color(index, uv, dx, dy) : Color{1, 1, 1};
}

float ImageTextures::value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->value(index, uv, dx, dy) : 1;
}

Vec3f ImageTextures::normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->normal(index, uv, dx, dy) : Vec3f{0.5f, 0.5f, 1};
}

}  // namespace oktett
