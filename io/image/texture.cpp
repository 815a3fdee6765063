#include "io/image/texture.h"

#include <utility>

#include "io/image/library.h"

namespace oktett {

ImageTextures::ImageTextures(std::vector<Texture> textures) {
  if (!textures.empty()) sampler_ = image_library().load_textures(std::move(textures), warnings_);
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
